#include <gmock/gmock.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <type_traits>
#include <vector>
#include <xsimd/xsimd.hpp>

#include <pcor/model/formula.hpp>
#include "numerics/missing.hpp"

namespace pcor {
namespace {

using internal::nan;

using XsimdBatch = xsimd::batch<double>;

constexpr double parameters[] = {0.8, -1.3};
constexpr double samples[] = {0.3, -0.7, 0.0, 2.5, nan, 1.0, -2.0, 17.0, 1e-3, 0.5, -0.31, 4.0};

/// Holds each lane against the value of the sample alone, to `tolerance` of it.
void expect_lanes_as_scalars(const char* text, double tolerance) {
  const auto formula = Formula::parse(text, {"k", "m"});
  ASSERT_TRUE(formula) << text;
  ASSERT_LE(formula->variables().size(), 2U);
  constexpr std::size_t count = std::size(samples);
  for (std::size_t begin = 0; begin < count; ++begin) {
    std::array<std::array<double, XsimdBatch::size>, 2> lanes;
    for (std::size_t lane = 0; lane < XsimdBatch::size; ++lane) {
      lanes[0][lane] = samples[(begin + lane) % count];
      lanes[1][lane] = samples[(2 * begin + 5 * lane + 3) % count];
    }
    const XsimdBatch variables[] = {XsimdBatch::load_unaligned(lanes[0].data()),
                                    XsimdBatch::load_unaligned(lanes[1].data())};
    const auto pack = formula->value(variables, parameters);
    static_assert(std::is_same_v<decltype(pack), const XsimdBatch>);
    std::array<double, XsimdBatch::size> values;
    pack.store_unaligned(values.data());
    for (std::size_t lane = 0; lane < XsimdBatch::size; ++lane) {
      const double alone[] = {lanes[0][lane], lanes[1][lane]};
      const double expected = formula->value(alone, parameters);
      if (std::isnan(expected)) {
        EXPECT_THAT(values[lane], testing::IsNan()) << text << " at " << alone[0] << " " << alone[1];
      } else if (std::isinf(expected) || tolerance == 0.0) {
        EXPECT_EQ(values[lane], expected) << text << " at " << alone[0] << " " << alone[1];
      } else {
        EXPECT_NEAR(values[lane], expected, tolerance * std::abs(expected))
            << text << " at " << alone[0] << " " << alone[1];
      }
    }
  }
}

TEST(FormulaPack, LanesEqualScalarsForArithmeticAndConditions) {
  for (const char* text : {"k * x / 100", "x - y/k + -x*m", "x^2 + y^3", "x^-2 - y^7", "sqrt(x) - y",
                           "abs(x)*m", "min(x, y)", "max(x, y)", "k + m*max(x, -0.31)", "if(x < y, x, k)",
                           "if(x <= y, 1, y)", "if(x > y, sqrt(x), y)", "if(x >= m, x/y, 0)"}) {
    expect_lanes_as_scalars(text, 0.0);
  }
}

// The pack has its own series for these functions, which are a few last bits from those of the C library.
TEST(FormulaPack, LanesAgreeWithScalarsWithinRoundingForFunctions) {
  for (const char* text : {"exp(x)", "log(x)", "log10(x)", "sin(x)", "cos(x)", "tan(x)", "tanh(x)", "x^1.5",
                           "x^-0.25", "pow(x, k)", "x^y"}) {
    expect_lanes_as_scalars(text, 4e-15);
  }
}

TEST(FormulaPack, ParametersCanBePacks) {
  const auto formula = Formula::parse("k * x^2", {"k"});
  ASSERT_TRUE(formula);
  const XsimdBatch x(3.0), k(2.0);
  std::array<double, XsimdBatch::size> values;
  formula->value(&x, &k).store_unaligned(values.data());
  for (const double value : values) EXPECT_EQ(value, 18.0);
}

}  // namespace
}  // namespace pcor

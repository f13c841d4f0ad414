#include <ceres/jet.h>
#include <gmock/gmock.h>

#include <cmath>
#include <string>
#include <type_traits>
#include <vector>

#include <pcor/model/formula.hpp>

namespace pcor {
namespace {

using Jet3 = ceres::Jet<double, 3>;

constexpr const char* smooth[] = {
    "k * x / 100",
    "(k + m*sqrt(x) + n*x^1.5) * y",
    "k + m*max(x, -0.31)",
    "min(k*x, m) + max(n, x*y)",
    "if(x < y, k*x^2, m*y^3) + if(m*x >= n, k, y)",
    "exp(-m*x) * sin(k*y) + cos(n*x)",
    "log(x + k) * tanh(m*y) - log10(n + x)",
    "abs(k - 10*x) + tan(m*x) / y",
    "x^k + k^x + 2^m + (x + y)^(m*n)",
    "(-x - k)^3 + (-x)^-2 * n + (k - 5)^4",
    "x^0 * k + m^1",
    "-(x*m - y/n)^2",
};

const std::vector<std::string> names{"k", "m", "n"};

// In the order of the formula's variables, of which there are no more than two.
constexpr double points[][2] = {{0.3, 0.7}, {0.9, 0.2}, {1.7, 2.5}, {0.05, 0.6}};
constexpr double parameters[] = {0.8, 1.3, 0.4};

// Derivatives of a function of `count` numbers against central differences.
template <class Function>
void expect_jet_derivatives(const Function& f, const double* at, std::size_t count, double tolerance,
                            const std::string& text) {
  std::vector<Jet3> dual;
  for (std::size_t i = 0; i < count; ++i) dual.emplace_back(at[i], static_cast<int>(i));
  const auto value = f(dual.data());
  static_assert(std::is_same_v<decltype(value), const Jet3>);
  const double exact = f(at);
  EXPECT_NEAR(value.a, exact, 1e-14 * (1.0 + std::abs(exact))) << text;
  for (std::size_t i = 0; i < count; ++i) {
    const double step = 1e-5;
    std::vector<double> above(at, at + count), below(at, at + count);
    above[i] += step;
    below[i] -= step;
    const double slope = (f(above.data()) - f(below.data())) / (2.0 * step);
    EXPECT_NEAR(value.v[static_cast<Eigen::Index>(i)], slope, tolerance * (1.0 + std::abs(slope)))
        << text << " by number " << i;
  }
}

TEST(FormulaJet, DifferentiatesByParameters) {
  for (const char* text : smooth) {
    const auto formula = Formula::parse(text, names);
    ASSERT_TRUE(formula) << text;
    for (const auto& point : points)
      expect_jet_derivatives([&](const auto* p) { return formula->value(point, p); }, parameters, 3, 1e-7,
                             text);
  }
}

TEST(FormulaJet, DifferentiatesByVariables) {
  for (const char* text : smooth) {
    const auto formula = Formula::parse(text, names);
    ASSERT_TRUE(formula) << text;
    for (const auto& point : points)
      expect_jet_derivatives([&](const auto* x) { return formula->value(x, parameters); }, point, 2, 1e-6,
                             text);
  }
}

TEST(FormulaJet, DifferentiatesByBothAtOnce) {
  const auto formula = Formula::parse("k * x^2", {"k"});
  ASSERT_TRUE(formula);
  const Jet3 x(3.0, 0), k(5.0, 1);
  const Jet3 value = formula->value(&x, &k);
  EXPECT_EQ(value.a, 45.0);
  EXPECT_EQ(value.v[0], 30.0);
  EXPECT_EQ(value.v[1], 9.0);
}

// On the ground the dynamic pressure is zero, where the derivative of its root is infinite; the derivatives
// by the parameters do not depend on that.
TEST(FormulaJet, ParameterDerivativesStayFiniteAtSingularity) {
  const auto formula = Formula::parse("k + m*sqrt(max(x, 0)) + n*max(x, 0)^1.5 + m*(x^0.5 - 1)", names);
  ASSERT_TRUE(formula);
  const double x = 0.0;
  const Jet3 p[] = {Jet3(parameters[0], 0), Jet3(parameters[1], 1), Jet3(parameters[2], 2)};
  const Jet3 value = formula->value(&x, p);
  EXPECT_EQ(value.a, 0.8 - 1.3);
  EXPECT_EQ(value.v[0], 1.0);
  EXPECT_EQ(value.v[1], -1.0);
  EXPECT_EQ(value.v[2], 0.0);
}

TEST(FormulaJet, WithoutParametersDerivativesAreZero) {
  const auto formula = Formula::parse("sqrt(x) + 1", {});
  ASSERT_TRUE(formula);
  const double x = 0.0;
  const Jet3* const none = nullptr;
  const Jet3 value = formula->value(&x, none);
  EXPECT_EQ(value.a, 1.0);
  EXPECT_EQ(value.v[0], 0.0);
}

TEST(FormulaJet, DifferentiatesTheSelectedBranch) {
  const auto formula = Formula::parse("if(x > 0, k*x, m*sqrt(x))", {"k", "m"});
  ASSERT_TRUE(formula);
  for (const double at : {4.0, -4.0}) {
    const Jet3 x(at, 2), p[] = {Jet3(2.0, 0), Jet3(3.0, 1)};
    const Jet3 value = formula->value(&x, p);
    if (at > 0.0) {
      EXPECT_EQ(value.a, 8.0);
      EXPECT_EQ(value.v[0], 4.0);
      EXPECT_EQ(value.v[1], 0.0);
      EXPECT_EQ(value.v[2], 2.0);
    } else {
      EXPECT_THAT(value.a, testing::IsNan());
    }
  }
}

}  // namespace
}  // namespace pcor

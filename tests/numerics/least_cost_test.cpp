#include "numerics/least_cost.hpp"

#include <gtest/gtest.h>
#include <pcor/base/error.hpp>

#include <cmath>
#include <vector>

namespace pcor::internal {
namespace {

nlopt::opt search() {
  nlopt::opt search(nlopt::LN_BOBYQA, 2);
  search.set_lower_bounds(-3.0);
  search.set_upper_bounds(3.0);
  search.set_xtol_abs(1e-6);
  return search;
}

TEST(LeastCost, MinimumIsFound) {
  std::vector<double> x{2.0, 2.0};
  nlopt::opt bobyqa = search();
  minimize_objective(
      bobyqa, [](const std::vector<double>& at) { return std::hypot(at[0] - 0.5, at[1] + 1.0); }, x);
  EXPECT_NEAR(x[0], 0.5, 1e-4);
  EXPECT_NEAR(x[1], -1.0, 1e-4);
}

TEST(LeastCost, ExceptionOfTheCostIsRethrown) {
  std::vector<double> x{2.0, 2.0};
  int calls = 0;
  nlopt::opt bobyqa = search();
  const auto cost = [&calls](const std::vector<double>& at) {
    if (++calls == 4) throw Error(Error::Code::file, "flight.nc: it is gone");
    return at[0] * at[0];
  };
  try {
    minimize_objective(bobyqa, cost, x);
    FAIL() << "nothing was thrown";
  } catch (const Error& error) {
    EXPECT_STREQ(error.what(), "flight.nc: it is gone");
    EXPECT_EQ(error.code(), Error::Code::file);
  }
  EXPECT_EQ(calls, 4);
}

}  // namespace
}  // namespace pcor::internal

#include "fit/misfit.hpp"

#include <gtest/gtest.h>
#include <pcor/fit/refit.hpp>

#include <cmath>

#include "support/made_samples.hpp"

using namespace pcor;

namespace {

/// A law that lacks a function of q/p, curved more than any of its terms.
double curved(double p, double q, double ratio, double time) {
  const double state = (q / p - 0.1) / 0.03;
  return made::equation_18(p, q, ratio, time) + 0.8 * std::exp(-state * state);
}

RefitResult fit(double (*defect)(double, double, double, double)) {
  std::vector<std::shared_ptr<const FlightSamples>> flights;
  for (unsigned seed = 1; seed <= 3; ++seed) {
    made::Plan plan;
    plan.seed = seed;
    plan.noise = 0.1;
    plan.defect = defect;
    flights.push_back(made::shared(plan));
  }
  return refit(flights, made::model({"static-constant", "static-alpha", "static-qp"}),
               made::pressure_reference());
}

}  // namespace

TEST(Misfit, OfARightLawIsBelowItsNoise) { EXPECT_LT(fit(made::equation_18).left, 0.05); }

TEST(Misfit, OfALawThatLacksAFunctionOfTheStateIsItsSize) {
  const RefitResult right = fit(made::equation_18);
  const RefitResult wrong = fit(curved);
  // What the law cannot follow makes the residual grow: the squares add up.
  const double missing = std::sqrt(wrong.rms * wrong.rms - right.rms * right.rms);
  EXPECT_GT(missing, 0.1);
  EXPECT_NEAR(wrong.left, missing, 0.3 * missing);
  for (std::size_t p = 0; p < right.parameters.size(); ++p) {
    EXPECT_GT(wrong.parameters[p].standard_error, right.parameters[p].standard_error);
    EXPECT_GE(wrong.parameters[p].standard_error, wrong.parameters[p].noise_error);
  }
}

// The law of a surface, and what the chain, the flags and the stated errors make of it.
#include <gmock/gmock.h>

#include <cmath>
#include <limits>
#include <numeric>
#include <stdexcept>
#include <string>
#include <vector>

#include <pcor/realtime/loop.hpp>
#include "support/constants.hpp"

namespace pcor {
namespace {

using test::missing;

const Surface surface_5_by_4{{{{Quantity::attack_ratio, -0.1, 0.3, 5}, {Quantity::mach, 0.2, 0.5, 4}}}};

double value(const std::vector<double>& coefficients, double x, double y) {
  return surface_5_by_4.value(x, y, 1.0, coefficients.data());
}

/// Coefficients of which nothing is special.
std::vector<double> uneven() {
  std::vector<double> coefficients(surface_5_by_4.parameter_count());
  for (std::size_t i = 0; i < coefficients.size(); ++i)
    coefficients[i] = 0.01 * std::sin(static_cast<double>(3 * i * i + i));
  return coefficients;
}

Model model_with(const std::vector<double>& coefficients) {
  Model model;
  model.effects.push_back({"static-constant", {0.001}});
  ModelEffect effect;
  effect.id = "static-surface";
  effect.surface = surface_5_by_4;
  effect.parameters = coefficients;
  model.effects.push_back(effect);
  return model;
}

const std::vector<Quantity> surface_roles{Quantity::static_pressure, Quantity::dynamic_pressure,
                                          Quantity::radome_dynamic_pressure,
                                          Quantity::attack_differential_pressure};

/// A loop after one sample of that attack ratio at 700 hPa.
Loop flown(const Model& model, double ratio, double q, const ModelUncertainty& uncertainty = {}) {
  std::string error;
  std::optional<Loop> loop = Loop::build(model, surface_roles, 1.0, &error, CorrectWith::model, uncertainty);
  if (!loop) throw std::runtime_error(error);
  State<double>& state = loop->state();
  state[Quantity::static_pressure] = 700.0;
  state[Quantity::dynamic_pressure] = q;
  state[Quantity::radome_dynamic_pressure] = q;
  state[Quantity::attack_differential_pressure] = ratio * q;
  loop->run(1.0);
  return std::move(*loop);
}

ModelUncertainty independent(const Model& model, double error) {
  std::size_t count = 0;
  for (const ModelEffect& effect : model.effects) count += effect.parameters.size();
  ModelUncertainty uncertainty;
  uncertainty.covariance.assign(count * count, 0.0);
  for (std::size_t i = 0; i < count; ++i) uncertainty.covariance[i * count + i] = error * error;
  return uncertainty;
}

// Sums of at most twenty products of numbers of order one: within 1e-14.
TEST(Surface, SplinesSumToOneEverywhere) {
  const std::vector<double> ones(surface_5_by_4.parameter_count(), 1.0);
  for (double x = -0.5; x < 0.8; x += 0.013) {
    for (double y = 0.0; y < 0.9; y += 0.017) EXPECT_NEAR(value(ones, x, y), 1.0, 1e-14);
  }
}

TEST(Surface, LinearCoefficientsGiveAPlane) {
  std::vector<double> plane;
  for (int i = 0; i < 5; ++i) {
    for (int j = 0; j < 4; ++j) plane.push_back(1.0 + 0.2 * (i - 1) + 0.3 * (j - 1));
  }
  for (double x = -0.1; x < 0.3; x += 0.02) {
    for (double y = 0.2; y < 0.5; y += 0.02)
      EXPECT_NEAR(value(plane, x, y), 1.0 + 0.2 * (x + 0.1) / 0.2 + 0.3 * (y - 0.2) / 0.3, 1e-14);
  }
}

TEST(Surface, CurvatureIsContinuousAcrossKnots) {
  const std::vector<double> coefficients = uneven();
  const auto curvature = [&](double x) {
    const double step = 1e-4;
    return (value(coefficients, x + step, 0.3) - 2.0 * value(coefficients, x, 0.3) +
            value(coefficients, x - step, 0.3)) /
           (step * step);
  };
  // A knot at 0.1: the second difference over 1e-4 of either side differs by the third derivative, about
  // 0.1/0.2^3 = 12, times 4e-4, and by rounding of 1e-17/1e-8.
  EXPECT_NEAR(curvature(0.1 - 2e-4), curvature(0.1 + 2e-4), 0.02);
  EXPECT_GT(std::abs(curvature(0.0)), 0.05);
}

TEST(Surface, IsFlatOutsideItsEnvelope) {
  const std::vector<double> coefficients = uneven();
  EXPECT_EQ(value(coefficients, 0.9, 0.3), value(coefficients, 0.3, 0.3));
  EXPECT_EQ(value(coefficients, -5.0, 0.7), value(coefficients, -0.1, 0.5));
  EXPECT_EQ(value(coefficients, std::numeric_limits<double>::infinity(), 0.3), value(coefficients, 0.3, 0.3));
}

TEST(Surface, MissingInputsGiveNan) {
  const std::vector<double> coefficients = uneven();
  EXPECT_TRUE(std::isnan(value(coefficients, missing, 0.3)));
  EXPECT_TRUE(std::isnan(value(coefficients, 0.1, missing)));
}

TEST(Surface, LoopAddsItToDeltaP) {
  const Model model = model_with(uneven());
  const Loop loop = flown(model, 0.13, 60.0);
  const double mach = loop.state()[Quantity::mach];
  EXPECT_NEAR(loop.state()[Quantity::static_defect], 0.7 + 60.0 * value(uneven(), 0.13, mach), 1e-13);
  EXPECT_FALSE(loop.quality().has(Quality::outside_domain));
}

TEST(Surface, SamplesOutsideAreFlaggedAndFinite) {
  const Model model = model_with(uneven());
  for (const double ratio : {-3.0, 0.31, 4.0}) {
    const Loop loop = flown(model, ratio, 60.0);
    EXPECT_TRUE(loop.quality().has(Quality::outside_domain)) << ratio;
    EXPECT_TRUE(std::isfinite(loop.state()[Quantity::static_defect])) << ratio;
  }
  EXPECT_TRUE(flown(model, 0.1, 10.0).quality().has(Quality::outside_domain));
}

TEST(Surface, StatedErrorGrowsWithTheDistanceOutside) {
  const Model model = model_with(uneven());
  const ModelUncertainty uncertainty = independent(model, 0.0005);
  const auto error = [&](double ratio) {
    return flown(model, ratio, 60.0, uncertainty).state()[Quantity::static_defect_uncertainty];
  };
  EXPECT_GT(error(0.32), error(0.3));
  // By the rms difference of neighbouring coefficients for each interval of 0.2, with their errors.
  const std::vector<double> c = uneven();
  double squares = 0.0;
  int pairs = 0;
  for (std::size_t i = 0; i < c.size(); ++i) {
    if (i % 4 > 0) squares += (c[i] - c[i - 1]) * (c[i] - c[i - 1]), ++pairs;
    if (i >= 4) squares += (c[i] - c[i - 4]) * (c[i] - c[i - 4]), ++pairs;
  }
  const double slope = std::sqrt(squares / pairs + 2.0 * 0.0005 * 0.0005);
  EXPECT_NEAR(error(0.5), std::hypot(error(0.3), 60.0 * slope), 1e-9);
}

TEST(Surface, ErrorGrowsOutsideTheEnvelope) {
  const Model model = model_with(uneven());
  std::string error;
  auto loop = Loop::build(model, surface_roles, 1.0, &error, CorrectWith::model, independent(model, 0.0005));
  ASSERT_TRUE(loop) << error;
  std::vector<double> errors;
  for (int i = 0; i < 3; ++i) {
    State<double>& state = loop->state();
    state[Quantity::static_pressure] = 700.0;
    state[Quantity::dynamic_pressure] = 60.0;
    state[Quantity::radome_dynamic_pressure] = 60.0;
    state[Quantity::attack_differential_pressure] = i == 1 ? 60.0 : 6.0;
    loop->run(i);
    errors.push_back(state[Quantity::static_defect_uncertainty]);
  }
  EXPECT_GT(errors[1], 2.0 * errors[0]);
  EXPECT_DOUBLE_EQ(errors[2], errors[0]);
}

TEST(Surface, WrongNumberOfCoefficientsIsRefused) {
  Model model = model_with(uneven());
  model.effects.back().parameters.pop_back();
  BindingError error;
  EXPECT_FALSE(Chain::build(model, surface_roles, &error));
  EXPECT_EQ(error.code, BindingError::Code::parameter_count);
}

}  // namespace
}  // namespace pcor

// A surface added to a law: its penalty, its columns, and its refit.
#include <gmock/gmock.h>

#include <Eigen/Dense>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <numeric>
#include <string>
#include <vector>

#include <pcor/batch/batch.hpp>
#include <pcor/fit/refit.hpp>
#include <pcor/model_io/model_definition.hpp>
#include <pcor/realtime/loop.hpp>
#include <pcor/roles/add_effects.hpp>
#include "fit/fitted_model.hpp"
#include "support/synthetic_samples.hpp"

namespace pcor {
namespace {

/// Over what the synthetic flights fly: attack ratios of -0.37 to -0.03, Mach numbers of 0.27 to 0.46.
const std::array<SurfaceAxis, 2> flown{
    {{Quantity::attack_ratio, -0.36, -0.04, 6}, {Quantity::mach, 0.28, 0.44, 6}}};

ModelDefinition law_with_surface() {
  ModelDefinition file = made::model({"static-constant", "static-alpha", "static-qp"});
  file.model.effects.push_back(surface_effect("static-surface", flown));
  return file;
}

/// In addition to the law a bump in attack of 0.008 q, 0.5 hPa at 65 hPa.
double with_bump(double p, double q, double ratio, double time) {
  const double from = (ratio + 0.2) / 0.06;
  return made::equation_18(p, q, ratio, time) + 0.008 * q * std::exp(-0.5 * from * from);
}

made::Plan plan(unsigned seed, double (*defect)(double, double, double, double)) {
  made::Plan plan;
  plan.seed = seed;
  plan.defect = defect;
  return plan;
}

/// Rms difference between the fitted model and the truth of a flight, hPa.
double true_error(const RefitResult& fit, const made::Plan& of) {
  made::Plan quiet = of;
  quiet.noise = 0.0;
  const auto samples = made::shared(quiet);
  const Residuals residuals(samples, fit.model, *made::pressure_reference().front());
  double squares = 0.0;
  for (const double each : residuals.values(residuals.parameters().data())) squares += each * each;
  return std::sqrt(squares / static_cast<double>(samples->time.size()));
}

RefitResult fit_of_plan(const ModelDefinition& model, const made::Plan& of) {
  RefitOptions options;
  options.trust_reference = true;
  return refit({made::shared(of)}, model, made::pressure_reference(), options);
}

}  // namespace

TEST(SurfacePenalty, SecondDifferencesOfPlanesAreZero) {
  const Surface surface{flown};
  const Eigen::MatrixXd penalty = internal::second_differences(surface);
  Eigen::VectorXd plane(36);
  for (Eigen::Index i = 0; i < 36; ++i)
    plane[i] = 1.0 + 0.5 * static_cast<double>(i / 6) - 0.25 * static_cast<double>(i % 6);
  // 24 second differences along each axis.
  ASSERT_EQ(penalty.rows(), 24 + 24);
  EXPECT_LT((penalty * plane).norm(), 1e-13);
  const Eigen::VectorXd bent = plane.array().square();
  EXPECT_GT((penalty * bent).norm(), 1.0);
}

TEST(SurfaceColumns, AreDerivativesOfTheResidual) {
  const auto samples = made::shared(plan(3, made::equation_18));
  const ModelDefinition model = law_with_surface();
  const Residuals residuals(samples, model, *made::pressure_reference().front());
  std::vector<double> parameters = residuals.parameters();
  for (const std::size_t coefficient : {3U, 17U, 24U, 38U}) {
    std::vector<std::size_t> all(samples->time.size());
    std::iota(all.begin(), all.end(), 0);
    std::vector<double> residual(all.size());
    std::vector<double> column(all.size());
    residuals.evaluate(all, parameters.data(), {coefficient}, residual.data(), column.data());
    EXPECT_TRUE(residuals.is_linear()[coefficient]);
    parameters[coefficient] = 0.01;
    const std::vector<double> moved = residuals.values(parameters.data());
    parameters[coefficient] = 0.0;
    // With 0.01 q the residual of about 5 hPa in 700 hPa loses three of sixteen digits.
    for (std::size_t i = 0; i < all.size(); ++i)
      EXPECT_NEAR(column[i], (moved[i] - residual[i]) / 0.01, 1e-9);
  }
}

TEST(SurfaceFit, FindsABumpThatTheLawLacks) {
  const made::Plan first = plan(11, with_bump);
  const RefitResult law = fit_of_plan(made::model({"static-constant", "static-alpha", "static-qp"}), first);
  const RefitResult surface = fit_of_plan(law_with_surface(), first);
  ASSERT_EQ(surface.surfaces.size(), 1U);
  EXPECT_EQ(surface.surfaces.front().effect, "static-surface");
  EXPECT_GT(surface.surfaces.front().degrees_of_freedom, 3.0);
  // On a flight at other heights, whose noise was not in the fit.
  EXPECT_LT(true_error(surface, plan(12, with_bump)), 0.5 * true_error(law, plan(12, with_bump)));
}

TEST(SurfaceFit, CorrectLawGivesASmallSurface) {
  const made::Plan first = plan(21, made::equation_18);
  const RefitResult surface = fit_of_plan(law_with_surface(), first);
  // Autocorrelated noise of 0.3 hPa: an independent sample every 6 s, so each degree of freedom adds
  // 0.3/sqrt(600) = 0.012 hPa; three terms of the law add 0.02 hPa.
  EXPECT_LT(surface.surfaces.front().degrees_of_freedom, 8.0);
  EXPECT_LT(true_error(surface, plan(22, made::equation_18)), 0.05);
}

TEST(SurfaceFit, StartOfThePriorDoesNotMatter) {
  RefitOptions options;
  options.trust_reference = true;
  const auto samples = made::shared(plan(11, with_bump));
  const auto residuals_from = [&](std::vector<internal::SurfaceRoughness>& surfaces) {
    const ModelDefinition fitted = internal::fitted_coefficients(
        {samples}, law_with_surface(), made::pressure_reference(), options, surfaces);
    const Residuals residuals(samples, fitted, *made::pressure_reference().front());
    return residuals.values(residuals.parameters().data());
  };
  std::vector<internal::SurfaceRoughness> from_default;
  const std::vector<double> expected = residuals_from(from_default);
  ASSERT_EQ(from_default.size(), 1U);
  EXPECT_GT(from_default.front().degrees_of_freedom, 3.0);
  std::vector<internal::SurfaceRoughness> smooth = from_default;
  smooth.front().size = 0.001;
  smooth.front().coefficient = 0.001;
  std::vector<internal::SurfaceRoughness> rough = from_default;
  rough.front().size = 0.1;
  rough.front().inflation = 30.0;
  for (std::vector<internal::SurfaceRoughness>* const start : {&smooth, &rough}) {
    const std::vector<double> found = residuals_from(*start);
    double squares = 0.0;
    for (std::size_t i = 0; i < found.size(); ++i) squares += std::pow(found[i] - expected[i], 2);
    // Sizes are found to a quarter of a decade, and the inflation to 20 %: less than the error by one degree
    // of freedom, 0.012 hPa.
    EXPECT_LT(std::sqrt(squares / static_cast<double>(found.size())), 0.006);
  }
}

TEST(SurfaceFit, StatesAnErrorThatCoversTheTruth) {
  const made::Plan first = plan(31, with_bump);
  const RefitResult found = fit_of_plan(law_with_surface(), first);
  const ModelUncertainty uncertainty = uncertainty_of(found.model);
  EXPECT_TRUE(is_covariance(uncertainty.covariance, found.parameters.size()));
  made::Plan quiet = first;
  quiet.noise = 0.0;
  const auto samples = made::shared(quiet);
  std::string why;
  auto loop = Loop::build(found.model.model, found.model.roles(), 1.0, &why, CorrectWith::model, uncertainty);
  ASSERT_TRUE(loop) << why;
  double within = 0.0;
  for (std::size_t i = 0; i < samples->time.size(); ++i) {
    for (const auto& [quantity, values] : samples->model.columns) loop->state()[quantity] = values[i];
    loop->run(samples->time[i]);
    const double truth =
        samples->reference.columns.front().second[i] - loop->state()[Quantity::static_pressure];
    const double error = loop->state()[Quantity::static_defect_uncertainty];
    ASSERT_GT(error, 0.0);
    if (std::abs(loop->state()[Quantity::static_defect] - truth) < 2.0 * error) within += 1.0;
  }
  // One fit: its error is one draw over the envelope. 95 % on average; half of that would be a fault.
  EXPECT_GT(within / static_cast<double>(samples->time.size()), 0.8);
}

TEST(SurfaceFit, LoopReproducesTheFittedSurface) {
  const RefitResult found = fit_of_plan(law_with_surface(), plan(41, with_bump));
  const auto samples = made::shared(plan(41, with_bump));
  const Residuals residuals(samples, found.model, *made::pressure_reference().front());
  const std::vector<double> defects =
      residuals.quantity(Quantity::static_defect, residuals.parameters().data());
  std::string why;
  auto loop =
      Loop::build(parse_model(write_model(found.model), "test").model, found.model.roles(), 1.0, &why);
  ASSERT_TRUE(loop) << why;
  for (std::size_t i = 0; i < samples->time.size(); ++i) {
    for (const auto& [quantity, values] : samples->model.columns) loop->state()[quantity] = values[i];
    loop->run(samples->time[i]);
    // Vector registers round sums otherwise: some units in the last place of 5 hPa.
    EXPECT_NEAR(loop->state()[Quantity::static_defect], defects[i], 1e-13);
  }
}

/// The flight of PCOR_FLIGHTS whose law of 2011 lacks 0.1 hPa with attack.
TEST(SurfaceFit, PredictsHeldOutBlocksOfARealFlight) {
  const char* const folder = std::getenv("PCOR_FLIGHTS");
  if (folder == nullptr) GTEST_SKIP() << "PCOR_FLIGHTS does not name a folder of flights";
  const std::filesystem::path path = std::filesystem::path(folder) / "GOTEX-rf06-C130-2004.nc";
  if (!std::filesystem::exists(path)) GTEST_SKIP() << path << " is not there";
  ModelDefinition law = made::model({"static-constant", "static-alpha", "static-qp"});
  law.variables[Quantity::recovery_temperature] = "TTRR";
  law.variables[Quantity::altitude] = "GGALT";
  law.variables[Quantity::roll] = "ROLL";
  law.variables[Quantity::vertical_speed] = "VSPD";
  ModelDefinition surface = law;
  const FlightSet flights{path};
  surface.model.effects.push_back(surface_over(
      1, [&flights](std::size_t number) -> const Flight& { return flights[number]; }, law, "static-surface"));
  const References other{
      static_system_reference(read_model(PCOR_SOURCE_DIR "/data/models/c130-psfrd-eq18.toml"))};
  RefitOptions options;
  options.mask.min_airspeed = 90.0;
  options.training_share = 0.6;
  const auto held_out = [&](const ModelDefinition& model) {
    const RefitResult result = refit(flights, model, other, options);
    for (const FlightFit& part : result.flights) {
      if (part.holdout) return part.after.rms;
    }
    return 0.0;
  };
  EXPECT_LT(held_out(surface), held_out(law));
}

}  // namespace pcor

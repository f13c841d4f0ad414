#include <gmock/gmock.h>
#include <pcor/campaign/chosen_references.hpp>
#include <pcor/fit/refit.hpp>
#include <pcor/roles/add_effects.hpp>
#include <pcor/simulate/simulate.hpp>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <string>

#include "support/error_of.hpp"
#include "support/short_flight.hpp"

using pcor::FittedParameter;
using pcor::ModelDefinition;
using pcor::References;
using pcor::RefitResult;
using pcor::test::laser_model;

namespace {

constexpr double gain = 0.01;

/// A quarter of an hour in which QCF reads 1 % too much.
std::filesystem::path flight_file() {
  return pcor::test::simulated("c130-short", "\n[[effect]]\nid = \"qcf-gain\"\non = \"PSFD\"\ngain = 0.01\n");
}

ModelDefinition law_with_gain() {
  return pcor::add_effects(laser_model(), {pcor::neutral_effect("qcf-gain")}, {});
}

RefitResult fit_of_short_flight(const ModelDefinition& model, const std::vector<std::string>& references) {
  return pcor::refit({flight_file()}, model, pcor::read_references(references, model, {}).used);
}

const FittedParameter& parameter(const RefitResult& fit, const std::string& name) {
  return *std::find_if(fit.parameters.begin(), fit.parameters.end(),
                       [&name](const FittedParameter& each) { return each.name == name; });
}

}  // namespace

TEST(SeveralReferences, CombinationSeparatesCoefficients) {
  // The laser takes a gain of QCF for static-qp; total pressures do not.
  const FittedParameter alone = parameter(fit_of_short_flight(law_with_gain(), {"lams"}), "qcf-gain.gain");
  const FittedParameter both =
      parameter(fit_of_short_flight(law_with_gain(), {"lams", "total:PSFRD+QCFR"}), "qcf-gain.gain");
  EXPECT_FALSE(alone.standard_error < 10.0 * both.standard_error) << "alone it may end at a bound";
  EXPECT_NEAR(both.value, gain, 4.0 * both.standard_error) << "once in 16,000";
  EXPECT_LT(std::abs(both.value - gain), 0.1 * gain);
}

TEST(SeveralReferences, InsensitiveReferencesChangeNoCoefficient) {
  const RefitResult alone = fit_of_short_flight(laser_model(), {"lams"});
  const RefitResult both = fit_of_short_flight(laser_model(), {"lams", "total:PSFRD+QCFR"});
  for (std::size_t p = 0; p < alone.parameters.size(); ++p) {
    EXPECT_EQ(both.parameters[p].value, alone.parameters[p].value);
    EXPECT_EQ(both.parameters[p].standard_error, alone.parameters[p].standard_error);
  }
  EXPECT_EQ(both.reference_text, "LAMS");
  ASSERT_EQ(both.further.size(), 1U);
  EXPECT_EQ(both.further.front().reference, "total:PSFRD+QCFR");
  // 1 % of about 65 hPa.
  EXPECT_NEAR(both.further.front().after.bias, -0.65, 0.25);
  EXPECT_EQ(both.further.front().after.rms, both.further.front().before.rms);
}

TEST(SeveralReferences, CommonErrorsOfTwoSystemsStayUnresolved) {
  ModelDefinition model = pcor::add_effects(laser_model(), {pcor::neutral_effect("total-lag")}, {});
  model.fits.back().front().bounds =
      pcor::Bounds{-30.0, 30.0};  // the flight has no lag, and may go below zero
  const FittedParameter alone = parameter(fit_of_short_flight(model, {"lams"}), "total-lag.tau");
  pcor::RefitOptions options;
  options.shared_effects = {"total-lag"};
  const References references = pcor::read_references({"lams", "total:PSFRD+QCFR"}, model, {}).used;
  const FittedParameter shared =
      parameter(pcor::refit({flight_file()}, model, references, options), "total-lag.tau");
  EXPECT_NEAR(shared.value, alone.value, 1e-9)
      << "the total pressures see no other coefficient of this model";
  EXPECT_NEAR(shared.standard_error, alone.standard_error, 1e-9);
  const FittedParameter of_one =
      parameter(fit_of_short_flight(model, {"lams", "total:PSFRD+QCFR"}), "total-lag.tau");
  EXPECT_LT(of_one.standard_error, alone.standard_error) << "a lag of one system is seen there";
}

// The law of a second system is not fitted if a laser is the first reference. Errors of its coefficients are
// stated, so trust in the calibration does not exclude them.
TEST(SeveralReferences, StatedErrorOfASecondLawIsCarried) {
  constexpr double stated = 1e-4;
  const auto fit_with = [&](double change) {
    ModelDefinition second =
        pcor::read_model(std::filesystem::path(PCOR_SOURCE_DIR) / "data" / "models" / "c130-psfrd-eq18.toml");
    second.model.effects[0].parameters[0] += change;
    second.fits.resize(second.model.effects.size());
    for (auto& each : second.fits) each.resize(1);
    second.fits[0][0].standard_error = stated;
    References references = pcor::read_references({"lams"}, laser_model(), {}).used;
    references.push_back(pcor::static_system_reference(second));
    pcor::RefitOptions options;
    options.trust_reference = true;
    return parameter(pcor::refit({flight_file()}, laser_model(), references, options), "static-constant.a0");
  };
  const FittedParameter fitted = fit_with(0.0);
  const double change = 0.5 * (fit_with(stated).value - fit_with(-stated).value);
  // The second system has much less noise than the laser, so the fit follows it.
  EXPECT_GT(change, 0.5 * stated);
  // Each fit estimates the weights of the references again.
  constexpr double tolerance = 0.1;
  EXPECT_GT(fitted.standard_error, (1.0 - tolerance) * change);
}

// A second reference with the same errors adds no information. Counted as independent, it made the errors
// sqrt(2) smaller.
TEST(SeveralReferences, OneReferenceGivenTwiceHasTheErrorsOfOne) {
  const References once = pcor::read_references({"lams"}, laser_model(), {}).used;
  References twice = once;
  twice.push_back(once.front());
  pcor::RefitOptions options;
  options.trust_reference = true;
  const RefitResult one = pcor::refit({flight_file()}, laser_model(), once, options);
  const RefitResult both = pcor::refit({flight_file()}, laser_model(), twice, options);
  for (std::size_t p = 0; p < one.parameters.size(); ++p) {
    const double error = one.parameters[p].standard_error;
    EXPECT_NEAR(both.parameters[p].value, one.parameters[p].value, 0.05 * error);
    // The noise of both is that of the residual less the misfit; the fits may differ within their tolerance.
    EXPECT_NEAR(both.parameters[p].standard_error, error, 0.05 * error);
  }
}

TEST(SeveralReferences, RefusalByTotalPressureOmitsTheMinimum) {
  ModelDefinition model = laser_model();
  model.model.policy.minimum = 1.113;
  const auto error = pcor::test::error_of([&] { fit_of_short_flight(model, {"total:PSFRD+QCFR"}); });
  EXPECT_THAT(error, pcor::test::IsError(pcor::Error::Code::fit, "static-constant.a0"));
  EXPECT_THAT(error, testing::Not(pcor::test::IsError(pcor::Error::Code::fit, "1.113")));
}

TEST(SeveralReferences, ReportStatisticsOfTheFirstReference) {
  const auto fit_short = [](const std::vector<std::string>& texts) {
    return pcor::refit({pcor::test::short_flight()}, laser_model(),
                       pcor::read_references(texts, laser_model(), {}).used);
  };
  const RefitResult alone = fit_short({"pressure:TRUE_PS"});
  const RefitResult both = fit_short({"pressure:TRUE_PS", "lams"});
  EXPECT_EQ(both.samples, alone.samples);
  EXPECT_EQ(both.masks, alone.masks);
  EXPECT_EQ(both.flights.size(), 1U);
  EXPECT_EQ(both.further.size(), 1U);
  EXPECT_THAT(both.reference_text, testing::AllOf(testing::HasSubstr("TRUE_PS"), testing::HasSubstr("LAMS")));
  // The laser errs by 30 times as much as the transducer.
  for (std::size_t p = 0; p < alone.parameters.size(); ++p) {
    EXPECT_NEAR(both.parameters[p].value, alone.parameters[p].value,
                2.0 * alone.parameters[p].standard_error);
  }
}

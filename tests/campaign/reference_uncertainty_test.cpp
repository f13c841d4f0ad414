#include "campaign/reference_uncertainty.hpp"

#include <gmock/gmock.h>

#include <string>
#include <vector>

#include "support/synthetic_samples.hpp"

namespace {

using pcor::internal::ReferenceUncertainty;
using testing::Contains;
using testing::ElementsAre;
using testing::IsEmpty;
using testing::Not;

TEST(ReferenceUncertainty, PressurePriorCoversZeroGainAndDrift) {
  made::Plan plan;
  plan.defect = made::equation_18;
  const auto flight = made::shared(plan);
  const pcor::ModelDefinition model = made::model({"static-constant", "static-qp"});
  const auto reference = made::pressure_reference().front();
  const ReferenceUncertainty uncertainty(model, *reference, false);
  EXPECT_THAT(uncertainty.names(),
              ElementsAre("pressure:PS_A: psfd-bias.offset", "pressure:PS_A: psfd-gain.gain",
                          "pressure:PS_A: psfd-drift.per_hour"));
  const std::vector<std::size_t> samples{0, 1800, 3599};
  const std::vector<double> parameters{0.004, 0.03};
  const Eigen::MatrixXd columns = uncertainty.columns(flight, samples, parameters.data());
  const std::vector<double>& p = *flight->model.find(pcor::Quantity::static_pressure);
  for (Eigen::Index i = 0; i < 3; ++i) {
    const std::size_t sample = samples[static_cast<std::size_t>(i)];
    // The law reads the measured pressure, so the error of the transducer is that of the corrected pressure.
    EXPECT_NEAR(columns(i, 0), 0.1, 1e-12);
    EXPECT_NEAR(columns(i, 1), 1e-4 * p[sample], 1e-12);
    EXPECT_NEAR(columns(i, 2), 0.03 * static_cast<double>(sample) / 3600.0, 1e-12);
  }
}

TEST(ReferenceUncertainty, TrustedReferenceHasNoUncertainty) {
  const pcor::ModelDefinition model = made::model({"static-constant"});
  EXPECT_THAT(ReferenceUncertainty(model, *made::pressure_reference().front(), true).names(), IsEmpty());
}

TEST(ReferenceUncertainty, SecondSystemHasStatedAndDefaultUncertainties) {
  pcor::ModelDefinition second = made::model({"static-constant"});
  second.variables[pcor::Quantity::static_pressure] = "PSFRD";
  second.uncertainty.static_defect = 0.24;
  second.uncertainty.sensors["psfd-drift.per_hour"] = 0.0;
  const auto reference = pcor::static_system_reference(second);
  const ReferenceUncertainty uncertainty(made::model({"static-constant"}), *reference, false);
  EXPECT_THAT(uncertainty.names(), ElementsAre("PSFRD: psfd-bias.offset", "PSFRD: psfd-gain.gain",
                                               "QCF: qcf-zero.offset", "made of PSFRD/QCF: static_defect"));
  EXPECT_DOUBLE_EQ(uncertainty.sizes()[0], 0.1);
  EXPECT_DOUBLE_EQ(uncertainty.sizes()[3], 0.24);
  // A static defect cancels in a total pressure.
  const auto total = pcor::total_pressure_reference(second);
  EXPECT_THAT(ReferenceUncertainty(made::model({"static-constant"}), *total, false).names(),
              ElementsAre("PSFRD: psfd-bias.offset", "PSFRD: psfd-gain.gain", "QCF: qcf-zero.offset"));
}

// Systems are identified by their sensors: with equal names they shared all errors.
TEST(ReferenceUncertainty, SystemsOfOneNameHaveTheirOwnErrors) {
  const auto names_of = [](const std::string& static_pressure, const std::string& name) {
    pcor::ModelDefinition system = made::model({"static-constant"});
    system.model.name = name;
    system.variables[pcor::Quantity::static_pressure] = static_pressure;
    system.uncertainty.static_defect = 0.24;
    system.fits.resize(1);
    system.fits[0].resize(1);
    system.fits[0][0].standard_error = 1e-4;
    return ReferenceUncertainty(made::model({"static-constant"}), *pcor::static_system_reference(system),
                                false, true)
        .names();
  };
  const std::vector<std::string> one = names_of("PSFRD", "second");
  EXPECT_THAT(one, Contains("second of PSFRD/QCF: law, direction 1"));
  for (const std::string& name : names_of("PSX", "second")) {
    if (name == "QCF: qcf-zero.offset") continue;  // the sensor that both systems have
    EXPECT_THAT(one, Not(Contains(name)));
  }
  // Two laws of the same sensors share the errors of the sensors only.
  const std::vector<std::string> other_law = names_of("PSFRD", "third");
  EXPECT_THAT(other_law, Contains("PSFRD: psfd-bias.offset"));
  EXPECT_THAT(other_law, Not(Contains("second of PSFRD/QCF: static_defect")));
}

}  // namespace

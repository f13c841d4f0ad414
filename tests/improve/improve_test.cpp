#include <gmock/gmock.h>
#include <pcor/base/error.hpp>
#include <pcor/roles/add_effects.hpp>

#include <cmath>
#include <deque>
#include <map>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include "improve/improve_loop.hpp"
#include "support/synthetic_samples.hpp"

using namespace pcor::internal;

using pcor::Diagnosis;
using pcor::Improvement;
using pcor::ImproveStep;
using pcor::ModelDefinition;
using pcor::RefitResult;
using pcor::StopReason;
using pcor::Verdict;
using pcor::internal::ImproveLoop;
using pcor::internal::TrialModel;
using testing::ElementsAre;
using testing::HasSubstr;

namespace {

/// A loop with invented fits: fit number i leaves the held-out rms number i, and after it comes
/// diagnosis number i.
class Improve : public testing::Test {
 protected:
  Improve() {
    loop_.has_holdout = true;
    loop_.flights = "one.nc";
    loop_.refit = [this](const TrialModel& model) { return fitted(model.file); };
    loop_.diagnose = [this](const TrialModel&) {
      const Diagnosis next = diagnoses_.front();
      if (diagnoses_.size() > 1) diagnoses_.pop_front();
      return next;
    };
    loop_.add = [](const TrialModel& model, const pcor::internal::AddedEffect& added) {
      return TrialModel{pcor::add_effects(model.file, {added.effect})};
    };
    loop_.try_models = [this](const std::vector<TrialModel>& models) { return tried(models); };
  }

  RefitResult fitted(const ModelDefinition& model) {
    RefitResult fit;
    fit.model = model;
    fit.model.law.rms_hpa = rms_.front();
    fit.rms = rms_.front() - 0.01;
    fit.noise_rms = rms_.front() / 2.0;
    for (const pcor::ModelEffect& effect : model.model.effects) {
      for (const std::string& name : parameter_names(effect)) {
        pcor::FittedParameter parameter;
        parameter.name = effect.id + "." + name;
        parameter.unit = "s";
        parameter.value = 0.25;
        parameter.standard_error = 0.02;
        parameter.fitted = true;
        fit.parameters.push_back(parameter);
      }
    }
    pcor::FlightFit training;
    training.after.samples = 1000;
    training.after.rms = 99.0;
    pcor::FlightFit held = training;
    held.holdout = true;
    held.after.rms = rms_.front();
    fit.flights = {training, held};
    if (rms_.size() > 1) rms_.pop_front();
    return fit;
  }

  /// A flight of half an hour, and a held-out flight, with the rms stated by the fit of a model, and static
  /// pressures that its effects change by `changes_`.
  std::vector<pcor::internal::TrialFlight> tried(const std::vector<TrialModel>& models) {
    auto samples = std::make_shared<pcor::FlightSamples>();
    samples->name = "made.nc";
    for (std::size_t i = 0; i < 1800; ++i) samples->time.push_back(static_cast<double>(i));
    samples->step = 1.0;
    pcor::internal::TrialFlight flight;
    flight.samples = samples;
    // Noise of an rms of exactly one.
    std::mt19937_64 engine(1);
    std::normal_distribution<double> normal;
    std::vector<double> noise;
    double squares = 0.0;
    for (std::size_t i = 0; i < samples->time.size(); ++i) {
      flight.fitted.push_back(i);
      noise.push_back(normal(engine));
      squares += noise.back() * noise.back();
    }
    for (double& value : noise) value /= std::sqrt(squares / static_cast<double>(noise.size()));
    for (const auto& [model, alike] : models) {
      std::vector<double>& residual = flight.residuals.emplace_back();
      std::vector<double>& pressure = flight.static_pressures.emplace_back();
      double change = 0.0;
      for (const pcor::ModelEffect& effect : model.model.effects) change += changes_[effect.id];
      for (std::size_t i = 0; i < samples->time.size(); ++i) {
        residual.push_back(model.law.rms_hpa.value_or(given_rms_) * noise[i]);
        pressure.push_back(700.0 + change);
      }
    }
    std::vector<pcor::internal::TrialFlight> flights{flight};
    if (loop_.has_holdout) {
      std::swap(flight.fitted, flight.held_out);
      if (!held_out_tells_) flight.residuals.assign(models.size(), noise);
      flights.push_back(flight);
    }
    return flights;
  }

  Improvement run() { return loop_.run(made::model({"static-constant", "static-qp"})); }

  ImproveLoop loop_;
  std::deque<double> rms_{1.0};
  std::deque<Diagnosis> diagnoses_;
  double given_rms_ = 1.0;
  bool held_out_tells_ = true;             // the held-out flight knows one model from another
  std::map<std::string, double> changes_;  // change of the static pressure by effects, hPa
};

pcor::Finding finding(const std::string& id) {
  pcor::Finding finding;
  finding.effect = pcor::neutral_effect(id);
  finding.title = "title of " + id;
  finding.gain = 100.0;
  finding.gain_error = 20.0;
  return finding;
}

Diagnosis diagnosis(Verdict verdict, const std::vector<std::string>& findings = {}) {
  Diagnosis result;
  result.verdict = verdict;
  for (const std::string& id : findings) result.findings.push_back(finding(id));
  return result;
}

Diagnosis with_trace(Diagnosis result, const std::string& variable) {
  pcor::EmpiricalPredictor traced;
  traced.name = variable;
  traced.slope = -0.03;
  traced.formula = "k * (" + variable + " - 48)";
  result.unexplained.significant = true;
  result.unexplained.rms = 0.4;
  result.unexplained.regime = "climb";
  result.unexplained.variables.push_back(traced);
  return result;
}

std::vector<std::string> added(const Improvement& improvement) {
  std::vector<std::string> names;
  for (const ImproveStep& step : improvement.steps) names.push_back(step.added);
  return names;
}

std::vector<std::string> effects(const ModelDefinition& model) {
  std::vector<std::string> ids;
  for (const pcor::ModelEffect& effect : model.model.effects) ids.push_back(effect.id);
  return ids;
}

}  // namespace

TEST_F(Improve, StopsIfNoEffectIsMissing) {
  diagnoses_ = {diagnosis(Verdict::silent)};
  const Improvement improvement = run();
  EXPECT_THAT(added(improvement), ElementsAre(""));
  EXPECT_EQ(improvement.stop_reason, StopReason::nothing_missing);
  EXPECT_EQ(improvement.steps[0].terms, 2U);
  EXPECT_DOUBLE_EQ(improvement.steps[0].rms_train, 0.99);
  EXPECT_DOUBLE_EQ(improvement.steps[0].rms_holdout, 1.0);
  EXPECT_TRUE(improvement.holdout_is_flights);
}

TEST_F(Improve, JudgesAHeldOutFlightAsOneOfAll) {
  diagnoses_ = {diagnosis(Verdict::silent)};
  loop_.refit = [this](const TrialModel& model) {
    RefitResult fit = fitted(model.file);
    fit.flights.push_back(fit.flights.back());
    return fit;
  };
  const Improvement improvement = run();
  const std::vector<pcor::HeldOutPart>& held_out = improvement.steps[0].diagnosis.held_out;
  ASSERT_EQ(held_out.size(), 2U);
  for (const pcor::HeldOutPart& part : held_out) EXPECT_EQ(part.parts, 2U);
}

TEST_F(Improve, AddsAnIdentifiedEffect) {
  diagnoses_ = {diagnosis(Verdict::identified, {"static-lag"}), diagnosis(Verdict::silent)};
  rms_ = {1.0, 0.5};
  const Improvement improvement = run();
  EXPECT_THAT(added(improvement), ElementsAre("", "static-lag"));
  EXPECT_THAT(effects(improvement.model), ElementsAre("static-constant", "static-qp", "static-lag"));
  EXPECT_THAT(improvement.steps[1].title, "title of static-lag");
  EXPECT_THAT(improvement.steps[1].learnt, HasSubstr("tau = 0.25 +- 0.02 s"));
  EXPECT_EQ(improvement.steps[1].terms, 3U);
  EXPECT_EQ(improvement.steps[1].diagnosis.verdict, Verdict::silent);
  EXPECT_EQ(improvement.stop_reason, StopReason::nothing_missing);
}

TEST_F(Improve, AddsEachFindingInItsOwnStep) {
  diagnoses_ = {diagnosis(Verdict::identified, {"static-lag", "static-mach"}),
                diagnosis(Verdict::identified, {"static-mach2"}), diagnosis(Verdict::silent)};
  rms_ = {1.0, 0.7, 0.5};
  EXPECT_THAT(added(run()), ElementsAre("", "static-lag", "static-mach"));
}

TEST_F(Improve, ListsEffectsThatAreNotSeparable) {
  Diagnosis ambiguous = diagnosis(Verdict::ambiguous, {"static-lag"});
  ambiguous.findings[0].aliases = {{}, {}};
  ambiguous.findings[0].aliases[0].effect = "temp-lag";
  ambiguous.findings[0].aliases[1].effect = "total-lag";
  ambiguous.findings[0].advice.sentence = "fly two climbs";
  diagnoses_ = {ambiguous, diagnosis(Verdict::silent)};
  rms_ = {1.0, 0.5};
  const Improvement improvement = run();
  EXPECT_THAT(improvement.steps[1].aliases, ElementsAre("temp-lag", "total-lag"));
  EXPECT_THAT(improvement.steps[1].learnt, HasSubstr("temp-lag, total-lag: fly two climbs"));
}

TEST_F(Improve, DropsAnEffectThatRaisesTheHeldOutResidual) {
  diagnoses_ = {diagnosis(Verdict::identified, {"static-lag", "static-mach"})};
  rms_ = {1.0, 1.0051};
  const Improvement improvement = run();
  EXPECT_THAT(added(improvement), ElementsAre(""));
  EXPECT_THAT(effects(improvement.model), ElementsAre("static-constant", "static-qp"));
  EXPECT_EQ(improvement.stop_reason, StopReason::no_gain);
  EXPECT_THAT(improvement.why_stopped, HasSubstr("static-lag"));
  EXPECT_DOUBLE_EQ(improvement.fit.flights[1].after.rms, 1.0);
}

/// A diagnosis that cannot separate two effects; the first is present with `probability`.
Diagnosis two_rivals(const std::string& one, const std::string& other, double probability) {
  Diagnosis unclear = diagnosis(Verdict::ambiguous, {one});
  pcor::Alias alias;
  alias.effect = other;
  alias.probability = 1.0 - probability;
  if (other.find(':') == std::string::npos) alias.correction = pcor::neutral_effect(other);
  unclear.findings[0].aliases = {alias};
  unclear.findings[0].probability = probability;
  unclear.findings[0].advice.sentence = "fly a yaw manoeuvre";
  return unclear;
}

TEST_F(Improve, ChoosesTheRivalOfMinimumExpectedError) {
  diagnoses_ = {two_rivals("static-lag", "total-lag", 0.75), diagnosis(Verdict::silent)};
  rms_ = {1.0, 0.5};
  changes_ = {{"static-lag", 0.8}, {"total-lag", 1.2}};
  const Improvement improvement = run();
  const ImproveStep& step = improvement.steps[1];
  ASSERT_EQ(step.rivals.size(), 2U);
  EXPECT_EQ(step.rivals[0].effect, "static-lag");
  EXPECT_DOUBLE_EQ(step.rivals[1].probability, 0.25);
  EXPECT_NEAR(step.rivals[1].static_change, 1.2, 1e-9);
  EXPECT_EQ(step.delivered, "static-lag");
  EXPECT_NEAR(step.rival_error, 0.4 * std::sqrt(0.25), 1e-9);
  EXPECT_THAT(effects(improvement.model), ElementsAre("static-constant", "static-qp", "static-lag"));
  EXPECT_GE(improvement.model.uncertainty.static_defect.value_or(0.0), step.rival_error);
  EXPECT_EQ(write_model(pcor::parse_model(write_model(improvement.model), "it")),
            write_model(improvement.model));
}

TEST_F(Improve, EqualRivalsKeepTheNamedEffect) {
  diagnoses_ = {two_rivals("static-lag", "total-lag", 0.75), diagnosis(Verdict::silent)};
  rms_ = {1.0, 0.5};
  changes_ = {{"static-lag", 0.8}, {"total-lag", 0.81}};  // hPa, at a noise of 0.25
  const Improvement improvement = run();
  EXPECT_THAT(improvement.steps[1].rivals, testing::IsEmpty());
  EXPECT_THAT(effects(improvement.model), ElementsAre("static-constant", "static-qp", "static-lag"));
}

TEST_F(Improve, AppliesNoRivalIfAnotherMakesItHarmful) {
  diagnoses_ = {two_rivals("static-lag", "total-lag", 0.75), diagnosis(Verdict::silent)};
  rms_ = {1.0, 0.5};
  changes_ = {{"static-lag", 0.8}, {"total-lag", -0.6}};
  const Improvement improvement = run();
  EXPECT_EQ(improvement.steps[1].delivered, "");
  EXPECT_THAT(effects(improvement.model), ElementsAre("static-constant", "static-qp"));
  EXPECT_NEAR(improvement.steps[1].rival_error, std::sqrt(0.75 * 0.64 + 0.25 * 0.36), 1e-9);
}

TEST_F(Improve, KeepsTheModelIfTheReferenceMayBeWrong) {
  diagnoses_ = {two_rivals("psfd-bias", "reference:psfd-bias", 0.6)};
  const Improvement improvement = run();
  EXPECT_THAT(added(improvement), ElementsAre(""));
  EXPECT_THAT(improvement.why_stopped,
              testing::AllOf(HasSubstr("psfd-bias"), HasSubstr("--trust-reference")));
  EXPECT_EQ(improvement.stop_reason, StopReason::reference_system);
  EXPECT_THAT(improvement.why_stopped, HasSubstr("fly a yaw manoeuvre"));
}

TEST_F(Improve, UninformativeHoldOutUsesFittedFlights) {
  held_out_tells_ = false;
  diagnoses_ = {diagnosis(Verdict::identified, {"static-lag"}), diagnosis(Verdict::silent)};
  rms_ = {1.0, 0.5};
  EXPECT_THAT(added(run()), ElementsAre("", "static-lag"));
  diagnoses_ = {diagnosis(Verdict::identified, {"static-lag"})};
  rms_ = {1.0, 0.5};
  diagnoses_.front().findings[0].gain = 10.0;
  EXPECT_THAT(added(run()), ElementsAre("")) << "less than two deviations";
}

TEST_F(Improve, DropsAnEffectThatCannotBeFitted) {
  diagnoses_ = {diagnosis(Verdict::identified, {"static-lag"})};
  loop_.refit = [this](const TrialModel& trial) {
    const ModelDefinition& model = trial.file;
    if (model.model.effects.size() > 2)
      throw pcor::Error(pcor::Error::Code::fit, "tau and a0 cannot all be free on these flights");
    return fitted(model);
  };
  const Improvement improvement = run();
  EXPECT_THAT(added(improvement), ElementsAre(""));
  EXPECT_THAT(improvement.why_stopped, testing::AllOf(HasSubstr("static-lag"), HasSubstr("tau and a0")));
}

TEST_F(Improve, UnfittableModelIsReported) {
  loop_.refit = [](const TrialModel&) -> RefitResult {
    throw pcor::Error(pcor::Error::Code::samples, "no sample remains");
  };
  EXPECT_THROW(run(), pcor::Error);
}

TEST_F(Improve, PartialFindingIsNotNamedAsCause) {
  diagnoses_ = {diagnosis(Verdict::partial, {"static-lag"}), diagnosis(Verdict::silent)};
  rms_ = {1.0, 0.9};
  const Improvement improvement = run();
  EXPECT_THAT(added(improvement), ElementsAre("", "static-lag"));
  EXPECT_THAT(improvement.steps[1].learnt, HasSubstr("not be the cause"));
}

TEST_F(Improve, TracesIfAPartialFindingDoesNotReduceTheResidual) {
  diagnoses_ = {with_trace(diagnosis(Verdict::partial, {"static-lag"}), "ENGTRQ"),
                diagnosis(Verdict::silent)};
  rms_ = {1.0, 0.995, 0.6};
  EXPECT_THAT(added(run()), ElementsAre("", "traced-engtrq"));
}

TEST_F(Improve, AddsAFormulaOfATracedVariable) {
  diagnoses_ = {with_trace(diagnosis(Verdict::unexplained), "ENG_Trq2"), diagnosis(Verdict::silent)};
  rms_ = {1.0, 0.9};
  const Improvement improvement = run();
  EXPECT_THAT(added(improvement), ElementsAre("", "traced-eng-trq2"));
  const pcor::ModelEffect& effect = improvement.model.model.effects.back();
  EXPECT_EQ(effect.formula, "k * (ENG_Trq2 - 48)");
  EXPECT_THAT(effect.parameters, ElementsAre(-0.03));
  EXPECT_THAT(effect.source, HasSubstr("one.nc"));
  EXPECT_EQ(write_model(pcor::parse_model(write_model(improvement.model), "it")),
            write_model(improvement.model));
  EXPECT_THAT(improvement.steps[1].learnt, HasSubstr("still to be found"));
}

TEST_F(Improve, ATracedVariableMustReduceTheResidual) {
  diagnoses_ = {with_trace(diagnosis(Verdict::unexplained), "ENGTRQ")};
  rms_ = {1.0, 0.991};
  const Improvement improvement = run();
  EXPECT_THAT(added(improvement), ElementsAre(""));
  EXPECT_THAT(improvement.why_stopped, HasSubstr("traced-engtrq"));
}

TEST_F(Improve, NeverAddsAnEffectTwice) {
  diagnoses_ = {with_trace(diagnosis(Verdict::unexplained), "ENGTRQ")};
  rms_ = {1.0, 0.9, 0.8, 0.7};
  const Improvement improvement = run();
  EXPECT_THAT(added(improvement), ElementsAre("", "traced-engtrq"));
  EXPECT_THAT(improvement.why_stopped, HasSubstr("ENGTRQ"));
  diagnoses_ = {diagnosis(Verdict::identified, {"static-qp"})};
  EXPECT_EQ(run().stop_reason, StopReason::in_model);
}

TEST_F(Improve, TracesOnlyOnRequest) {
  diagnoses_ = {with_trace(diagnosis(Verdict::unexplained), "ENGTRQ")};
  loop_.trace_variables = false;
  const Improvement improvement = run();
  EXPECT_THAT(added(improvement), ElementsAre(""));
  EXPECT_EQ(improvement.stop_reason, StopReason::unexplained);
  EXPECT_THAT(improvement.why_stopped, testing::AllOf(HasSubstr("climb"), HasSubstr("ENGTRQ")));
}

TEST_F(Improve, ReportsAResidualThatNoVariableExplains) {
  Diagnosis unexplained = with_trace(diagnosis(Verdict::unexplained), "ENGTRQ");
  unexplained.unexplained.variables.clear();
  diagnoses_ = {unexplained};
  const Improvement improvement = run();
  EXPECT_EQ(improvement.stop_reason, StopReason::unexplained);
  EXPECT_THAT(improvement.why_stopped, testing::Not(HasSubstr("ENGTRQ")));
}

TEST_F(Improve, StopsAfterTheMaximumNumberOfSteps) {
  diagnoses_ = {diagnosis(Verdict::identified, {"static-lag", "static-mach", "static-mach2"})};
  rms_ = {1.0, 0.9, 0.8, 0.7};
  loop_.max_steps = 2;
  const Improvement improvement = run();
  EXPECT_THAT(added(improvement), ElementsAre("", "static-lag", "static-mach"));
  EXPECT_EQ(improvement.stop_reason, StopReason::max_steps);
}

TEST_F(Improve, NoiseOfEachStepIsThatOfItsFit) {
  diagnoses_ = {diagnosis(Verdict::identified, {"static-lag"}), diagnosis(Verdict::silent)};
  rms_ = {1.0, 0.5};
  const Improvement improvement = run();
  EXPECT_DOUBLE_EQ(improvement.steps[0].noise_rms, 0.5);
  EXPECT_DOUBLE_EQ(improvement.steps[1].noise_rms, 0.25);
}

TEST_F(Improve, WorseHeldOutResidualRejectsStep) {
  diagnoses_ = {diagnosis(Verdict::identified, {"static-lag"})};
  rms_ = {1.0, 1.0001};
  const Improvement improvement = run();
  EXPECT_THAT(added(improvement), ElementsAre(""));
  EXPECT_THAT(improvement.why_stopped, HasSubstr("static-lag"));
}

TEST_F(Improve, DegradedModelIsReportedAsWorse) {
  diagnoses_ = {diagnosis(Verdict::silent)};
  given_rms_ = 0.75;
  EXPECT_THAT(run().worse, HasSubstr("1.3333"));
  given_rms_ = 1.25;
  EXPECT_EQ(run().worse, "");
  EXPECT_DOUBLE_EQ(run().given_rms_holdout, 1.25);
}

TEST_F(Improve, HeldOutBiasPreventsSilentVerdict) {
  diagnoses_ = {diagnosis(Verdict::silent)};
  loop_.refit = [this](const TrialModel& model) {
    RefitResult fit = fitted(model.file);
    fit.flights.back().after.rms = 0.272;
    fit.flights.back().flight = "later.nc";
    fit.flights.back().after.bias = 0.14;
    fit.flights.back().expected_bias = 0.03;
    return fit;
  };
  const Improvement improvement = run();
  EXPECT_EQ(improvement.steps.back().diagnosis.verdict, Verdict::unexplained);
  EXPECT_THAT(improvement.why_stopped, AllOf(HasSubstr("later.nc"), HasSubstr("+0.140 hPa"),
                                             HasSubstr("0.272 hPa"), HasSubstr("+- 0.030 hPa")));
}

TEST_F(Improve, WithoutHeldOutFlightsCrossValidationDecides) {
  loop_.has_holdout = false;
  Diagnosis first = diagnosis(Verdict::identified, {"static-lag"});
  Diagnosis second = diagnosis(Verdict::silent);
  first.residual_rms_held_out = 0.8;
  second.residual_rms_held_out = 0.9;
  diagnoses_ = {first, second};
  const Improvement improvement = run();
  EXPECT_THAT(added(improvement), ElementsAre(""));
  EXPECT_DOUBLE_EQ(improvement.steps[0].rms_holdout, 0.8);
  EXPECT_FALSE(improvement.holdout_is_flights);
  EXPECT_THAT(improvement.why_stopped, HasSubstr("static-lag"));
}

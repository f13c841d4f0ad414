// Diagnoses of simulated flights whose missing effect is known.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <pcor/base/error.hpp>
#include <pcor/diagnose/diagnose.hpp>
#include <pcor/effects/catalogue.hpp>
#include <pcor/fit/refit.hpp>
#include <pcor/roles/add_effects.hpp>
#include <pcor/simulate/simulate.hpp>

#include <algorithm>
#include <cmath>
#include <map>
#include <netcdf>
#include <string>
#include <vector>

#include "diagnose/tried_formula.hpp"
#include "support/data.hpp"
#include "support/says.hpp"
#include "support/short_flight.hpp"
#include "support/temporary_directory.hpp"

using pcor::Alias;
using pcor::DiagnoseOptions;
using pcor::Diagnosis;
using pcor::Finding;
using pcor::ModelDefinition;
using pcor::ModelEffect;
using pcor::Verdict;
using pcor::test::laser_model;
using pcor::test::scenarios;
using testing::AllOf;
using testing::AnyOf;
using testing::Contains;
using testing::Field;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;
using testing::SizeIs;

namespace {

using Paths = std::vector<std::filesystem::path>;

const std::string static_lag = "id = \"static-lag\"\ntau = 0.4\n";
const std::string beta_odd = "id = \"static-beta-odd\"\nb1 = -0.006\n";
const std::string engine_torque = R"(id = "unknown"
where = "static"
on = "PSFD"
of = "ENGTRQ"
strength = 3.0
centre = 50
scale = 100
)";
const std::string hidden_wave = R"(id = "unknown"
where = "static"
of = "hidden"
strength = 0.6
centre = 0
scale = 1
)";

/// A flight of a scenario with another seed, an effect, and legs before the landing; each is simulated once.
std::filesystem::path simulated_flight(const std::string& scenario, unsigned seed,
                                       const std::string& effect = "", const std::string& legs = "") {
  static const pcor::test::TemporaryDirectory directory;
  static std::map<std::string, std::filesystem::path> made;
  const std::string key = scenario + std::to_string(seed) + effect + legs;
  if (const auto found = made.find(key); found != made.end()) return found->second;
  std::string text = pcor::test::scenario_text(scenario);
  if (!effect.empty()) text += "\n[[effect]]\n" + effect;
  if (!legs.empty()) text.insert(text.find("[[leg]]\nkind = \"landing\""), legs);
  pcor::Scenario read = pcor::parse_scenario(text, scenario);
  read.seed = seed;
  const std::filesystem::path path = directory / ("flight-" + std::to_string(made.size()) + ".nc");
  pcor::simulate_flight(read, path);
  return made[key] = path;
}

/// Three hours of climbs and descents with a thermometer bias, K, and a static-pressure bias, hPa, and a
/// second system without errors.
std::filesystem::path climbs(unsigned seed, double offset, double bias = 0.0) {
  static const pcor::test::TemporaryDirectory directory;
  const std::filesystem::path path = directory / fmt::format("{}-{}-{}.nc", seed, offset, bias);
  if (std::filesystem::exists(path)) return path;
  pcor::Scenario read = pcor::read_scenario(scenarios / "c130-climbs.toml");
  read.seed = seed;
  read.effects[0].parameters = {{"offset", offset}, {"slope", 0.0}};
  if (bias != 0.0) {
    read.effects.push_back(read.effects[0]);
    read.effects[1].id = "psfd-bias";
    read.effects[1].on = "PSFD";
    read.effects[1].parameters = {{"offset", bias}};
  }
  const pcor::Scenario two_systems = pcor::read_scenario(scenarios / "c130-eq18.toml");
  read.systems.push_back(two_systems.systems[1]);
  pcor::simulate_flight(read, path);
  return path;
}

/// Model of the second system.
ModelDefinition second_model() {
  return pcor::read_model(pcor::test::data_directory / "models" / "c130-psfrd-eq18.toml");
}

/// The laser, and the total pressures of the two systems.
pcor::References laser_and_total() {
  return {pcor::lams_reference(), pcor::read_reference("total:PSFRD+QCFR", laser_model())};
}

Diagnosis diagnose(const Paths& flights, const DiagnoseOptions& options = {}) {
  return pcor::diagnose(flights, laser_model(), {pcor::lams_reference()}, options);
}

/// A formula at the static ports with a coefficient k.
DiagnoseOptions with_formula(const std::string& text) {
  DiagnoseOptions options;
  options.formulas = {pcor::test::tried_formula(text)};
  return options;
}

std::vector<std::string> names_of(const Diagnosis& diagnosis) {
  std::vector<std::string> names;
  for (const Finding& finding : diagnosis.findings) names.push_back(finding.effect.id);
  return names;
}

/// The effect found and its indistinguishable rivals.
std::vector<std::string> family_of(const Finding& finding) {
  std::vector<std::string> names{finding.effect.id};
  for (const Alias& alias : finding.aliases) names.push_back(alias.effect);
  return names;
}

void expect_coefficient(const Finding& finding, double truth) {
  ASSERT_THAT(finding.estimates, SizeIs(1));
  const pcor::CoefficientEstimate& estimate = finding.estimates[0];
  // A normal estimate is beyond four of its errors once in 16,000 times.
  EXPECT_NEAR(estimate.value, truth, 4.0 * estimate.standard_error);
  EXPECT_LT(estimate.standard_error, 0.3 * std::abs(truth));
  EXPECT_EQ(finding.effect.parameters[0], estimate.value);
}

}  // namespace

// A claim is allowed in 0.3 % of such flights, structure in 0.2 %: of four none.
TEST(Diagnose, CompleteModelIsSilent) {
  for (unsigned seed = 301; seed <= 304; ++seed) {
    const Diagnosis diagnosis = diagnose({simulated_flight("c130-eq18", seed)});
    EXPECT_EQ(diagnosis.verdict, Verdict::none_detected) << seed;
    EXPECT_THAT(diagnosis.findings, IsEmpty());
    EXPECT_FALSE(diagnosis.unexplained.significant);
    EXPECT_GT(diagnosis.candidates, 25U);
    EXPECT_GT(diagnosis.samples, 6000U);
    EXPECT_LE(diagnosis.residual_rms, diagnosis.rms_given * 1.02);
    EXPECT_NEAR(diagnosis.noise_rms, diagnosis.residual_rms, 0.1 * diagnosis.residual_rms);
    // Also samples that are alone in four seconds.
    std::ptrdiff_t shown = 0;
    for (const pcor::FlightDiagnosis& each : diagnosis.flights) {
      shown +=
          std::count_if(each.before.begin(), each.before.end(), [](double x) { return std::isfinite(x); });
    }
    EXPECT_EQ(static_cast<std::size_t>(shown), diagnosis.samples);
  }
}

TEST(Diagnose, ShortFlightIsSilent) {
  EXPECT_EQ(diagnose({simulated_flight("c130-short", 311)}).verdict, Verdict::none_detected);
}

TEST(Diagnose, FindsALagOfTheStaticLine) {
  const Diagnosis diagnosis = diagnose({simulated_flight("c130-eq18", 321, static_lag)});
  EXPECT_EQ(diagnosis.verdict, Verdict::identified);
  ASSERT_THAT(names_of(diagnosis), testing::ElementsAre("static-lag"));
  const Finding& finding = diagnosis.findings[0];
  expect_coefficient(finding, 0.4);
  EXPECT_GT(finding.chi2, diagnosis.threshold);
  EXPECT_LT(finding.p_value, 0.003);
  // It adds tau dp/dt: the laser shows that the residual decreases in samples excluded from the fit.
  EXPECT_LT(finding.rms_after, finding.rms_before);
  EXPECT_GT(std::abs(finding.worst), finding.rms);
  ASSERT_FALSE(finding.evidence.empty());
  double share = 0.0;
  for (const pcor::Evidence& each : finding.evidence) {
    share += each.share;
    EXPECT_LT(each.begin, each.end);
    EXPECT_FALSE(each.regimes.empty());
  }
  EXPECT_LE(share, 1.2);
  EXPECT_GE(finding.events, 1.0);
}

TEST(Diagnose, FindsAnEffectOfSideslip) {
  const Diagnosis diagnosis = diagnose({simulated_flight("c130-eq18", 322, beta_odd)});
  ASSERT_THAT(names_of(diagnosis), testing::ElementsAre("static-beta-odd"));
  EXPECT_EQ(diagnosis.verdict, Verdict::identified);
  expect_coefficient(diagnosis.findings[0], -0.006);
  // The laws have no sideslip: the evidence is in the yaw manoeuvres.
  EXPECT_THAT(diagnosis.findings[0].evidence.at(0).regimes, HasSubstr("yaw manoeuvre"));
}

// The coefficients of a model are where the last fit left them, which may be far from these flights.
TEST(Diagnose, FindingIsIndependentOfStartCoefficients) {
  ModelDefinition off = laser_model();
  off.model.effects[0].parameters[0] = 0.001;
  off.model.effects[2].parameters[0] = 0.07;
  const Paths flights{simulated_flight("c130-eq18", 321, static_lag)};
  const Diagnosis fitted = diagnose(flights);
  const Diagnosis diagnosis = pcor::diagnose(flights, off, {pcor::lams_reference()});
  EXPECT_GT(diagnosis.rms_given, 1.2 * diagnosis.residual_rms);
  EXPECT_NEAR(diagnosis.residual_rms, fitted.residual_rms, 0.01);
  ASSERT_THAT(names_of(diagnosis), testing::ElementsAre("static-lag"));
  expect_coefficient(diagnosis.findings[0], 0.4);
}

TEST(Diagnose, FindsTwoEffectsAtOnce) {
  const Diagnosis diagnosis =
      diagnose({simulated_flight("c130-eq18", 323, static_lag + "\n[[effect]]\n" + beta_odd)});
  EXPECT_THAT(names_of(diagnosis), testing::UnorderedElementsAre("static-lag", "static-beta-odd"));
}

// Level legs alone: an effect of the manoeuvres is not seen, or not claimed alone.
TEST(Diagnose, NoManoeuvresGiveNoUnsupportedClaim) {
  for (const auto& [effect, name] : std::vector<std::pair<std::string, std::string>>{
           {"id = \"static-beta-odd\"\nb1 = -0.002\n", "static-beta-odd"},
           {"id = \"load-factor\"\nper_g = 0.5\n", "load-factor"},
           {"id = \"static-attack\"\na3 = 0.0004\n", "static-attack"}}) {
    const Diagnosis diagnosis = diagnose({simulated_flight("c130-no-manoeuvres", 331, effect)});
    EXPECT_NE(diagnosis.verdict, Verdict::partial) << name;
    for (const Finding& finding : diagnosis.findings) EXPECT_THAT(family_of(finding), Contains(name));
  }
}

TEST(Diagnose, UnexplainedStructureIsTracedToItsVariable) {
  const Diagnosis diagnosis = diagnose({simulated_flight("c130-eq18", 341, engine_torque)});
  EXPECT_THAT(diagnosis.verdict, AnyOf(Verdict::unexplained, Verdict::partial));
  ASSERT_TRUE(diagnosis.unexplained.significant);
  ASSERT_FALSE(diagnosis.unexplained.variables.empty());
  const pcor::EmpiricalPredictor& predictor = diagnosis.unexplained.variables[0];
  EXPECT_EQ(predictor.name, "ENGTRQ");
  EXPECT_EQ(predictor.unit, "percent");
  EXPECT_THAT(predictor.formula, HasSubstr("ENGTRQ"));
  // 3 hPa for 100 percent; slow drift in the noise and a memory of the torque take some.
  EXPECT_GT(predictor.slope, 0.01);
  EXPECT_LT(predictor.slope, 0.04);
  ASSERT_THAT(diagnosis.flights, SizeIs(1));
  EXPECT_EQ(diagnosis.flights[0].predictor.size(), diagnosis.flights[0].samples->time.size());
  // The line of the model that lets the effect of the torque be tested.
  EXPECT_THAT(diagnosis.notes, Contains(pcor::test::Says("engine_torque = \"ENGTRQ\"")));
}

TEST(Diagnose, ExcludedSamplesAreNotUsed) {
  DiagnoseOptions options;
  options.not_variables = {"ENGTRQ"};
  for (const pcor::EmpiricalPredictor& variable :
       diagnose({simulated_flight("c130-eq18", 341, engine_torque)}, options).unexplained.variables)
    EXPECT_NE(variable.name, "ENGTRQ");
  options.whole_file = false;
  const Diagnosis diagnosis = diagnose({simulated_flight("c130-eq18", 341, engine_torque)}, options);
  for (const pcor::EmpiricalPredictor& variable : diagnosis.unexplained.variables)
    EXPECT_THAT(variable.formula, IsEmpty()) << variable.name;
}

TEST(Diagnose, HiddenWaveIsReportedAsUnexplained) {
  const Diagnosis diagnosis = diagnose({simulated_flight("c130-eq18", 351, hidden_wave)});
  EXPECT_EQ(diagnosis.verdict, Verdict::unexplained);
  EXPECT_THAT(diagnosis.findings, IsEmpty());
  EXPECT_TRUE(diagnosis.unexplained.significant);
  // The wave has an amplitude of 0.6 hPa, the rms 0.42; the free coefficients take some.
  EXPECT_GT(diagnosis.unexplained.drift_rms, 0.15);
  EXPECT_LT(diagnosis.unexplained.drift_rms, 0.8);
}

TEST(Diagnose, FindsACorrectFormula) {
  const Diagnosis diagnosis =
      diagnose({simulated_flight("c130-eq18", 18, engine_torque)}, with_formula("k * (ENGTRQ - 50) / 100"));
  ASSERT_THAT(names_of(diagnosis), Contains("try-1"));
  EXPECT_EQ(diagnosis.findings[0].effect.id, "try-1");
  expect_coefficient(diagnosis.findings[0], 3.0);
}

// The formula is proportional to the torque, and the error is linear in the torque minus 50 percent: what the
// formula leaves would be named as an effect of the pressure if its shape were exact.
TEST(Diagnose, TheShapeOfAnAddedEffectIsUncertain) {
  const pcor::FlightSet flights(
      {simulated_flight("c130-eq18", 341, engine_torque), simulated_flight("c130-eq18", 342, engine_torque)});
  ModelDefinition law = laser_model();
  law.variables[pcor::Quantity::engine_torque] = "ENGTRQ";
  const pcor::References laser{pcor::lams_reference()};
  ModelDefinition added =
      pcor::refit(flights, pcor::add_effects(law, {pcor::neutral_effect("speedbrake-thrust")}), laser).model;
  EXPECT_THAT(pcor::added_effects(added), testing::ElementsAre("speedbrake-thrust"));
  EXPECT_THAT(names_of(pcor::diagnose(flights, added, laser)), IsEmpty());
  added.provenance.clear();
  EXPECT_THAT(names_of(pcor::diagnose(flights, added, laser)), Not(IsEmpty()));
}

TEST(Diagnose, FormulaWithoutValuesStatesReason) {
  const Diagnosis diagnosis =
      diagnose({simulated_flight("c130-short", 311)}, with_formula("k * log(sideslip - 100)"));
  EXPECT_EQ(diagnosis.verdict, Verdict::none_detected);
  EXPECT_THAT(diagnosis.not_testable,
              Contains(AllOf(Field(&pcor::NotTestable::effect, "try-1"),
                             Field(&pcor::NotTestable::reason, HasSubstr("impossible")))));
}

TEST(Diagnose, FormulaThatIsZeroEverywhereIsNotTested) {
  const Diagnosis diagnosis =
      diagnose({simulated_flight("c130-short", 311)}, with_formula("k * max(mach - 5, 0)"));
  EXPECT_THAT(diagnosis.not_testable, Contains(Field(&pcor::NotTestable::effect, "try-1")));
}

TEST(Diagnose, OnlyTheTrainingShareIsUsed) {
  const Paths flights{simulated_flight("c130-eq18", 321, static_lag)};
  DiagnoseOptions options;
  options.training_share = 0.6;
  const Diagnosis part = diagnose(flights, options);
  const Diagnosis whole = diagnose(flights);
  EXPECT_NEAR(static_cast<double>(part.samples), 0.6 * static_cast<double>(whole.samples), 1.0);
  const std::vector<double>& before = part.flights.at(0).before;
  std::size_t used = 0;
  std::size_t last = 0;
  for (std::size_t i = 0; i < before.size(); ++i) {
    if (std::isnan(before[i])) continue;
    ++used;
    last = i;
  }
  EXPECT_EQ(used, part.samples);
  // The remaining samples are later.
  EXPECT_LT(last + 1, whole.flights.at(0).before.size());
  EXPECT_FALSE(std::isnan(whole.flights.at(0).before[last]));
}

TEST(Diagnose, TwoFlightsConstrainMoreThanOne) {
  const std::filesystem::path first = simulated_flight("c130-eq18", 321, static_lag);
  const std::filesystem::path second = simulated_flight("c130-eq18", 324, static_lag);
  std::size_t done = 0;
  DiagnoseOptions options;
  options.progress = [&](std::size_t now, std::size_t total) {
    done = now;
    EXPECT_EQ(total, 2U);
  };
  const Diagnosis one = diagnose({first});
  const Diagnosis both = diagnose({first, second}, options);
  EXPECT_EQ(done, 2U);
  ASSERT_THAT(names_of(both), testing::ElementsAre("static-lag"));
  ASSERT_THAT(names_of(one), testing::ElementsAre("static-lag"));
  EXPECT_THAT(both.flights, SizeIs(2));
  expect_coefficient(both.findings[0], 0.4);
  // Twice the evidence: the error decreases by the root of two, except for the change of the estimated
  // noise, because two flights determine the slow part better.
  const double ratio =
      both.findings[0].estimates[0].standard_error / one.findings[0].estimates[0].standard_error;
  EXPECT_GT(ratio, 0.9 * std::sqrt(0.5));
  EXPECT_LT(ratio, 0.95);
}

TEST(Diagnose, RepeatedRunsGiveTheSameResult) {
  const Paths flights{simulated_flight("c130-eq18", 322, beta_odd)};
  const Diagnosis first = diagnose(flights);
  const Diagnosis second = diagnose(flights);
  EXPECT_EQ(first.threshold, second.threshold);
  ASSERT_EQ(names_of(first), names_of(second));
  EXPECT_EQ(first.findings[0].estimates[0].value, second.findings[0].estimates[0].value);
  EXPECT_EQ(first.findings[0].p_value, second.findings[0].p_value);
  EXPECT_EQ(first.residual_rms, second.residual_rms);
  EXPECT_EQ(first.unexplained.shares_noise, second.unexplained.shares_noise);
}

TEST(Diagnose, EffectSeriesHasTheStatedRms) {
  const Diagnosis diagnosis = diagnose({simulated_flight("c130-eq18", 321, static_lag)});
  const pcor::FlightDiagnosis& along = diagnosis.flights.at(0);
  ASSERT_THAT(along.added, SizeIs(diagnosis.findings.size()));
  double squares = 0.0;
  double count = 0.0;
  std::size_t used = 0;
  for (std::size_t i = 0; i < along.before.size(); ++i) {
    used += std::isnan(along.before[i]) ? 0 : 1;
    if (std::isnan(along.added[0][i])) continue;
    squares += along.added[0][i] * along.added[0][i];
    count += 1.0;
  }
  EXPECT_EQ(used, diagnosis.samples);
  // The law absorbs little of an effect that its terms do not resemble.
  EXPECT_LE(diagnosis.findings[0].rms, std::sqrt(squares / count));
  EXPECT_GT(diagnosis.findings[0].rms, 0.9 * std::sqrt(squares / count));
}

TEST(Diagnose, ModelWithoutFreeCoefficientsIsDiagnosed) {
  ModelDefinition fixed = laser_model();
  fixed.fits.assign(3, pcor::EffectFit(1));
  for (pcor::EffectFit& fit : fixed.fits) fit[0].fixed = true;
  const Diagnosis diagnosis =
      pcor::diagnose({simulated_flight("c130-eq18", 322, beta_odd)}, fixed, {pcor::lams_reference()});
  // The first is measured at the sensor, which is the residual to first order.
  EXPECT_NEAR(diagnosis.residual_rms, diagnosis.rms_given, 1e-3 * diagnosis.rms_given);
  EXPECT_THAT(names_of(diagnosis), Contains("static-beta-odd"));
}

TEST(Diagnose, StaticSystemReferenceFindsUnsharedEffects) {
  const Diagnosis diagnosis =
      pcor::diagnose({simulated_flight("c130-eq18", 361, "on = \"PSFD\"\n" + beta_odd)}, laser_model(),
                     {pcor::static_system_reference(second_model())});
  EXPECT_THAT(names_of(diagnosis), Contains("static-beta-odd"));
}

// A curve in attack of one of two systems: the difference names an effect of either, in any of its shapes.
TEST(Diagnose, SameEffectOfTheOtherSystemIsARival) {
  const auto reference = pcor::static_system_reference(second_model());
  pcor::DiagnoseOptions trusted;
  trusted.trust_reference = true;
  const Paths flights{simulated_flight("c130-eq18", 361, "on = \"PSFD\"\n" + beta_odd)};
  for (const pcor::Finding& finding : pcor::diagnose(flights, laser_model(), {reference}).findings) {
    const auto names_either = [&](const pcor::Alias& alias) {
      return alias.effect == "reference:" + finding.id() || "reference:" + alias.effect == finding.id();
    };
    const auto twin = std::find_if(finding.aliases.begin(), finding.aliases.end(), names_either);
    ASSERT_NE(twin, finding.aliases.end()) << finding.id();
    // The difference of two systems is symmetric; their pressures differ by 0.3 %.
    EXPECT_NEAR(twin->probability, finding.probability, 0.01) << finding.id();
    EXPECT_TRUE(finding.may_be_of_model() && finding.may_be_of_reference());
  }
  const Diagnosis diagnosis = pcor::diagnose(flights, laser_model(), {reference}, trusted);
  EXPECT_THAT(names_of(diagnosis), Contains("static-beta-odd"));
  for (const pcor::Finding& finding : diagnosis.findings) {
    EXPECT_FALSE(finding.of_reference) << finding.id();
    for (const pcor::Alias& alias : finding.aliases)
      EXPECT_THAT(alias.effect, testing::Not(testing::StartsWith("reference:")));
  }
}

// Level legs alone: four effects together describe the engines nearly, and not at all in the total pressure.
TEST(Diagnose, LineIsComparedWithEffectsByAllReferences) {
  std::string torque = engine_torque;
  torque.replace(torque.find("3.0"), 3, "6.0");
  const Diagnosis diagnosis =
      pcor::diagnose({simulated_flight("c130-no-manoeuvres", 702, torque)}, laser_model(), laser_and_total());
  EXPECT_THAT(diagnosis.notes, Contains(pcor::test::Says("line in ENGTRQ")));
}

// An error that varies with the engines acts at the static ports, or in the total line; the total pressures
// separate the two.
TEST(Diagnose, TotalPressuresLocateTracedVariable) {
  for (const bool total : {false, true}) {
    std::string torque = engine_torque;
    if (total) torque.replace(torque.find("static"), 6, "total");
    const Diagnosis diagnosis =
        pcor::diagnose({simulated_flight("c130-eq18", 343, torque)}, laser_model(), laser_and_total());
    ASSERT_FALSE(diagnosis.unexplained.variables.empty()) << total;
    // The laser alone shows an error in the total line as a drift that varies with more than one variable.
    const pcor::EmpiricalPredictor& predictor = diagnosis.unexplained.variables.front();
    if (!total) {
      EXPECT_EQ(predictor.name, "ENGTRQ");
    }
    EXPECT_EQ(predictor.location, total ? pcor::EffectLocation::pitot : pcor::EffectLocation::static_defect);
    EXPECT_EQ(predictor.components.front(), total ? "pitot" : "port");
    EXPECT_EQ(std::count(predictor.components.begin(), predictor.components.end(), "laser"), total ? 0 : 1);
    EXPECT_THAT(component_text(predictor), HasSubstr(total ? "also vary with" : "do not vary with"));
  }
}

// The simulated avionics low-pass their pressures; the second pair does not.
TEST(Diagnose, EffectIsAssignedToOneOfTwoSystems) {
  pcor::References references = laser_and_total();
  references.push_back(pcor::read_reference("total:PS_A+QC_A", laser_model()));
  const Diagnosis diagnosis = pcor::diagnose({simulated_flight("c130-eq18", 363)}, laser_model(), references);
  ASSERT_THAT(diagnosis.findings, SizeIs(1));
  const Finding& finding = diagnosis.findings[0];
  EXPECT_EQ(finding.id(), "reference:PS_A+QC_A:total-lag");
  EXPECT_THAT(finding.title, HasSubstr("PS_A+QC_A"));
  EXPECT_GT(finding.rms, 0.1) << "the reference that has it";
  for (const pcor::UpperLimit& limit : diagnosis.limits) EXPECT_GT(limit.rms, 0.0) << limit.effect;
}

// A drift of the static transducer cancels in the residual by the laser, but not in the total pressure.
TEST(Diagnose, LargestSizeIsThatOfOneReference) {
  const Paths drift{simulated_flight("c130-eq18", 364, "id = \"time-drift\"\non = \"PSFD\"\nstatic = 0.4\n")};
  const Diagnosis both = pcor::diagnose(drift, laser_model(), laser_and_total());
  const Diagnosis total = pcor::diagnose(drift, laser_model(), {laser_and_total()[1]});
  ASSERT_THAT(both.findings, SizeIs(1));
  ASSERT_THAT(total.findings, SizeIs(1));
  EXPECT_EQ(both.findings[0].largest_reference, "total:PSFRD+QCFR");
  EXPECT_EQ(total.findings[0].largest_reference, "");
  EXPECT_DOUBLE_EQ(total.findings[0].largest_rms, total.findings[0].rms);
  // The estimates of the drift differ by less than 1 %, and the samples by those that the laser lacks.
  EXPECT_NEAR(both.findings[0].largest_rms / total.findings[0].rms, 1.0, 0.02);
  EXPECT_GT(both.findings[0].largest_rms, 5.0 * both.findings[0].rms);
}

// The second pair is frozen for five minutes of a climb.
TEST(Diagnose, FrozenSensorOfFurtherReferenceIsRejected) {
  const pcor::test::TemporaryDirectory directory;
  const std::filesystem::path path = directory / "frozen.nc";
  std::filesystem::copy_file(simulated_flight("c130-eq18", 362), path);
  {
    netCDF::NcFile file(path.string(), netCDF::NcFile::write);
    const netCDF::NcVar variable = file.getVar("PSFRD");
    double value = 0.0;
    variable.getVar({1000}, {1}, &value);
    variable.putVar({1000}, {300}, std::vector<double>(300, value).data());
  }
  const Diagnosis diagnosis = pcor::diagnose({path}, laser_model(), laser_and_total());
  EXPECT_THAT(diagnosis.notes, Contains(pcor::test::Says("PSFRD is frozen")));
  EXPECT_EQ(diagnosis.verdict, Verdict::none_detected);
}

// To the laser an offset of the thermometer is a change of the law; to the heights of its climbs it is not.
TEST(Diagnose, HeightsShowThermometerBias) {
  const Paths flights{climbs(391, 1.0)};
  EXPECT_THAT(diagnose(flights).findings, IsEmpty());
  const pcor::References references{pcor::lams_reference(), pcor::height_reference(laser_model())};
  const Diagnosis diagnosis = pcor::diagnose(flights, laser_model(), references);
  ASSERT_THAT(diagnosis.findings, SizeIs(1));
  const Finding& finding = diagnosis.findings[0];
  EXPECT_THAT(family_of(finding), Contains("temp-offset"));
  // Errors that one flight with a laser does not separate: thermometer, recovery, beam, dynamic pressure.
  EXPECT_THAT(family_of(finding), SizeIs(testing::Le(4U)));
  if (finding.effect.id != "temp-offset") return;
  // Isobars that rise along the track look like a few tenths of a kelvin.
  EXPECT_NEAR(finding.estimates[0].value, 1.0, 0.3);
}

// The total pressures of two systems show that one is off, the heights which.
TEST(Diagnose, HeightsIdentifyTheWrongSystem) {
  const Paths flights{climbs(397, 0.0, 0.5)};
  const auto total = pcor::total_pressure_reference(second_model());
  const auto names = [&](const pcor::References& references) {
    const Diagnosis diagnosis = pcor::diagnose(flights, laser_model(), references);
    return diagnosis.findings.size() == 1 ? family_of(diagnosis.findings[0]) : std::vector<std::string>{};
  };
  const std::vector<std::string> without = names({pcor::lams_reference(), total});
  EXPECT_THAT(without, Contains("psfd-bias"));
  EXPECT_GT(without.size(), 3U);
  const std::vector<std::string> with =
      names({pcor::lams_reference(), total, pcor::height_reference(laser_model())});
  EXPECT_THAT(with, Contains("psfd-bias"));
  EXPECT_LT(with.size(), without.size());
}

TEST(Diagnose, CompleteModelAgainstHeightsIsSilent) {
  const pcor::References references{pcor::height_reference(laser_model()), pcor::lams_reference()};
  for (unsigned seed = 394; seed <= 396; ++seed) {
    const Diagnosis diagnosis = pcor::diagnose({climbs(seed, 0.0)}, laser_model(), references);
    EXPECT_THAT(diagnosis.findings, IsEmpty()) << seed;
    EXPECT_THAT(diagnosis.reference, testing::StartsWith("LAMS"))
        << "references with a residual for each sample are first";
  }
}

TEST(Diagnose, WindAndLaserAreUsedTogether) {
  const Diagnosis diagnosis = pcor::diagnose({climbs(394, 0.0)}, laser_model(),
                                             {pcor::wind_reference(laser_model()), pcor::lams_reference()});
  EXPECT_EQ(diagnosis.verdict, Verdict::none_detected);
  EXPECT_THAT(diagnosis.reference, testing::StartsWith("LAMS"));
}

TEST(Diagnose, MissingFlightsOrSamplesAreErrors) {
  EXPECT_THROW(diagnose({}), pcor::Error);
  EXPECT_THROW(diagnose({"/nowhere/flight.nc"}), pcor::Error);
  DiagnoseOptions options;
  options.training_share = 0.1;
  EXPECT_THROW(diagnose({simulated_flight("c130-short", 311)}, options), pcor::Error);
}

// Rules for advice on any effect.
void expect_advice(const Diagnosis& diagnosis) {
  for (const Finding& finding : diagnosis.findings) {
    const pcor::Advice& advice = finding.advice;
    SCOPED_TRACE(advice.sentence);
    EXPECT_EQ(advice.sentence.empty(), finding.aliases.empty());
    EXPECT_GE(advice.power, 0.0);
    EXPECT_LE(advice.power, 1.0);
    EXPECT_EQ(advice.power > 0.0, !advice.manoeuvre.empty());
    EXPECT_EQ(advice.duration > 0.0, !advice.manoeuvre.empty());
    if (advice.sentence.empty()) continue;
    EXPECT_THAT(advice.sentence, HasSubstr(finding.effect.id));
    for (const Alias& alias : finding.aliases) EXPECT_THAT(advice.sentence, HasSubstr(alias.effect));
    if (advice.manoeuvre.empty()) {
      EXPECT_THAT(advice.sentence, HasSubstr(std::string(pcor::effect_named(finding.effect.id)->manoeuvre)));
      continue;
    }
    EXPECT_THAT(advice.sentence, HasSubstr(advice.manoeuvre));
    EXPECT_TRUE(std::any_of(
        diagnosis.flights.begin(), diagnosis.flights.end(), [&advice](const pcor::FlightDiagnosis& along) {
          const std::vector<pcor::Interval>& intervals = along.samples->intervals;
          return std::any_of(intervals.begin(), intervals.end(), [&advice](const pcor::Interval& interval) {
            return pcor::info_of(interval.regime).name == advice.manoeuvre;
          });
        }));
  }
}

TEST(Advice, NamesRivalsAndAManoeuvre) {
  for (const auto& [scenario, effect] : std::vector<std::pair<std::string, std::string>>{
           {"c130-no-manoeuvres", "id = \"static-beta-odd\"\nb1 = -0.009\n"},
           {"c130-eq18", "id = \"load-factor\"\nper_g = 0.8\n"},
           {"c130-short", "id = \"total-lag\"\ntau = 0.3\n"}}) {
    for (unsigned seed = 371; seed <= 373; ++seed)
      expect_advice(diagnose({simulated_flight(scenario, seed, effect)}));
  }
}

// Level legs alone show the sideslip, and no flown regime separates ports from laser: the advice comes from
// the catalogue.
TEST(Advice, ComesFromTheCatalogueIfNoFlownRegimeHelps) {
  const Diagnosis diagnosis =
      diagnose({simulated_flight("c130-no-manoeuvres", 371, "id = \"static-beta-odd\"\nb1 = -0.009\n")});
  expect_advice(diagnosis);
  ASSERT_THAT(diagnosis.findings, SizeIs(1));
  EXPECT_THAT(diagnosis.findings[0].aliases, Not(IsEmpty()));
  EXPECT_THAT(diagnosis.findings[0].advice.manoeuvre, IsEmpty());
}

// Four more yaw manoeuvres are predicted to separate the ports from the laser in about nine of ten flights,
// and do.
TEST(AdviceStudy, FollowedAdviceSeparatesTheEffects) {
  const std::string effect = "id = \"static-beta-odd\"\nb1 = -0.003\n";
  const std::string yaw = "[[leg]]\nkind = \"yaw\"\ncycles = 12\n\n";
  int followed = 0;
  int separated = 0;
  double expected = 0.0;
  for (unsigned seed = 11; seed <= 18; ++seed) {
    const Diagnosis before = diagnose({simulated_flight("c130-eq18", seed, effect)});
    expect_advice(before);
    ASSERT_THAT(before.findings, SizeIs(1));
    const pcor::Advice& advice = before.findings[0].advice;
    if (advice.manoeuvre != "yaw manoeuvre") continue;
    EXPECT_NEAR(advice.duration, 4.0 * 144.0, 40.0);  // tolerance: detected cycles of 12 s
    const Diagnosis after = diagnose({simulated_flight("c130-eq18", seed, effect, yaw + yaw + yaw + yaw)});
    ASSERT_THAT(names_of(after), testing::ElementsAre("static-beta-odd"));
    ++followed;
    expected += advice.power;
    if (after.findings[0].aliases.empty()) ++separated;
  }
  EXPECT_GE(followed, 4);
  // Beyond three deviations of a binomial distribution once in 400 times.
  EXPECT_NEAR(separated, expected, 3.0 * std::sqrt(expected * (1.0 - expected / followed)));
}

#include <pcor/diagnose/diagnosis_report.hpp>
#include <pcor/improve/improvement_report.hpp>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <memory>
#include <random>
#include <stdexcept>
#include <string>
#include <variant>
#include <vector>

#include <pcor/base/error.hpp>
#include <pcor/report/json.hpp>
#include "numerics/missing.hpp"

namespace pcor {
namespace {

using internal::infinity;
using internal::nan;

using testing::AllOf;
using testing::AnyOf;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;

constexpr double start = 1321560000.0;  // 2011-11-17 20:00:00 UTC

/// An hour: a climb, a level leg with a yaw manoeuvre, a descent. Two effects are missing, one with sideslip
/// and one with the vertical speed, and one error varies with the torque. The first 100 samples are not
/// used.
FlightDiagnosis diagnosed_flight(const std::string& name, unsigned seed) {
  constexpr std::size_t count = 3600;
  auto samples = std::make_shared<FlightSamples>();
  samples->name = name;
  FlightDiagnosis made;
  made.added.resize(2);
  made.evidence.resize(2);
  std::mt19937 engine(seed);
  std::normal_distribution<double> normal;
  double noise = 0.0;
  const double begin = start + 86400.0 * seed;
  for (std::size_t i = 0; i < count; ++i) {
    const auto t = static_cast<double>(i);
    const bool yaw = i >= 1800 && i < 2100;
    const double climb = (i < 1200 ? 6.0 : i < 2700 ? 0.0 : -5.0) + std::sin(t / 50.0);
    const double sideslip = (yaw ? 4.0 * std::sin(t / 1.6) : 0.0) + 0.2 * normal(engine);
    const double torque = 60.0 + 20.0 * std::sin(t / 400.0);
    noise = 0.8 * noise + 0.6 * 0.08 * normal(engine);
    const double first = 0.07 * sideslip;
    const double second = 0.03 * climb;
    const bool used = i >= 100;
    samples->time.push_back(begin + t);
    samples->motion.vertical_speed.push_back(climb);
    made.static_pressure.push_back(900.0 - (i < 1200   ? t / 4.0
                                            : i < 2700 ? 300.0
                                                       : 300.0 - (t - 2700.0) / 5.0));
    made.mach.push_back(0.3 + 0.02 * std::sin(t / 300.0));
    made.attack.push_back(nan);
    made.sideslip.push_back(sideslip);
    made.predictor.push_back(torque);
    made.drift.push_back(0.03 * std::sin(t / 900.0));
    const double residual = 0.003 * (torque - 60.0) + made.drift.back() + noise;
    made.before.push_back(used ? residual + first + second : nan);
    made.after.push_back(used ? residual : nan);
    made.added[0].push_back(first);
    made.added[1].push_back(second);
    made.evidence[0].push_back(used ? (yaw ? 40.0 : 0.3 * normal(engine)) : nan);
    made.evidence[1].push_back(used ? (std::abs(climb) > 2.0 ? 5.0 : 0.0) + 0.3 * normal(engine) : nan);
  }
  samples->intervals = {{Regime::climb, begin, begin + 1200.0},
                        {Regime::level, begin + 1200.0, begin + 2700.0},
                        {Regime::yaw_manoeuvre, begin + 1800.0, begin + 2100.0},
                        {Regime::descent, begin + 2700.0, begin + 3600.0}};
  made.samples = samples;
  return made;
}

Finding sideslip_finding() {
  Finding finding;
  finding.effect.id = "static-beta-odd";
  finding.effect.parameters = {-0.00171};
  finding.title = "static-port error with sideslip, ports not perfectly paired";
  finding.estimates = {{"b1", "1", -0.00171, 0.00012, -0.0018}};
  finding.largest_rms = 0.083;
  finding.worst = -0.3654;
  finding.worst_flight = "rf02";
  finding.worst_time = start + 1912.0;
  finding.chi2 = 312.4;
  finding.p_value = 0.0;
  finding.rms_before = 0.196;
  finding.rms_after = 0.152;
  finding.events = 2.0;
  finding.evidence = {{"rf01", start + 1800.0, start + 2100.0, "level, yaw manoeuvre", 0.55},
                      {"rf02", start + 88200.0, start + 88500.0, "level, yaw manoeuvre", 0.41}};
  finding.aliases = {{"lams-azimuth",
                      "error of the azimuth of the laser beam",
                      0.991,
                      1.4,
                      3.2,
                      {{"azimuth", "deg", 0.32, 0.03, 0.1}}}};
  finding.probability = 0.65;
  finding.aliases.front().probability = 0.35;
  finding.advice = {
      "fly 2 more yaw manoeuvres of 1.5 min each as on rf01: probability 93 % that they separate "
      "static-beta-odd from lams-azimuth",
      "yaw manoeuvre", 180.0, 0.93};
  return finding;
}

Finding lag_finding() {
  Finding finding;
  finding.effect.id = "static-lag";
  finding.effect.parameters = {0.31};
  finding.title = "pneumatic lag of the static line";
  finding.estimates = {{"tau", "s", 0.31, 0.044, 0.15}};
  finding.largest_rms = 0.11;
  finding.chi2 = 88.0;
  return finding;
}

Diagnosis partial() {
  Diagnosis diagnosis;
  diagnosis.verdict = Verdict::partial;
  diagnosis.reference = "LAMS";
  diagnosis.findings = {sideslip_finding(), lag_finding()};
  diagnosis.unexplained.significant = true;
  diagnosis.unexplained.rms = 0.047;
  diagnosis.unexplained.drift_rms = 0.02;
  diagnosis.unexplained.p_value = 0.002;
  diagnosis.unexplained.regime = "level";
  diagnosis.unexplained.variables = {
      {"ENGTRQ", "percent", "engine torque", 0.31, 0.004, 0.29, 0.0031, 0.0004, 60.0, "k * (ENGTRQ - 60)"}};
  diagnosis.unexplained.shares_noise = {"QCF", "TASX"};
  diagnosis.absorbed = {{"psfd-bias", "bias of the static transducer", {"static-constant.a0"}, 0.0021}};
  diagnosis.limits = {
      {"clock-skew", "clock of the laser is late", {{"dt", "s", 0.03, 0.05, 0.3}}, {0.13}, 0.021, ""},
      {"load-factor",
       "static-port error in accelerated flight",
       {{"k", "hPa/g", nan, nan, 1.0}},
       {nan},
       nan,
       "hardly moves on these flights"}};
  diagnosis.not_testable = {{"static-leak", "leak from the pressurised cabin into the static line",
                             "needs the role 'cabin_pressure'"}};
  diagnosis.candidates = 41;
  diagnosis.threshold = 14.3;
  diagnosis.rms_given = 0.214;
  diagnosis.residual_rms = 0.196;
  diagnosis.residual_rms_held_out = 0.199;
  diagnosis.noise_rms = 0.081;
  diagnosis.samples = 7000;
  diagnosis.masks[0] = 7000;
  diagnosis.masks[3] = 200;
  diagnosis.flights = {diagnosed_flight("rf01", 0), diagnosed_flight("rf02", 1)};
  diagnosis.notes = {"the laser of rf02 was off for 3 min"};
  return diagnosis;
}

Diagnosis unexplained() {
  Diagnosis diagnosis = partial();
  diagnosis.verdict = Verdict::unexplained;
  diagnosis.findings.clear();
  for (FlightDiagnosis& one : diagnosis.flights) {
    one.added.clear();
    one.evidence.clear();
    one.after = one.before;
  }
  return diagnosis;
}

Diagnosis none_detected() {
  Diagnosis diagnosis = unexplained();
  diagnosis.verdict = Verdict::none_detected;
  diagnosis.unexplained = {};
  return diagnosis;
}

Improvement improvement() {
  Improvement made;
  made.holdout_is_flights = true;
  made.stop_explanation = "no further effect exceeds the threshold";
  made.steps.resize(3);
  ImproveStep& foot = made.steps[0];
  foot.rms_train = 0.196;
  foot.rms_holdout = 0.203;
  foot.noise_rms = 0.081;
  foot.terms = 3;
  foot.diagnosis = partial();
  foot.diagnosis.verdict = Verdict::ambiguous;
  foot.diagnosis.findings = {sideslip_finding()};
  ImproveStep& middle = made.steps[1];
  middle = foot;
  middle.added = "static-beta-odd";
  middle.title = sideslip_finding().title;
  middle.aliases = {"lams-azimuth"};
  middle.rms_holdout = 0.161;
  middle.terms = 4;
  middle.summary = "sideslip counts, be it at the ports or at the laser";
  middle.diagnosis.findings.clear();
  for (FlightDiagnosis& one : middle.diagnosis.flights) {
    for (std::size_t i = 0; i < one.before.size(); ++i) one.before[i] -= one.added[0][i];
  }
  ImproveStep& top = made.steps[2];
  top = middle;
  top.added = "ENGTRQ-trace";
  top.title = "a line in ENGTRQ";
  top.aliases.clear();
  top.rms_holdout = 0.12;
  top.terms = 5;
  top.diagnosis = none_detected();
  made.fit.parameters = {{"static-beta-odd.b1", "1", 0.0, -0.00169, 0.00011, true, false, 1}};
  made.model.model.effects = {sideslip_finding().effect,
                              {"ENGTRQ-trace", {0.003}, {"k"}, "k * (ENGTRQ - 60)"}};
  return made;
}

std::shared_ptr<const FlightSamples> renamed(FlightSamples samples, const std::string& name) {
  samples.name = name;
  return std::make_shared<const FlightSamples>(std::move(samples));
}

/// A flight of an improvement. @param fitted number of its samples in the fit; the others are held out
ImprovedFlight improved(const FlightDiagnosis& flight, std::size_t fitted) {
  return {flight.samples, fitted, flight.before.size() - fitted, flight.before, flight.before, flight.before};
}

ModelDefinition named_model() {
  ModelDefinition file;
  file.model.name = "C-130 PSFD 2011";
  return file;
}

/// Item of a report by its title; an exception fails the test if it is absent.
template <class Item>
const Item& item(const Report& report, const std::string& title) {
  for (const ReportItem& one : report.items) {
    if (const auto* found = std::get_if<Item>(&one); found != nullptr && found->title == title) return *found;
  }
  throw std::runtime_error("no item " + title);
}

/// Words of the page, without its data and its script: no NaN or infinity may be printed.
std::string split_words(const Report& report) {
  const std::string html = report_html(report);
  const std::string body = html.substr(html.find("<body>"), html.find("id=\"data\"") - html.find("<body>"));
  EXPECT_THAT(body, Not(testing::ContainsRegex("[^a-z]-?(nan|inf)[^a-z]")));
  return body;
}

TEST(DiagnosisReport, StatesFindingSizeAndSignificance) {
  const Report report = diagnosis_report(partial(), named_model());
  EXPECT_EQ(report.title,
            "Effects are missing: static-beta-odd and static-lag; the remaining structure is not explained "
            "by any effect");
  EXPECT_EQ(report.subtitle, "Diagnosis of C-130 PSFD 2011 against LAMS");
  // Findings come first: size, rivals with their probabilities, advice.
  EXPECT_THAT(report.summary[0],
              AllOf(HasSubstr("(static-beta-odd)"), HasSubstr("0.083 hPa"), HasSubstr("65 %"),
                    HasSubstr("lams-azimuth (35 %)"), HasSubstr("2 more yaw manoeuvres of 1.5 min")));
  EXPECT_THAT(report.summary[1], AllOf(HasSubstr("(static-lag)"), HasSubstr("0.110 hPa")));
  EXPECT_THAT(report.summary, Contains(HasSubstr("clock-skew |dt| < 0.13 s (0.021 hPa rms)")));
  EXPECT_THAT(report.info, Contains(testing::Pair("Not used", HasSubstr("200 "))));
  split_words(report);
}

TEST(DiagnosisReport, EachFindingHasAPageOfText) {
  const Report report = diagnosis_report(partial(), named_model());
  const auto& page = item<ReportText>(report, "Finding 1: static-beta-odd");
  for (const char* part :
       {"The correction b1 * sideslip_ratio * static_pressure (hPa) is added to delta-p.",
        "b1 = -0.00171 +- 0.00012, 0.95 times the usual size.", "rf02 at 2011-11-17 20:31:52 UTC",
        "chi2 decreases by 312.4 (threshold 14.3)", "about 2 separate events",
        "20:35:00 UTC (level, yaw manoeuvre), 55 %", "decreases from 0.196 to 0.152 hPa",
        "lams-azimuth (error of the azimuth of the laser beam; correlation +0.991, chi2 1.4 lower, 3.2 times "
        "the usual size).",
        "Fly 2 more yaw manoeuvres of 1.5 min each as on rf01: probability 93 %",
        "Source: Cooper (2012) eq. 19."})
    EXPECT_THAT(page.paragraphs, Contains(HasSubstr(part)));
  EXPECT_THAT(item<ReportText>(report, "Finding 2: static-lag").paragraphs,
              Contains(HasSubstr("No other effect that was tested")));
}

TEST(DiagnosisReport, NamesIndistinguishableEffects) {
  Diagnosis diagnosis = partial();
  diagnosis.verdict = Verdict::ambiguous;
  EXPECT_EQ(
      diagnosis_report(diagnosis, named_model()).title,
      "Effects are missing: static-beta-odd and static-lag; these flights cannot distinguish all possible "
      "causes");
  diagnosis.findings[1].rival = "the atmosphere";
  EXPECT_THAT(verdict_text(diagnosis), HasSubstr(", or the atmosphere is the cause of static-lag; "));
  diagnosis.findings[0].rival = "the atmosphere";
  EXPECT_THAT(verdict_text(diagnosis), HasSubstr(", or the atmosphere is the cause; "));
  diagnosis.findings[0].rival.clear();
  diagnosis.findings.resize(1);
  EXPECT_EQ(diagnosis_report(diagnosis, named_model()).title,
            "An effect is missing, static-beta-odd or lams-azimuth: these flights cannot distinguish them");
  diagnosis.findings.front().aliases.resize(4);
  EXPECT_EQ(
      diagnosis_report(diagnosis, named_model()).title,
      "An effect is missing, static-beta-odd or one of 4 others: these flights cannot distinguish them");
  diagnosis.verdict = Verdict::identified;
  EXPECT_EQ(diagnosis_report(diagnosis, named_model()).title,
            "An effect is missing: static-port error with sideslip, ports not perfectly paired");
}

TEST(DiagnosisReport, FirstPictureShowsFindingAgainstItsInputs) {
  const Report report = diagnosis_report(partial(), named_model());
  const auto& sideslip =
      item<BinnedPanel>(report, "Residual before and after, against the inputs of static-beta-odd");
  EXPECT_EQ(std::get_if<BinnedPanel>(&report.items.front()), &sideslip);  // the first picture
  EXPECT_THAT(sideslip.columns, ElementsAre("before", "after"));
  EXPECT_EQ(sideslip.x_choices.front(), "sideslip");
  EXPECT_THAT(sideslip.x_choices, Not(Contains("attack")));  // it has no value
  EXPECT_GT(sideslip.autocorrelation_time, 2.0);
  const auto& lag = item<BinnedPanel>(report, "Residual before and after, against the inputs of static-lag");
  EXPECT_EQ(lag.x_choices.front(), "vertical_speed");
  const auto& map = item<PlanePanel>(report, "Evidence for static-beta-odd, over Mach number and pressure");
  EXPECT_EQ(map.y, "static_pressure");
}

TEST(DiagnosisReport, RanksFindingsAndRivals) {
  const Report report = diagnosis_report(partial(), named_model());
  const auto& bars = item<BarPanel>(report, "Ranking");
  ASSERT_EQ(bars.bars.size(), 4U);
  EXPECT_EQ(bars.bars[1].label, "or lams-azimuth");
  EXPECT_NEAR(bars.bars[1].value, 311.0, 1e-9);
  EXPECT_EQ(bars.bars[3].value, 14.3);
  const auto& table = item<ReportTable>(report, "Findings and their rivals");
  EXPECT_THAT(table.rows[0], ElementsAre("1", "static-beta-odd", "b1 = -0.00171 +- 0.00012", "0.083", "312.4",
                                         "", "0.95", HasSubstr("sideslip")));
  EXPECT_THAT(table.rows[1], ElementsAre("or", "lams-azimuth", "azimuth = 0.320 +- 0.030 deg", "", "311.0",
                                         "+0.991", "3.2", HasSubstr("laser")));
}

TEST(DiagnosisReport, ShowsOnlySamplesThatWereUsed) {
  const Report report = diagnosis_report(partial(), named_model());
  EXPECT_EQ(report.time.size(), 7000U);
  EXPECT_THAT(report.flight_starts, ElementsAre(0U, 3500U));
  EXPECT_THAT(report.flight_names, ElementsAre("rf01", "rf02"));
  EXPECT_EQ(report.time.front(), start + 100.0);
  EXPECT_EQ(report.intervals.size(), 8U);
}

TEST(DiagnosisReport, ReportsStructureWithoutExplanation) {
  const Report report = diagnosis_report(unexplained(), named_model());
  EXPECT_EQ(report.title, "The residual has structure that is not explained by any effect");
  EXPECT_THAT(report.summary, Contains(HasSubstr("0.047 hPa rms, largest in the regime level")));
  EXPECT_THAT(report.summary, Contains(HasSubstr("engine torque (ENGTRQ): a curve explains 31 %")));
  const auto& variables = item<ReportTable>(report, "Variables that the unexplained structure varies with");
  EXPECT_THAT(variables.headers, ElementsAre("variable", "R2, curve", "R2, line", "slope of the line",
                                             "hPa per", "p", "formula", "similar to", "what"));
  EXPECT_THAT(variables.caption, HasSubstr("p tests the curve"));
  const auto& binned = item<BinnedPanel>(report, "Remaining residual against ENGTRQ");
  EXPECT_EQ(binned.x_choices.front(), "variable ENGTRQ");
  split_words(report);
}

TEST(DiagnosisReport, VariableWithoutALineHasNoSlope) {
  Diagnosis diagnosis = unexplained();
  diagnosis.unexplained.variables.front().slope_error = 0.0;
  const Report report = diagnosis_report(diagnosis, named_model());
  const auto& table = item<ReportTable>(report, "Variables that the unexplained structure varies with");
  EXPECT_EQ(table.rows[0][2], "");
  EXPECT_EQ(table.rows[0][3], "no line");
}

TEST(DiagnosisReport, NamesTheCoefficientsThatAreFittedAgain) {
  Diagnosis diagnosis = unexplained();
  const auto summary = [&] { return diagnosis_report(diagnosis, named_model()).summary; };
  EXPECT_THAT(summary(), Contains(HasSubstr("0.196 hPa with the model's own coefficients fitted again")));
  diagnosis.refitted_coefficients = {{"static-constant.a0", "1", 0.0, 0.1},
                                     {"reference:static-constant.a0", "1", 0.0, 0.1}};
  EXPECT_THAT(summary(),
              Contains(HasSubstr(
                  "0.196 hPa with the coefficients of the model and of the reference system fitted again")));
  const Report report = diagnosis_report(diagnosis, named_model());
  const auto& regimes = item<RegimeTable>(report, "By regime");
  EXPECT_THAT(regimes.caption, HasSubstr("the reference system fitted again"));
}

// A reference need not be a static pressure: wind, height, total pressure.
TEST(DiagnosisReport, ResidualIsNotCalledAStaticPressure) {
  const Report report = diagnosis_report(partial(), named_model());
  EXPECT_THAT(item<TimePanel>(report, "Residual in time").caption,
              AllOf(HasSubstr("reference minus model"), Not(HasSubstr("tatic pressure"))));
}

TEST(DiagnosisReport, WhatIfHasTheNoiseOfTheReport) {
  Diagnosis diagnosis = partial();
  diagnosis.noise_rms_with_findings = 0.06;
  WhatIf what_if;
  what_if.panel.effects = {{"static-beta-odd", "", "found"}};
  const auto panel_of = [&]() -> WhatIfPanel {
    return item<WhatIfPanel>(diagnosis_report(diagnosis, named_model(), &what_if), "What if");
  };
  EXPECT_EQ(panel_of().noise, 0.06);
  EXPECT_EQ(panel_of().noise_label, "noise with all findings");
  EXPECT_TRUE(
      std::holds_alternative<BinnedPanel>(diagnosis_report(diagnosis, named_model(), &what_if).items.front()))
      << "the residual against the inputs of the first finding";
  diagnosis.findings.clear();
  diagnosis.verdict = Verdict::none_detected;
  EXPECT_EQ(panel_of().noise, 0.081);
  EXPECT_EQ(panel_of().noise_label, "noise");
}

TEST(DiagnosisReport, SilentDiagnosisListsUpperLimits) {
  const Report report = diagnosis_report(none_detected(), named_model());
  EXPECT_EQ(report.title, "No missing effect is detectable on these flights");
  EXPECT_THAT(report.summary, Contains(HasSubstr("41")));
  EXPECT_THAT(report.summary, Contains(HasSubstr("clock-skew |dt| < 0.13 s (0.021 hPa rms)")));
  item<BinnedPanel>(report, "Residual against a variable");
  const auto& limits = item<ReportTable>(report, "Upper limits of effects that were not found");
  EXPECT_EQ(limits.rows[1][3], "");
  split_words(report);
}

TEST(DiagnosisReport, FlightsThatDetectNoUsualSizeCannotTestTheModel) {
  Diagnosis none_detected;
  none_detected.threshold = 14.3;
  none_detected.limits.resize(4);  // the last one has no usual size
  const auto set = [&none_detected](double first, double second, double third) {
    none_detected.limits[0].chi2_at_usual_size = first;
    none_detected.limits[1].chi2_at_usual_size = second;
    none_detected.limits[2].chi2_at_usual_size = third;
  };
  set(14.4, 500.0, 2.0);
  EXPECT_EQ(detectable_at_usual_size(none_detected), (std::pair<std::size_t, std::size_t>(2, 3)));
  const std::string most = verdict_text(none_detected);
  set(14.2, 14.4, 2.0);
  EXPECT_EQ(detectable_at_usual_size(none_detected), (std::pair<std::size_t, std::size_t>(1, 3)));
  const std::string few = verdict_text(none_detected);
  EXPECT_THAT(few, HasSubstr("1 of 3"));
  set(14.2, 0.0, 2.0);
  EXPECT_EQ(detectable_at_usual_size(none_detected), (std::pair<std::size_t, std::size_t>(0, 3)));
  const std::string none = verdict_text(none_detected);
  EXPECT_NE(most, few);
  EXPECT_EQ(none.find(most), std::string::npos);
}

TEST(DiagnosisReport, AcceptsEmptyFields) {
  Diagnosis diagnosis;
  split_words(diagnosis_report(diagnosis, {}));
  diagnosis.findings.resize(1);
  diagnosis.verdict = Verdict::ambiguous;
  diagnosis.unexplained.significant = true;
  diagnosis.unexplained.variables.resize(1);
  diagnosis.limits.resize(1);
  diagnosis.flights.resize(1);
  split_words(diagnosis_report(diagnosis, {}));
}

TEST(DiagnosisReport, NonFiniteValuesAreOmitted) {
  Diagnosis diagnosis = partial();
  Finding& finding = diagnosis.findings.front();
  finding.estimates = {{"b1", "1", nan, nan, 0.0}, {"b2", "hPa", 1.0, nan, nan}};
  finding.worst = finding.p_value = finding.rms_before = finding.rms_after = finding.events = nan;
  finding.aliases.front().relative_size = infinity;
  diagnosis.noise_rms = diagnosis.residual_rms = diagnosis.residual_rms_held_out = nan;
  for (FlightDiagnosis& one : diagnosis.flights) {
    for (std::vector<double>* values :
         {&one.mach, &one.sideslip, &one.evidence[0], &one.predictor, &one.drift})
      values->assign(values->size(), nan);
    one.added.clear();
  }
  const std::string words = split_words(diagnosis_report(diagnosis, named_model()));
  EXPECT_THAT(words, HasSubstr("b1 unknown and b2 = 1 hPa"));
}

TEST(DiagnosisReport, NamesAreEscaped) {
  Diagnosis diagnosis = partial();
  const auto samples = renamed(*diagnosis.flights.front().samples, "<i>rf&01</i>");
  diagnosis.flights.front().samples = samples;
  diagnosis.findings.front().worst_flight = diagnosis.findings.front().evidence.front().flight =
      samples->name;
  diagnosis.findings.front().advice.sentence = "<b>fly</b>";
  const std::string words = split_words(diagnosis_report(diagnosis, named_model()));
  EXPECT_THAT(words, Not(AnyOf(HasSubstr("<i>"), HasSubstr("<b>"))));
  EXPECT_THAT(words, HasSubstr("&lt;i&gt;rf&amp;01&lt;/i&gt;"));
}

TEST(ImprovementReport, ShowsTheSteps) {
  const Report report = improvement_report(improvement(), named_model());
  EXPECT_EQ(report.title, "2 effects make the model better");
  EXPECT_EQ(report.subtitle, "Improvement of C-130 PSFD 2011 against LAMS");
  EXPECT_THAT(report.summary, Contains(HasSubstr("held-out rms residual becomes 0.161 hPa (fitted: 0.196")));
  EXPECT_THAT(report.summary, Contains(AllOf(HasSubstr("0.203 to 0.120 hPa"), HasSubstr("0.081 hPa"))));
  EXPECT_THAT(report.summary, Contains("No further effect exceeds the threshold."));
  const auto& steps = item<DotPanel>(report, "Rms of each step");
  ASSERT_EQ(steps.rows.size(), 3U);
  EXPECT_EQ(steps.rows[1].label, "+ static-beta-odd");
  EXPECT_EQ(steps.rows[1].dots[0].value, 0.196);
  EXPECT_EQ(steps.rows[1].dots[1].value, 0.161);
  EXPECT_THAT(steps.lines, ElementsAre(testing::Pair("noise, 0.081 hPa", 0.081)));
  const auto& table = item<ReportTable>(report, "Steps of the selection");
  EXPECT_THAT(table.rows[1],
              ElementsAre("+ static-beta-odd", "4", "0.196", "0.161", "0.081", "0.083", "lams-azimuth",
                          "Sideslip counts, be it at the ports or at the laser."));
  split_words(report);
}

TEST(ImprovementReport, StartsWithInputModelAndShowsHeldOutFlights) {
  Improvement made = improvement();
  made.given_rms_holdout = 0.5;
  made.rms_holdout = 0.13;
  ImproveStep& step = made.steps[1];
  step.rivals = {{"static-beta-odd", 0.8, 0.3}, {"lams-azimuth", 0.2, 0.0}};
  step.delivered = "";
  step.rival_error = 0.12;
  for (const FlightDiagnosis& one : made.steps[0].diagnosis.flights)
    made.flights.push_back(improved(one, one.before.size()));
  FlightDiagnosis later = made.steps[0].diagnosis.flights.front();
  later.samples = renamed(*later.samples, "later.nc");
  made.flights.push_back(improved(later, 0));
  const Report report = improvement_report(made, named_model());
  const auto& steps = item<DotPanel>(report, "Rms of each step");
  EXPECT_EQ(steps.series.back(), "held out: later.nc");
  EXPECT_EQ(steps.rows.front().label, "input model");
  EXPECT_EQ(steps.rows.front().dots[1].value, 0.5);
  EXPECT_GT(steps.rows.front().dots[1].error, 0.0);
  EXPECT_EQ(steps.rows[4].label, "written model");
  EXPECT_THAT(report.summary, Contains(HasSubstr("probability 0.80, changes it by 0.300 hPa")));
  EXPECT_THAT(report.flight_names, Contains("later.nc, held out"));
  const auto& time = item<TimePanel>(report, "Residuals of the models in time");
  EXPECT_THAT(time.caption, HasSubstr("later.nc"));
  EXPECT_EQ(time.averaging_time, 60.0);
  EXPECT_THAT(time.columns, ElementsAre("model-given", "model-refitted", "model-best"));
  split_words(report);
}

// The diagnoses do not have a flight of which no sample is used.
TEST(ImprovementReport, UnusedFlightDoesNotShiftTheOthers) {
  Improvement made = improvement();
  FlightDiagnosis unused = made.steps[0].diagnosis.flights.front();
  unused.samples = renamed(*unused.samples, "rf00");
  made.flights.push_back(improved(unused, 0));
  made.flights.back().held_out = 0;
  for (const FlightDiagnosis& one : made.steps[0].diagnosis.flights)
    made.flights.push_back(improved(one, one.before.size()));
  made.flights[1].best.assign(made.flights[1].best.size(), 1.0);
  made.flights[2].best.assign(made.flights[2].best.size(), 2.0);
  const Report report = improvement_report(made, named_model());
  EXPECT_THAT(report.flight_names, ElementsAre("rf01", "rf02"));
  const auto best = std::find_if(report.columns.begin(), report.columns.end(),
                                 [](const ReportColumn& column) { return column.name == "model-best"; });
  ASSERT_NE(best, report.columns.end());
  EXPECT_EQ(best->values.front(), 1.0);
  EXPECT_EQ(best->values.back(), 2.0);
}

TEST(ImprovementReport, StatesWhatIsNotInTheFit) {
  Improvement made = improvement();
  made.holdout_is_flights = false;
  const Report report = improvement_report(made, named_model());
  const auto& steps = item<DotPanel>(report, "Rms of each step");
  EXPECT_EQ(steps.series.back(), "held out, five-fold");
  const auto& table = item<ReportTable>(report, "Steps of the selection");
  for (const std::string& caption : {steps.caption, table.caption})
    EXPECT_THAT(caption, HasSubstr("five-fold cross-validation"));
}

TEST(ImprovementReport, HeldOutPartDiffersFromHeldOutFlight) {
  Improvement made = improvement();
  for (const FlightDiagnosis& one : made.steps[0].diagnosis.flights)
    made.flights.push_back(improved(one, one.before.size() / 2));
  const std::string name = made.flights.front().samples->name;
  const Report report = improvement_report(made, named_model());
  EXPECT_THAT(report.flight_names, Not(Contains(HasSubstr("held out"))));
  const auto& steps = item<DotPanel>(report, "Rms of each step");
  EXPECT_THAT(steps.series.back(), HasSubstr("the last part of " + name));
  EXPECT_GT(steps.rows[0].dots[0].error, 0.0);
}

TEST(DiagnosisReport, SlopeIsNullWithoutALine) {
  EmpiricalPredictor variable;
  EXPECT_THAT(to_json(variable), AllOf(HasSubstr("\"slope\": null"), HasSubstr("\"slope_stderr\": null")));
  variable.slope = -0.5;
  variable.slope_error = 0.25;
  EXPECT_THAT(to_json(variable), AllOf(HasSubstr("\"slope\": -0.5"), HasSubstr("\"slope_stderr\": 0.25")));
}

TEST(ImprovementReport, EachStepHasAPageAndPictures) {
  const Report report = improvement_report(improvement(), named_model());
  const auto& page = item<ReportText>(report, "Step 1: static-beta-odd");
  EXPECT_THAT(page.paragraphs, Contains(HasSubstr("The flights give b1 = -0.00171 +- 0.00012")));
  EXPECT_EQ(page.paragraphs.back(), "In the best model b1 = -0.00169 +- 0.00011.");
  const auto& binned =
      item<BinnedPanel>(report, "Residual without and with static-beta-odd, against its inputs");
  EXPECT_THAT(binned.columns, ElementsAre("step1", "step2"));
  EXPECT_EQ(binned.x_choices.front(), "sideslip");
  item<PlanePanel>(report, "Evidence for static-beta-odd, over Mach number and pressure");
  const auto& formula =
      item<BinnedPanel>(report, "Residual without and with ENGTRQ-trace, against its inputs");
  EXPECT_EQ(formula.x_choices.front(), "variable ENGTRQ");
}

TEST(ImprovementReport, ImprovementWithoutAnAddedEffectIsReported) {
  Improvement made = improvement();
  made.steps.resize(1);
  const Report report = improvement_report(made, named_model());
  EXPECT_EQ(report.title, "No effect makes the model better");
  split_words(report);
  made.steps[0] = {};
  split_words(improvement_report(made, {}));
  made.steps.clear();
  EXPECT_THROW(improvement_report(made, {}), Error);
}

}  // namespace
}  // namespace pcor

#include <pcor/diagnose/diagnosis_report.hpp>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cstddef>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include <pcor/base/format_estimate.hpp>
#include <pcor/base/utc.hpp>

#include "diagnose/diagnosis_panels.hpp"
#include "diagnose/finding_page.hpp"

namespace pcor {

using namespace internal;

namespace {

using namespace internal::report;

constexpr std::size_t limits_in_summary = 3;
constexpr std::size_t rivals_in_title = 2;

std::string either(const Finding& finding, const std::string& rival) {
  std::string names = finding.id();
  if (finding.aliases.size() > rivals_in_title) {
    names += fmt::format(" or one of {} others", finding.aliases.size());
  } else {
    for (const Alias& alias : finding.aliases) names += " or " + alias.effect;
  }
  for (const std::string& cause : {finding.rival, rival}) {
    if (!cause.empty()) names += fmt::format(", or {} is the cause", cause);
  }
  return fmt::format("An effect is missing, {}: these flights cannot distinguish them", names);
}

/// Causes outside the catalogue that may replace findings: ", or the atmosphere is the cause of pitot-angle".
std::string other_causes(const Diagnosis& diagnosis) {
  std::map<std::string, std::vector<std::string>> replaced;
  for (const Finding& finding : diagnosis.findings) {
    for (const std::string& cause : {finding.rival, diagnosis.rival}) {
      if (!cause.empty()) replaced[cause].push_back(finding.id());
    }
  }
  std::string text;
  for (const auto& [cause, ids] : replaced) {
    const bool are_all = ids.size() == diagnosis.findings.size();
    text += fmt::format(", or {} is the cause{}", cause, are_all ? "" : " of " + join_list(ids));
  }
  return text;
}

void summarise(Report& report, const Diagnosis& diagnosis) {
  for (const Finding& finding : diagnosis.findings) report.summary.push_back(finding_summary(finding));
  const std::string refit =
      diagnosis.is_refitted
          ? fmt::format(", and {} hPa with {}", hpa(diagnosis.residual_rms), refitted_text(diagnosis))
          : "";
  report.summary.push_back(
      fmt::format("The residual is {} hPa rms{}, as in the pictures; the noise is {} hPa.",
                  hpa(diagnosis.rms_given), refit, hpa(diagnosis.noise_rms)));
  if (const std::string text = flaps_out_text(diagnosis.flaps_out, "the diagnosis"); !text.empty())
    report.summary.push_back(sentence(text));
  if (diagnosis.findings.empty()) {
    report.summary.push_back(
        fmt::format("{} effects were tested; no effect was detected.", diagnosis.candidates));
  }
  for (std::string& text : unexplained_text(diagnosis.unexplained)) report.summary.push_back(std::move(text));
  std::vector<std::string> limits;
  for (const UpperLimit& limit : diagnosis.limits) {
    if (limits.size() == limits_in_summary) break;
    if (std::string bound = limits_text(limit); !bound.empty())
      limits.push_back(fmt::format("{} {} ({} hPa rms)", limit.effect, bound, hpa(limit.rms)));
  }
  if (!limits.empty()) {
    report.summary.push_back(
        fmt::format("Not found, and with 95 % confidence not above: {}.", join_list(limits)));
  }
  if (!diagnosis.absorbed.empty()) {
    std::vector<std::string> ids;
    for (const AbsorbedEffect& effect : diagnosis.absorbed) ids.push_back(effect.effect);
    report.summary.push_back(
        "Not detectable, because the model's own coefficients imitate them: " + join_list(ids) + ".");
  }
}

Info numbers_of(const Diagnosis& diagnosis) {
  Info numbers{{"Verdict", std::string(to_string(diagnosis.verdict))},
               {"Noise", hpa(diagnosis.noise_rms) + " hPa rms"},
               {"Residual, coefficients as given", hpa(diagnosis.rms_given) + " hPa rms"}};
  if (diagnosis.is_refitted)
    numbers.emplace_back("Residual, " + refitted_text(diagnosis), hpa(diagnosis.residual_rms) + " hPa rms");
  if (std::isfinite(diagnosis.residual_rms_held_out))
    numbers.emplace_back("Residual on five-minute parts that each of five fits excludes, without outliers",
                         hpa(diagnosis.residual_rms_held_out) + " hPa rms");
  if (!diagnosis.findings.empty())
    numbers.emplace_back("Noise with all findings", hpa(diagnosis.noise_rms_with_findings) + " hPa rms");
  numbers.emplace_back("Effects tested", std::to_string(diagnosis.candidates));
  numbers.emplace_back("Threshold", fmt::format("chi2 {:.1f}", diagnosis.threshold));
  return numbers;
}

BarPanel ranking_bars(const Diagnosis& diagnosis) {
  BarPanel bars{"Ranking",
                "Decrease of chi2 by each effect that was found, and by each rival (\"or\") instead of it.",
                {},
                "decrease of chi2"};
  for (const Finding& finding : diagnosis.findings) {
    bars.bars.push_back({finding.id(), finding.chi2});
    for (const Alias& alias : finding.aliases)
      bars.bars.push_back({"or " + alias.effect, finding.chi2 - alias.chi2_difference});
  }
  bars.bars.push_back({"threshold", diagnosis.threshold});
  return bars;
}

/// Ratio to the usual size; empty if that is not known.
std::string ratio_cell(double ratio) { return ratio == 0.0 ? "" : ratio_text(ratio); }

ReportTable ranking_table(const Diagnosis& diagnosis) {
  ReportTable table{
      "Findings and their rivals",
      "A rival (\"or\") explains the flights as well as the effect above it. Correlation: between the two "
      "effects after the model's own coefficients. Size / usual: ratio of the coefficient to its usual size.",
      {"", "effect", "coefficients", "rms, hPa", "decrease of chi2", "correlation", "size / usual", "what"}};
  for (std::size_t i = 0; i < diagnosis.findings.size(); ++i) {
    const Finding& finding = diagnosis.findings[i];
    table.rows.push_back({std::to_string(i + 1), finding.id(), estimates_text(finding.estimates),
                          finding.size_text(""), cell(finding.chi2, 1), "",
                          ratio_cell(relative_size_of(finding.estimates)), finding.title});
    for (const Alias& alias : finding.aliases) {
      table.rows.push_back({"or", alias.effect, estimates_text(alias.estimates), "",
                            cell(finding.chi2 - alias.chi2_difference, 1),
                            fmt::format("{:+.3f}", alias.correlation), ratio_cell(alias.relative_size),
                            alias.title});
    }
  }
  return table;
}

ReportTable evidence_table(const std::vector<Finding>& findings) {
  ReportTable table{"Where the evidence lies",
                    "Time ranges with most of the evidence for each effect.",
                    {"effect", "flight", "begin (UTC)", "end", "share", "regimes"}};
  for (const Finding& finding : findings) {
    for (const Evidence& evidence : finding.evidence) {
      table.rows.push_back({finding.id(), evidence.flight, utc_text(evidence.begin),
                            utc_text(evidence.end, "%H:%M:%S"), percent(evidence.share), evidence.regimes});
    }
  }
  return table;
}

/// Residual before and after against the inputs of a finding.
void add_against_inputs(DiagnosisPanels& panels, const Diagnosis& diagnosis,
                        const std::vector<std::string>& residuals, std::size_t number) {
  const Finding& finding = diagnosis.findings[number];
  std::vector<std::string> inputs = inputs_of(finding.effect);
  inputs.push_back(numbered("added", number));
  panels.add_binned("Residual before and after, against the inputs of " + finding.id(), residuals, inputs);
}

/// Pictures of the findings of a diagnosis, and one page per finding.
void add_findings(DiagnosisPanels& panels, const Diagnosis& diagnosis,
                  const std::vector<std::string>& residuals) {
  const std::vector<Finding>& findings = diagnosis.findings;
  TimePanel added{"Contributions of the missing effects",
                  "Contribution to the residual with the estimated coefficients.",
                  {},
                  "added"};
  TimePanel evidence{
      "Evidence in time", "Decrease of chi2 per minute around each sample.", {}, "decrease of chi2"};
  for (std::size_t i = 0; i < findings.size(); ++i) {
    added.columns.push_back(numbered("added", i));
    evidence.columns.push_back(numbered("evidence", i));
  }
  add_if_present(panels.report(), std::move(added));
  add_if_present(panels.report(), std::move(evidence));
  panels.add(ranking_bars(diagnosis));
  panels.add_plane("Remaining residual over Mach number and pressure",
                   "Residual with all findings: one colour over a region is a bias there.", residuals.back());
  panels.add(ranking_table(diagnosis));
  panels.add_table(evidence_table(findings));
  for (std::size_t i = 0; i < findings.size(); ++i) {
    const std::string id = findings[i].id();
    panels.add(
        finding_page(findings[i], diagnosis.threshold,
                     findings.size() == 1 ? "The finding: " + id : fmt::format("Finding {}: {}", i + 1, id)));
    if (i > 0) add_against_inputs(panels, diagnosis, residuals, i);  // finding 0 has the first picture
    panels.add_plane("Evidence for " + id + ", over Mach number and pressure",
                     "Orange supports the effect, blue contradicts it.", numbered("evidence", i));
  }
}

}  // namespace

std::string verdict_text(const Diagnosis& diagnosis) {
  std::vector<std::string> ids;
  for (const Finding& finding : diagnosis.findings) ids.push_back(finding.id());
  const std::string effects = ids.size() == 1 ? "An effect is missing: " + diagnosis.findings.front().title
                                              : "Effects are missing: " + join_list(ids);
  switch (diagnosis.verdict) {
    case Verdict::identified:
      return effects;
    case Verdict::ambiguous:
      return ids.size() == 1 ? either(diagnosis.findings.front(), diagnosis.rival)
                             : fmt::format("{}{}; these flights cannot distinguish all possible causes",
                                           effects, other_causes(diagnosis));
    case Verdict::partial:
      return effects + "; the remaining structure is not explained by any effect";
    case Verdict::unexplained:
      return diagnosis.unexplained.significant
                 ? "The residual has structure that is not explained by any effect"
                 : "The held-out part has a bias that is not explained by any effect on the fitted flights";
    case Verdict::none_detected:
      break;
  }
  const auto [detectable, all] = detectable_at_usual_size(diagnosis);
  if (all > 0 && detectable == 0) {
    return fmt::format(
        "These flights cannot test the model: they would detect 0 of {} missing effects at their usual size",
        all);
  }
  const std::string none = "No missing effect is detectable on these flights";
  return 2 * detectable >= all
             ? none
             : fmt::format("{}; {} of {} would be detected at their usual size", none, detectable, all);
}

std::pair<std::size_t, std::size_t> detectable_at_usual_size(const Diagnosis& diagnosis) {
  std::pair<std::size_t, std::size_t> counts;
  for (const UpperLimit& limit : diagnosis.limits) {
    if (std::isnan(limit.chi2_at_usual_size)) continue;
    ++counts.second;
    if (limit.chi2_at_usual_size > diagnosis.threshold) ++counts.first;
  }
  return counts;
}

std::string estimates_text(const std::vector<CoefficientEstimate>& estimates) {
  std::vector<std::string> all;
  for (const CoefficientEstimate& e : estimates) {
    all.push_back(
        std::isfinite(e.value)
            ? fmt::format("{} = {}", e.name,
                          with_unit(format_estimate(e.value, e.standard_error, PlusSign::never), e.unit))
            : e.name + " unknown");
  }
  return join_list(all);
}

std::string limits_text(const UpperLimit& limit) {
  std::vector<std::string> all;
  for (std::size_t i = 0; i < std::min(limit.estimates.size(), limit.limits.size()); ++i) {
    const CoefficientEstimate& e = limit.estimates[i];
    if (std::isfinite(limit.limits[i]))
      all.push_back(
          fmt::format("|{}| < {}", e.name, with_unit(fmt::format("{:.2g}", limit.limits[i]), e.unit)));
  }
  return join_list(all);
}

Report diagnosis_report(const Diagnosis& diagnosis, const ModelDefinition& model, const WhatIf* what_if) {
  DiagnosisPanels panels(diagnosis.flights);
  Report& report = panels.report();
  report.title = verdict_text(diagnosis);
  report.subtitle = fmt::format("Diagnosis of {} against {}", model.model.name, diagnosis.reference);
  summarise(report, diagnosis);
  panels.add_info(diagnosis, model, numbers_of(diagnosis));

  const std::vector<Finding>& findings = diagnosis.findings;
  const bool found = !findings.empty();
  panels.add_predictor(diagnosis);
  std::vector<std::string> residuals{"before"};
  panels.add_column("before", found ? "residual before" : "residual", "hPa", diagnosis.flights,
                    &FlightDiagnosis::before);
  if (found && panels.add_column("after", "residual after, with all findings", "hPa", diagnosis.flights,
                                 &FlightDiagnosis::after))
    residuals.emplace_back("after");
  for (std::size_t i = 0; i < findings.size(); ++i)
    panels.add_finding_columns(diagnosis.flights, i, findings[i].id(), i);
  if (found)
    add_against_inputs(panels, diagnosis, residuals, 0);
  else
    panels.add_against_predictor(diagnosis, "before");
  if (what_if != nullptr) {
    panels.add_what_if(*what_if, "before",
                       found ? inputs_of(findings.front().effect) : std::vector<std::string>{},
                       found ? diagnosis.noise_rms_with_findings : diagnosis.noise_rms,
                       found ? "noise with all findings" : "noise");
  }
  panels.add_residuals(diagnosis, residuals);
  if (found) {
    add_findings(panels, diagnosis, residuals);
  } else {
    panels.add_binned("Residual against a variable", residuals, {});
    panels.add_plane("Residual over Mach number and pressure", "One colour over a region is a bias there.",
                     "before");
  }
  panels.add_last_panels(diagnosis, residuals);
  return std::move(report);
}

std::string kind_text(const Finding& finding) {
  std::string text = fmt::format("place: {}", fmt::join(finding.components, " or "));
  if (!finding.family.empty()) text = fmt::format("family: {}; {}", finding.family, text);
  if (!finding.shape.empty()) text += "; shape: " + finding.shape;
  if (is_unusually_large(finding))
    text += fmt::format(
        "; {} times its usual size, so look first for a wrong entry in the model, or for another cause",
        ratio_text(finding.relative_size));
  if (finding.of_reference) text += "; do not change the model for it";
  return text;
}

}  // namespace pcor

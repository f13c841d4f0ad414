#include "diagnose/finding_page.hpp"

#include <fmt/format.h>

#include <cmath>
#include <cstddef>
#include <string_view>

#include <pcor/base/format_estimate.hpp>
#include <pcor/base/utc.hpp>
#include <pcor/diagnose/diagnosis_report.hpp>
#include <pcor/effects/catalogue.hpp>

namespace pcor::internal::report {
namespace {

constexpr std::size_t max_in_a_sentence = 3;

/// Text of the page about an effect that needs no flight.
struct Law {
  EffectLocation location;
  std::string_view formula, unit, size, confounders, manoeuvre, source;
};

Law law_of(const ModelEffect& effect) {
  const EffectInfo* const info = effect.is_formula() ? nullptr : effect_named(effect.id);
  if (info == nullptr) return {effect.location, effect.formula, effect.unit, "", "", "", effect.source};
  return {info->location,  info->formula, info_of(info->location).unit, info->size, info->confounders,
          info->manoeuvre, info->source};
}

std::string relative_size_text(double ratio) { return ratio_text(ratio) + " times the usual size"; }

std::string what_it_is(const Finding& finding, const Law& law) {
  std::string text = "Missing effect: " + name_with_id(finding.title, finding.id()) + ".";
  if (law.formula.empty()) return text;
  return text + fmt::format(" The correction {}{} is added to {}.", law.formula,
                            law.unit.empty() || law.unit == "1" ? "" : fmt::format(" ({})", law.unit),
                            law.location == EffectLocation::static_defect
                                ? "delta-p"
                                : fmt::format("the {}", info_of(law.location).adds_to));
}

std::string how_large(const Finding& finding, const Law& law) {
  std::string text = fmt::format("The flights give {}", estimates_text(finding.estimates));
  if (const double ratio = relative_size_of(finding.estimates); ratio > 0.0)
    text += ", " + relative_size_text(ratio);
  text += ".";
  if (!law.size.empty()) text += fmt::format(" Sizes met in practice: {}.", law.size);
  text += fmt::format(" The model does not absorb {} of the effect", finding.size_text());
  if (!finding.worst_flight.empty() && std::isfinite(finding.worst)) {
    text += fmt::format("; alone the effect is at most {:+.3f} hPa, in {} at {} UTC", finding.worst,
                        finding.worst_flight, utc_text(finding.worst_time));
  }
  return text + ".";
}

std::string how_sure(const Finding& finding, double threshold) {
  std::string text = fmt::format(
      "Evidence: chi2 decreases by {:.1f} (threshold {:.1f}); probability that the best candidate reaches "
      "this on flights without any effect: {}.",
      finding.chi2, threshold, probability(finding.p_value));
  if (finding.events > 0.0) {
    text += finding.events < 1.5
                ? " The evidence is a single event."
                : fmt::format(" The evidence is about {:.0f} separate events.", finding.events);
  }
  std::vector<std::string> segments;
  for (const Evidence& evidence : finding.evidence) {
    if (segments.size() == max_in_a_sentence) break;
    segments.push_back(fmt::format("{}, {} to {} UTC{}, {}", evidence.flight, utc_text(evidence.begin),
                                   utc_text(evidence.end, "%H:%M:%S"),
                                   evidence.regimes.empty() ? "" : fmt::format(" ({})", evidence.regimes),
                                   percent(evidence.share)));
  }
  if (!segments.empty()) text += fmt::format(" Most of the evidence lies in {}.", fmt::join(segments, "; "));
  return text;
}

std::string rival(const Alias& alias) {
  std::string text =
      fmt::format("{} ({}{}correlation {:+.3f}, chi2 {:.1f} {}", alias.effect, alias.title,
                  alias.title.empty() ? "" : "; ", alias.correlation, std::abs(alias.chi2_difference),
                  alias.chi2_difference < 0.0 ? "higher" : "lower");
  if (alias.relative_size != 0.0 && std::isfinite(alias.relative_size))
    text += ", " + relative_size_text(alias.relative_size);
  return text + ")";
}

std::string rivals(const Finding& finding, const Law& law) {
  std::string text = "No other effect that was tested explains these flights as well.";
  if (!finding.aliases.empty()) {
    std::vector<std::string> all;
    for (const Alias& alias : finding.aliases) {
      if (all.size() < max_in_a_sentence) all.push_back(rival(alias));
    }
    text = fmt::format("These flights cannot distinguish the effect from {}", fmt::join(all, "; "));
    if (const std::size_t more = finding.aliases.size() - all.size(); more > 0)
      text += fmt::format("; and {} more, which the ranking lists", more);
    text += ".";
  }
  if (!finding.advice.sentence.empty()) {
    text += " " + sentence(finding.advice.sentence);
  } else if (!law.confounders.empty()) {
    text += fmt::format(" In general the effect resembles {}", law.confounders);
    text += law.manoeuvre.empty() ? "." : fmt::format("; to separate them: {}.", law.manoeuvre);
  }
  return text;
}

}  // namespace

std::string with_unit(const std::string& number, const std::string& unit) {
  return unit.empty() || unit == "1" ? number : number + " " + unit;
}

std::string hpa(double value) { return std::isfinite(value) ? fmt::format("{:.3f}", value) : "unknown"; }

std::string probability(double p) {
  constexpr double minimum = 1e-6;
  if (!std::isfinite(p)) return "unknown size";
  return p < minimum ? "less than one in a million" : fmt::format("{:.2g}", p);
}

std::string percent(double share) {
  if (!std::isfinite(share)) return "unknown";
  if (share > 0.0 && share < 5e-4) return "below 0.1 %";
  return fmt::format("{:.{}f} %", 100.0 * share, std::abs(share) < 0.0995 ? 1 : 0);
}

double relative_size_of(const std::vector<CoefficientEstimate>& estimates) {
  for (const CoefficientEstimate& e : estimates) {
    const double ratio = std::abs(e.value / e.typical);
    if (std::isfinite(ratio)) return ratio;
  }
  return 0.0;
}

std::string ratio_text(double ratio) {
  const double size = std::abs(ratio);
  if (!std::isfinite(size)) return "";
  if (size < 0.095) return fmt::format("{:.1g}", size);
  return fmt::format("{:.{}f}", size, size < 0.995 ? 2 : size < 9.95 ? 1 : 0);
}

std::string name_with_id(const std::string& title, const std::string& id) {
  if (title.empty() || title == id) return id;
  return id.empty() ? title : fmt::format("{} ({})", title, id);
}

std::string finding_summary(const Finding& finding) {
  std::string text = fmt::format("Missing: {}, {} that the model does not absorb.",
                                 name_with_id(finding.title, finding.id()), finding.size_text());
  if (finding.aliases.empty()) return text;
  std::vector<std::string> all;
  for (const Alias& alias : finding.aliases) {
    if (all.size() < max_in_a_sentence)
      all.push_back(fmt::format("{} ({})", alias.effect, percent(alias.probability)));
  }
  if (const std::size_t more = finding.aliases.size() - all.size(); more > 0)
    all.push_back(fmt::format("{} more", more));
  text += fmt::format(" These flights cannot distinguish the effect (probability {}) from {}.",
                      percent(finding.probability), join_list(all));
  return finding.advice.manoeuvre.empty() ? text : text + " " + sentence(finding.advice.sentence);
}

std::vector<std::string> unexplained_text(const Unexplained& unexplained) {
  if (!unexplained.significant) return {};
  std::string what = fmt::format("Unexplained residual: {} hPa rms", hpa(unexplained.rms));
  if (!unexplained.regime.empty()) what += fmt::format(", largest in the regime {}", unexplained.regime);
  what += fmt::format(". Probability by chance: {}.", probability(unexplained.p_value));
  if (unexplained.drift_rms > 0.0) {
    what += fmt::format(" The slow part is {} hPa.", hpa(unexplained.drift_rms));
  }
  std::vector<std::string> all{what};
  if (unexplained.variables.empty()) {
    all.emplace_back("The residual is not correlated with any tested variable of the files.");
  } else {
    const EmpiricalPredictor& first = unexplained.variables.front();
    std::string with = fmt::format("The residual varies with {}: a curve explains {} of its variance",
                                   name_with_id(first.description, first.name), percent(first.r2));
    if (first.slope_error > 0.0) {
      with +=
          fmt::format(", a straight line ({}) {}",
                      with_unit(format_estimate(first.slope, first.slope_error, PlusSign::never),
                                first.unit.empty() || first.unit == "1" ? "hPa" : "hPa per " + first.unit),
                      percent(first.linear_r2));
    }
    with += ".";
    if (!first.sampling.empty()) with += fmt::format(" Values used: {}.", first.sampling);
    if (!first.formula.empty()) with += fmt::format(" The formula {} would describe it.", first.formula);
    all.push_back(with + " " + sentence(component_text(first)));
  }
  for (const FlightOffset& step : unexplained.steps) {
    all.push_back(
        fmt::format("The mean of {} lies {} hPa {} the mean of the other flights (p = {}). Check the "
                    "maintenance log between these flights.",
                    step.flight, format_estimate(std::abs(step.size), step.standard_error, PlusSign::never),
                    step.size < 0.0 ? "below" : "above", probability(step.p_value)));
  }
  return all;
}

ReportText finding_page(const Finding& finding, double threshold, const std::string& heading) {
  const Law law = law_of(finding.effect);
  ReportText page{heading, {what_it_is(finding, law), how_large(finding, law), how_sure(finding, threshold)}};
  if (std::isfinite(finding.rms_before) && std::isfinite(finding.rms_after)) {
    page.paragraphs.push_back(
        fmt::format("On held-out parts the rms of the residual {} from {} to {} hPa.",
                    finding.rms_after < finding.rms_before ? "decreases" : "does not decrease: it changes",
                    hpa(finding.rms_before), hpa(finding.rms_after)));
  }
  page.paragraphs.push_back(rivals(finding, law));
  if (!law.source.empty()) page.paragraphs.push_back(fmt::format("Source: {}.", law.source));
  return page;
}

}  // namespace pcor::internal::report

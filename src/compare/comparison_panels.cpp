#include "compare/comparison_panels.hpp"

#include <pcor/compare/comparison_report.hpp>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include <pcor/base/utc.hpp>
#include "base/phrasing.hpp"
#include "report/residual_pictures.hpp"
#include "report/shown_flights.hpp"
#include "residuals/masks.hpp"

namespace pcor::internal {
namespace {

// Minimum number of samples of a regime that is named as the worst one; one per cent of all, if that is more.
constexpr std::size_t min_in_regime = 60;
// Ratio to the noise; smaller ratios are not reported.
constexpr double notable_failure = 1.2;

std::string residual_column(std::size_t model) { return fmt::format("residual{}", model + 1); }

}  // namespace

std::string ComparisonPanels::label_of_model(const ModelComparison& model) const {
  const auto found = std::find_if(comparison_.models.begin(), comparison_.models.end(),
                                  [&model](const ModelComparison& each) { return each.name == model.name; });
  return labels_[static_cast<std::size_t>(found - comparison_.models.begin())];
}

std::string ComparisonPanels::title_of(const std::string& what, const ModelComparison& model) const {
  return comparison_.models.size() == 1 ? what : what + ", " + label_of_model(model);
}

template <class Series>
void ComparisonPanels::add(const std::string& name, const std::string& title, const Series& series) {
  report().columns.push_back({name, title, "hPa", samples_.joined(comparison_.flights, series)});
}

ComparisonPanels::ComparisonPanels(const Comparison& comparison) : comparison_(comparison) {
  // A report shows no samples but the used ones.
  for (const FlightResiduals& flight : comparison.flights)
    samples_.add_flight(flight.samples, used_samples(flight.mask));
  using F = FlightResiduals;
  using V = std::vector<double>;
  for (std::size_t m = 0; m < comparison.models.size(); ++m) {
    add(residual_column(m), title_of("residual", comparison.models[m]),
        [m](const F& f) -> const V& { return f.values[m]; });
    residuals_.push_back(residual_column(m));
  }
  const auto variable = [&](const std::string& name, const std::string& title, const char* unit,
                            const auto& series) {
    const bool is_added = samples_.add_column(name, title, unit, comparison.flights, series);
    if (is_added) variables_.push_back(name);
    return is_added;
  };
  const auto motion = [&](const char* name) {
    if (samples_.add_motion(name)) variables_.emplace_back(name);
  };
  variable("mach", "Mach number", "", &F::mach);
  variable("pressure", "measured static pressure", "hPa", &F::static_pressure);
  motion("attack");
  motion("sideslip");
  variable("ratio", "measured q/p", "", &F::dynamic_ratio);
  for (const char* const name : {"true_airspeed", "altitude", "vertical_speed", "roll"}) motion(name);
  variable("wanted", "delta-p, reference", "hPa",
           [](const F& f) -> const V& { return f.reference_defects.front(); });
  defects_.emplace_back("wanted");
  for (std::size_t m = 0; m < comparison.models.size(); ++m) {
    const std::string name = fmt::format("model{}", m + 1);
    const std::string title =
        comparison.models.size() == 1 ? "the model" : label_of_model(comparison.models[m]);
    if (variable(name, "delta-p, " + title, "hPa",
                 [m](const F& f) -> const V& { return f.model_defects[m]; }))
      defects_.push_back(name);
  }
  samples_.add_position();
}

void ComparisonPanels::add_panels() {
  const ModelComparison& last = comparison_.models.back();
  report().items.emplace_back(TimePanel{
      "Residual in time", "Residual: reference minus model; regimes are shaded.", residuals_, "residual"});
  add_model_table();
  add_strip(report());
  report().items.emplace_back(RegimeTable{"By regime",
                                          last.is_by_gps()
                                              ? "Bias (mean) and rms of the residual in each regime, with "
                                                "variations of the atmosphere. The GPS bias excludes these."
                                              : "Bias and rms of the residual in each regime.",
                                          residuals_});
  add_regimes(report(), residuals_);
  report().items.emplace_back(BinnedPanel{"Residual against a variable",
                                          "A slope or curvature larger than the error bars indicates a "
                                          "missing effect, a wrong coefficient or slow drift.",
                                          residuals_, variables_,
                                          noise_autocorrelation(report(), residuals_.back()), "residual"});
  report().items.emplace_back(
      PlanePanel{title_of("Residual over Mach number and pressure", last),
                 "Errors of the model over its envelope: a region of one colour has a bias.", "mach",
                 "pressure", residuals_.back()});
  add_distributions(report(), residuals_);
  add_track(report(), title_of("Residual on the map", last),
            "Ground track: one colour over a leg, or for one heading, indicates a dependence on the place or "
            "the direction.",
            residuals_.back());
  if (!comparison_.is_static_pressure) return;
  report().items.emplace_back(TimePanel{
      comparison_.models.size() == 1 ? "Delta-p of the reference and of the model"
                                     : "Delta-p of the reference and of the models",
      fmt::format("Delta-p implied by the reference ({}), and delta-p of the model.", comparison_.reference),
      defects_, "delta-p"});
  report().items.emplace_back(PairPanel{title_of("Delta-p of the reference against that of the model", last),
                                        "A perfect model lies on the line.",
                                        defects_.back(),
                                        "wanted",
                                        {{1.0, 0.0, "equal"}}});
}

void ComparisonPanels::add_pairs() {
  const auto pair = [&](const char* title, const char* caption, const char* x, const char* y,
                        const LineFit& fit) {
    const std::string numbers = fmt::format(
        "Slope {:.5f}, offset {:.3f} hPa, rms {:.3f} hPa, mean difference {:+.3f} hPa over {} samples; the "
        "report of check states their errors, which allow for autocorrelation.",
        fit.slope, fit.offset, fit.rms, fit.mean_difference, fit.samples);
    const std::vector<ReportLine> lines{{1.0, 0.0, "equal"}, {fit.slope, fit.offset, "fitted line"}};
    report().items.emplace_back(PairPanel{title, caption + numbers, x, y, lines});
  };
  if (comparison_.total_pressure) {
    add("total", "model's system", &FlightResiduals::total_pressure);
    add("reference_total", "reference", &FlightResiduals::reference_total_pressure);
    pair("Total pressures of the two systems",
         "Static defects cancel in the total pressure: the difference shows errors of the transducers, the "
         "pitots and the lines. ",
         "total", "reference_total", *comparison_.total_pressure);
  }
  if (!comparison_.is_static_pressure) return;
  add("corrected", "model",
      [](const FlightResiduals& f) -> const std::vector<double>& { return f.corrected_pressures.back(); });
  report().columns.push_back(report().columns.back());
  ReportColumn& reference = report().columns.back();
  reference.name = "reference_corrected";
  reference.title = "reference";
  const std::vector<double>& residual = report().columns[comparison_.models.size() - 1].values;
  for (std::size_t i = 0; i < reference.values.size(); ++i) reference.values[i] += residual[i];
  pair("Corrected static pressures", "The line is an orthogonal fit, its rms that of the distances from it. ",
       "corrected", "reference_corrected", comparison_.models.back().static_pressure);
}

void ComparisonPanels::add_model_table() {
  if (labels_.front() == comparison_.models.front().name) return;
  ReportTable table{"Models", "", {"", "model", "bias, hPa", "rms, hPa", "noise, hPa"}};
  for (const ModelComparison& model : comparison_.models) {
    table.rows.push_back({label_of_model(model), model.name, fmt::format("{:+.3f}", model.all.bias),
                          fmt::format("{:.3f}", model.all.rms), fmt::format("{:.3f}", model.all.noise_rms)});
  }
  report().items.emplace_back(std::move(table));
}

void ComparisonPanels::add_tables() {
  ReportTable masks{
      "Samples", "Each sample is counted under the first reason that applies.", {"samples", "why"}};
  for (std::size_t i = 0; i < mask_count; ++i) {
    if (comparison_.masks[i] > 0)
      masks.rows.push_back({std::to_string(comparison_.masks[i]),
                            i == 0 ? "used" : "not used: " + std::string(mask_info[i].meaning)});
  }
  report().items.emplace_back(std::move(masks));
  const auto by_name = [](const ModelComparison& a, const ModelComparison& b) { return a.name < b.name; };
  const ModelComparison& first =
      *std::min_element(comparison_.models.begin(), comparison_.models.end(), by_name);
  const std::string bands_caption = fmt::format(
      "Bands with fewer than 30 samples are omitted. Std. error: of the bias, for correlated noise with "
      "drift.{}",
      comparison_.models.size() == 1
          ? ""
          : " The Mach number is that of '" + label_of_model(first) +
                "', the noise that of the model with the least noise on each flight.");
  for (const ModelComparison& model : comparison_.models) {
    ReportTable worst{title_of("The worst minutes", model),
                      "The minutes with the largest rms residual, and their regimes.",
                      {"flight", "begin (UTC)", "end", "bias, hPa", "rms, hPa", "regimes"}};
    for (const WorstInterval& interval : model.worst) {
      worst.rows.push_back({interval.flight, utc_text(interval.begin), utc_text(interval.end, "%H:%M:%S"),
                            fmt::format("{:.3f}", interval.statistics.bias),
                            fmt::format("{:.3f}", interval.statistics.rms), interval.regimes});
    }
    report().items.emplace_back(std::move(worst));
    ReportTable bands{title_of("By band", model),
                      bands_caption,
                      {"band", "samples", model.is_by_gps() ? "GPS bias, hPa" : "bias, hPa",
                       "std. error, hPa", "rms, hPa", model.is_by_gps() ? "rms / max noise" : "rms / noise"}};
    for (const PartStatistics& band : model.bands) {
      bands.rows.push_back(
          {band.name, std::to_string(band.statistics.samples), fmt::format("{:.3f}", band.statistics.bias),
           fmt::format("{:.3f}", band.statistics.bias_error), fmt::format("{:.3f}", band.statistics.rms),
           fmt::format("{:.1f}", band.statistics.rms_over_noise())});
    }
    report().items.emplace_back(std::move(bands));
  }
}

namespace {

/// Comparison of the rms with the noise; empty if it is unknown.
std::string over_noise(const ModelComparison& model) {
  const double ratio = model.noise_ratio();
  if (std::isnan(ratio)) return "";
  return fmt::format(", {:.1f} times the noise of {:.3f} hPa", ratio, model.all.noise_rms);
}

}  // namespace

void ComparisonPanels::summarise() {
  for (const ModelComparison& model : comparison_.models) {
    // Differences over time have no R2.
    const std::string r_squared =
        std::isfinite(model.r_squared)
            ? fmt::format("; R2 {:.2f} = 1 - (rms / standard deviation of the reference's delta-p)²",
                          model.r_squared)
            : "";
    report().summary.push_back(
        sentence(fmt::format("{}: {}bias {:+.3f} hPa, rms {:.3f} hPa{}, over {} samples{}",
                             label_of_model(model), model.is_by_gps() ? "GPS " : "", model.all.bias,
                             model.all.rms, over_noise(model), model.all.samples, r_squared)));
  }
  for (const ModelComparison& model : comparison_.models) {
    if (const std::string text = flaps_out_text(model.flaps_out, "the comparison"); !text.empty())
      report().summary.push_back(sentence(text));
  }
  const ModelComparison& last = comparison_.models.back();
  if (std::string text = format_shown_flights(comparison_.flights.size(), last.flights.size()); !text.empty())
    report().summary.push_back(std::move(text));
  const std::size_t min_samples = std::max(min_in_regime, last.all.samples / 100);
  const PartStatistics* worst = nullptr;
  for (const PartStatistics& part : last.regimes) {
    if (last.is_by_gps() || part.statistics.samples < min_samples ||
        !(part.statistics.rms_over_noise() > notable_failure))
      continue;
    if (worst == nullptr || fails_more(part.statistics, worst->statistics)) worst = &part;
  }
  if (worst != nullptr) {
    report().summary.push_back(
        fmt::format("{} has its largest errors in the regime {}: bias {:+.3f} hPa, rms {:.3f} hPa, {:.1f} "
                    "times the noise there.",
                    comparison_.models.size() == 1 ? "It" : "The last", worst->name, worst->statistics.bias,
                    worst->statistics.rms, worst->statistics.rms_over_noise()));
  }
  report().info.emplace_back("Reference", comparison_.reference);
  samples_.add_flights_to_info();
  report().info.emplace_back("Program", "pcor " PCOR_VERSION);
  for (const Note& note : comparison_.notes) report().info.emplace_back(label_of(note), note.text);
}

}  // namespace pcor::internal

namespace pcor {

Report comparison_report(const Comparison& comparison) {
  internal::ComparisonPanels panels(comparison);
  const ModelComparison& best = *std::min_element(
      comparison.models.begin(), comparison.models.end(),
      [](const ModelComparison& a, const ModelComparison& b) { return a.all.rms < b.all.rms; });
  const ModelComparison& worst = worst_by_noise(comparison, best);
  std::vector<std::string> names;
  for (const ModelComparison& model : comparison.models) names.push_back(panels.label_of_model(model));
  panels.report().title =
      worst.is_by_gps()
          ? fmt::format("Residual by {}: {}", best.reference, fmt::join(names, "; "))
          : fmt::format("{}{}: rms residual {:.3f} hPa{}{}",
                        comparison.models.size() > 1 ? "Smallest error by " : "", panels.label_of_model(best),
                        worst.all.rms, &worst == &best ? "" : " by " + worst.reference,
                        internal::over_noise(worst));
  panels.report().subtitle = "Comparison with " + comparison.reference;
  panels.summarise();
  // The further references follow the first sentence.
  std::vector<std::string> others;
  for (const Comparison& further : comparison.further) {
    for (const ModelComparison& model : further.models)
      others.push_back(fmt::format("{}{}: {}bias {:+.3f} hPa, rms {:.3f} hPa{}.",
                                   comparison.models.size() > 1 ? panels.label_of_model(model) + ", " : "",
                                   further.reference, model.is_by_gps() ? "GPS " : "", model.all.bias,
                                   model.all.rms, internal::over_noise(model)));
  }
  std::vector<std::string>& summary = panels.report().summary;
  summary.insert(summary.begin() + 1, others.begin(), others.end());
  panels.add_panels();
  panels.add_pairs();
  panels.add_tables();
  return std::move(panels.report());
}

}  // namespace pcor

#include "improve/improvement_pictures.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string>
#include <vector>

#include <pcor/numerics/noise.hpp>
#include "base/phrasing.hpp"
#include "diagnose/diagnosis_panels.hpp"
#include "fit/coefficient_picture.hpp"
#include "numerics/missing.hpp"

namespace pcor::internal::report {
namespace {

/// Effective sample size of the residuals, held out or fitted.
double independent_samples(const Improvement& improvement, bool held_out) {
  double independent = 0.0;
  for (const ImprovedFlight& flight : improvement.flights) {
    const std::size_t count = held_out ? flight.held_out : flight.fitted;
    if (count == 0 || flight.samples == nullptr) continue;
    const double step = flight.samples->step;
    const NoiseFloor noise =
        noise_floor(flight.best, contiguous_segments(flight.best, flight.samples->time, step), step);
    independent += static_cast<double>(count) / noise.autocorrelation_time;
  }
  return independent;
}

std::string held_out_series(const Improvement& improvement) {
  if (!improvement.holdout_is_flights) return "not in the fit, every fifth 5 min in turn";
  return "held out: " + join_list(held_out_names(improvement));
}

/// Coefficient by name, like "static-qp.a2"; NaN if the model does not have it.
double value_in(const ModelDefinition& model, const std::string& name) {
  for (const ModelEffect& effect : model.model.effects) {
    const std::vector<std::string> names = parameter_names(effect);
    for (std::size_t i = 0; i < std::min(names.size(), effect.parameters.size()); ++i) {
      if (effect.id + "." + names[i] == name) return effect.parameters[i];
    }
  }
  return nan;
}

}  // namespace

std::vector<std::string> held_out_names(const Improvement& improvement) {
  std::vector<std::string> names;
  for (const ImprovedFlight& flight : improvement.flights) {
    if (flight.held_out > 0)
      names.push_back((flight.fitted > 0 ? "the last part of " : "") + flight.samples->name);
  }
  return names;
}

std::string held_out_text(const Improvement& improvement) {
  if (improvement.holdout_is_flights) return "";
  return fmt::format(
      "Not in the fit: every fifth five minutes in turn, without outliers, with {} to the rest.",
      refitted_text(improvement.steps.back().diagnosis));
}

std::string step_name(const ImproveStep& step) { return step.added.empty() ? "refitted" : "+ " + step.added; }

bool delivers_rivals(const Improvement& improvement) {
  return std::any_of(improvement.steps.begin(), improvement.steps.end(), [](const ImproveStep& step) {
    return !step.rivals.empty() && step.delivered != step.added;
  });
}

DotPanel steps_picture(const Improvement& improvement) {
  DotPanel panel;
  panel.title = "Rms of each step";
  panel.caption =
      "Rms residual after each effect that was added. Bars are standard errors for the effective sample "
      "size; the dashed line is the noise, a lower limit. All values use the same samples, so a step may be "
      "significant although bars overlap.";
  if (const std::string text = held_out_text(improvement); !text.empty()) panel.caption += " " + text;
  panel.axis = "rms residual";
  panel.unit = "hPa";
  panel.series = {"fitted", held_out_series(improvement)};
  const double noise = improvement.steps.back().noise_rms;
  if (std::isfinite(noise)) panel.lines = {{fmt::format("noise, {:.3f} hPa", noise), noise}};
  const double fitted = independent_samples(improvement, false);
  const double apart = improvement.holdout_is_flights ? independent_samples(improvement, true) : fitted;
  const auto dot = [](double rms, double independent) {
    const double error = rms / std::sqrt(2.0 * independent);
    return ReportDot{rms, std::isfinite(error) ? error : 0.0};
  };
  const auto add = [&](const std::string& label, double in_fit, double held_out) {
    if (!std::isfinite(in_fit) && !std::isfinite(held_out)) return;
    const auto text = [](double rms) { return std::isfinite(rms) ? fmt::format("{:.3f}", rms) : "–"; };
    panel.rows.push_back({label,
                          {dot(in_fit, fitted), dot(held_out, apart)},
                          fmt::format("{} and {}", text(in_fit), text(held_out))});
  };
  add("given model", improvement.given_rms_train, improvement.given_rms_holdout);
  for (const ImproveStep& step : improvement.steps) add(step_name(step), step.rms_train, step.rms_holdout);
  if (delivers_rivals(improvement)) add("written model", improvement.rms_train, improvement.rms_holdout);
  return panel;
}

std::optional<DotPanel> coefficients_picture(const Improvement& improvement, const ModelDefinition& start) {
  std::vector<FittedParameter> parameters = improvement.fit.parameters;
  for (FittedParameter& parameter : parameters) parameter.start = value_in(start, parameter.name);
  return coefficient_picture(parameters, "given model", "best model");
}

void name_held_out(Report& report, const Improvement& improvement) {
  for (const ImprovedFlight& flight : improvement.flights) {
    if (flight.held_out == 0 || flight.samples == nullptr) continue;
    const auto is_fitted = [&](const ImprovedFlight& other) {
      return other.fitted > 0 && other.samples != nullptr && other.samples->name == flight.samples->name;
    };
    if (std::any_of(improvement.flights.begin(), improvement.flights.end(), is_fitted)) continue;
    const auto name = std::find(report.flight_names.begin(), report.flight_names.end(), flight.samples->name);
    if (name != report.flight_names.end()) *name += ", held out";
  }
}

}  // namespace pcor::internal::report

#include <pcor/improve/improvement_report.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include <pcor/base/error.hpp>
#include <pcor/diagnose/diagnosis_report.hpp>

#include "diagnose/diagnosis_panels.hpp"
#include "diagnose/finding_page.hpp"
#include "fit/fit_pictures.hpp"
#include "residuals/flight_statistics.hpp"

namespace pcor {

using namespace internal;

namespace {

using namespace internal::report;

/// Effective sample size of the residuals. @param count of the samples, held out or fitted
double independent_samples(const Improvement& improvement, std::size_t ImprovedFlight::*count) {
  double independent = 0.0;
  for (const ImprovedFlight& flight : improvement.flights) {
    if (flight.*count == 0) continue;
    independent += static_cast<double>(flight.*count) /
                   noise_of_flight(*flight.samples, flight.best).autocorrelation_time;
  }
  return independent;
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

/// Description of the held-out samples: "rf03.nc", "the last part of rf01.nc".
std::vector<std::string> held_out_names(const Improvement& improvement) {
  std::vector<std::string> names;
  for (const ImprovedFlight& flight : improvement.flights) {
    if (flight.held_out > 0)
      names.push_back((flight.fitted > 0 ? "the last part of " : "") + flight.samples->name);
  }
  return names;
}

/// Sentence on the held-out samples; empty with held-out flights or parts of them.
std::string held_out_text(const Improvement& improvement) {
  if (improvement.holdout_is_flights) return "";
  return "Held out: five-fold cross-validation in blocks of 5 min, without outliers.";
}

/// Label of a step: "refitted", "+ static-lag".
std::string step_name(const ImproveStep& step) { return step.added.empty() ? "refitted" : "+ " + step.added; }

/// Rms residual of every step, fitted and held out, with the noise as a line.
DotPanel steps_picture(const Improvement& improvement) {
  DotPanel panel;
  panel.title = "Rms of each step";
  panel.caption =
      "Rms residual after each added effect, with standard errors for the effective sample size; dashed: the "
      "noise, a lower limit. All values use the same samples, so a step may be significant although bars "
      "overlap.";
  if (const std::string text = held_out_text(improvement); !text.empty()) panel.caption += " " + text;
  panel.axis = "rms residual";
  panel.unit = "hPa";
  panel.series = {"fitted", improvement.holdout_is_flights
                                ? "held out: " + join_list(held_out_names(improvement))
                                : "held out, five-fold"};
  const double noise = improvement.steps.back().noise_rms;
  if (std::isfinite(noise)) panel.lines = {{fmt::format("noise, {:.3f} hPa", noise), noise}};
  const double fitted = independent_samples(improvement, &ImprovedFlight::fitted);
  const double apart =
      improvement.holdout_is_flights ? independent_samples(improvement, &ImprovedFlight::held_out) : fitted;
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
  add("input model", improvement.given_rms_train, improvement.given_rms_holdout);
  for (const ImproveStep& step : improvement.steps) add(step_name(step), step.rms_train, step.rms_holdout);
  const bool delivers_rivals = std::any_of(
      improvement.steps.begin(), improvement.steps.end(),
      [](const ImproveStep& step) { return !step.rivals.empty() && step.delivered != step.added; });
  if (delivers_rivals) add("written model", improvement.rms_train, improvement.rms_holdout);
  return panel;
}

/// Marks each completely held-out flight in its name.
void name_held_out(Report& report, const Improvement& improvement) {
  for (const ImprovedFlight& flight : improvement.flights) {
    if (flight.held_out == 0) continue;
    const auto is_fitted = [&](const ImprovedFlight& other) {
      return other.fitted > 0 && other.samples->name == flight.samples->name;
    };
    if (std::any_of(improvement.flights.begin(), improvement.flights.end(), is_fitted)) continue;
    const auto name = std::find(report.flight_names.begin(), report.flight_names.end(), flight.samples->name);
    if (name != report.flight_names.end()) *name += ", held out";
  }
}

/// Flights of the diagnoses, followed by completely held-out flights.
Flights shown_flights(const Improvement& improvement) {
  Flights flights = improvement.steps.front().diagnosis.flights;
  for (const ImprovedFlight& held_out : improvement.flights) {
    if (held_out.fitted > 0 || held_out.held_out == 0) continue;
    FlightDiagnosis& flight = flights.emplace_back();
    flight.samples = held_out.samples;
    flight.before = held_out.best;
  }
  return flights;
}

ReportTable steps_table(const Improvement& improvement) {
  ReportTable table;
  table.title = "Steps of the selection";
  table.caption = held_out_text(improvement);
  table.headers = {"model",      "free coefficients", "rms fitted, hPa",    "rms held out, hPa",
                   "noise, hPa", "effect, hPa rms",   "not separable from", "conclusion"};
  for (std::size_t i = 0; i < improvement.steps.size(); ++i) {
    const ImproveStep& step = improvement.steps[i];
    const Finding* const finding = i > 0 ? finding_of(improvement, i) : nullptr;
    table.rows.push_back({step_name(step), std::to_string(step.terms), cell(step.rms_train, 3),
                          cell(step.rms_holdout, 3), cell(step.noise_rms, 3),
                          finding == nullptr ? "" : finding->size_text(""), join_list(step.aliases),
                          sentence(step.summary)});
  }
  return table;
}

void summarise(Report& report, const Improvement& improvement) {
  summarise_held_out(report, improvement.fit.flights);
  const ImproveStep& first = improvement.steps.front();
  const ImproveStep& last = improvement.steps.back();
  report.summary.push_back(
      improvement.steps.size() == 1
          ? fmt::format(
                "The rms residual is {} hPa, with the coefficients fitted again {} hPa, and {} hPa held out; "
                "the noise is {} hPa.",
                hpa(improvement.given_rms_train), hpa(last.rms_train), hpa(last.rms_holdout),
                hpa(last.noise_rms))
          : fmt::format("The held-out rms residual changes from {} to {} hPa; the noise is {} hPa.",
                        hpa(first.rms_holdout), hpa(last.rms_holdout), hpa(last.noise_rms)));
  for (const ImproveStep& step : improvement.steps) {
    if (step.added.empty()) continue;
    std::string text =
        fmt::format("Added: {}; the held-out rms residual becomes {} hPa (fitted: {} hPa).",
                    name_with_id(step.title, step.added), hpa(step.rms_holdout), hpa(step.rms_train));
    if (!step.aliases.empty())
      text += fmt::format(" These flights cannot distinguish it from {}.", join_list(step.aliases));
    report.summary.push_back(std::move(text));
    if (const std::string rivals = rivals_text(step); !rivals.empty())
      report.summary.push_back(sentence("Of " + step.added + ": " + rivals));
  }
  if (const std::string text = flaps_out_text(improvement.fit.flaps_out, "the fit"); !text.empty())
    report.summary.push_back(sentence(text));
  if (!improvement.stop_explanation.empty()) report.summary.push_back(sentence(improvement.stop_explanation));
  std::string verdict = verdict_text(last.diagnosis);
  verdict.front() = static_cast<char>(std::tolower(static_cast<unsigned char>(verdict.front())));
  report.summary.push_back("After the last step: " + verdict + ".");
  for (const Finding& finding : last.diagnosis.findings) report.summary.push_back(finding_summary(finding));
  for (std::string& text : unexplained_text(last.diagnosis.unexplained))
    report.summary.push_back(std::move(text));
}

/// Page of the effect that a step added, and its pictures.
void add_step(DiagnosisPanels& panels, const Improvement& improvement, std::size_t index) {
  const ImproveStep& step = improvement.steps[index];
  const Diagnosis& before = improvement.steps[index - 1].diagnosis;
  const std::string heading = fmt::format("Step {}: {}", index, step.added);
  std::vector<std::string> inputs;
  for (const ModelEffect& effect : improvement.model.model.effects) {
    if (effect.id == step.added) inputs = inputs_of(effect);
  }
  inputs.push_back(numbered("added", index));
  const Finding* const finding = finding_of(improvement, index);
  ReportText page{heading, unexplained_text(before.unexplained)};
  page.paragraphs.insert(page.paragraphs.begin(), "Added: " + name_with_id(step.title, step.added) + ".");
  if (finding != nullptr) {
    page = finding_page(*finding, before.threshold, heading);
    panels.add_finding_columns(before.flights, static_cast<std::size_t>(finding - before.findings.data()),
                               step.added, index);
  }
  const std::string prefix = step.added + ".";
  std::vector<CoefficientEstimate> fitted;
  for (const FittedParameter& p : improvement.fit.parameters) {
    if (p.name.rfind(prefix, 0) == 0)
      fitted.push_back({p.name.substr(prefix.size()), p.unit, p.value, p.standard_error});
  }
  if (!fitted.empty())
    page.paragraphs.push_back(
        fmt::format("{} {}.", step.rivals.empty() ? "In the best model" : "Fitted as the only added effect",
                    estimates_text(fitted)));
  panels.add(std::move(page));
  panels.add_binned("Residual without and with " + step.added + ", against its inputs",
                    {numbered("step", index - 1), numbered("step", index)}, inputs);
  panels.add_plane("Evidence for " + step.added + ", over Mach number and pressure",
                   "Orange supports the effect, blue contradicts it.", numbered("evidence", index));
}

}  // namespace

Report improvement_report(const Improvement& improvement, const ModelDefinition& start,
                          const WhatIf* what_if) {
  if (improvement.steps.empty())
    throw Error(Error::Code::usage, "report: the improvement has no step; call improve first");
  const std::vector<ImproveStep>& steps = improvement.steps;
  const Diagnosis& top = steps.back().diagnosis;
  DiagnosisPanels panels(shown_flights(improvement));
  Report& report = panels.report();
  const std::size_t added = steps.size() - 1;
  report.title = added == 0   ? "No effect makes the model better"
                 : added == 1 ? "One effect makes the model better: " + steps.back().title
                              : fmt::format("{} effects make the model better", added);
  report.subtitle = fmt::format("Improvement of {} against {}", start.model.name, top.reference);
  summarise(report, improvement);
  panels.add_info(top, start, {});

  std::vector<std::string> residuals;
  for (std::size_t i = 0; i < steps.size(); ++i) {
    panels.add_predictor(steps[i].diagnosis);
    residuals.push_back(numbered("step", i));
    panels.add_column(residuals.back(), "residual, " + step_name(steps[i]), "hPa", steps[i].diagnosis.flights,
                      &FlightDiagnosis::before);
  }
  residuals = present(report, std::move(residuals));
  name_held_out(report, improvement);
  const std::vector<ImprovedFlight>& flights = improvement.flights;
  panels.add_column("model-given", "residual, input model", "hPa", flights, &ImprovedFlight::given);
  panels.add_column("model-refitted", "residual, refitted", "hPa", flights, &ImprovedFlight::refitted);
  panels.add_column("model-best", "residual, best model", "hPa", flights, &ImprovedFlight::best);
  panels.add(steps_picture(improvement));
  if (what_if != nullptr) {
    const ModelEffect& last = improvement.fit.model.model.effects.back();
    panels.add_what_if(*what_if, "model-refitted", added > 0 ? inputs_of(last) : std::vector<std::string>{},
                       steps.back().noise_rms);
  }
  add_held_out(report, improvement.fit.flights);
  std::vector<FittedParameter> parameters = improvement.fit.parameters;
  for (FittedParameter& parameter : parameters) parameter.start = value_in(start, parameter.name);
  if (auto picture = coefficient_picture(parameters, "input model", "best model"))
    panels.add(std::move(*picture));
  if (!residuals.empty())
    panels.add_plane("Remaining residual over Mach number and pressure",
                     "Residual after the last step: one colour over a region is a bias there.",
                     residuals.back());
  panels.add_table(steps_table(improvement));
  constexpr double averaging_time = 60.0;  // s, so that noise does not hide the slow changes
  std::string caption = fmt::format("Means over {:g} s.", averaging_time);
  const std::vector<std::string> held_out = held_out_names(improvement);
  if (!held_out.empty()) caption += fmt::format(" Held out: {}.", join_list(held_out));
  add_if_present(report, TimePanel{"Residuals of the models in time",
                                   std::move(caption),
                                   {"model-given", "model-refitted", "model-best"},
                                   "residual",
                                   "",
                                   averaging_time});
  if (residuals.size() > 2) residuals = {residuals.front(), residuals.back()};
  panels.add_residuals(top, residuals);
  for (std::size_t i = 1; i < steps.size(); ++i) add_step(panels, improvement, i);
  panels.add_last_panels(top, residuals);
  return std::move(report);
}

}  // namespace pcor

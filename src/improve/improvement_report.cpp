#include <pcor/improve/improvement_report.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include <pcor/base/error.hpp>
#include <pcor/diagnose/diagnosis_report.hpp>

#include "diagnose/diagnosis_panels.hpp"
#include "diagnose/finding_page.hpp"
#include "fit/held_out_panel.hpp"
#include "improve/improvement_pictures.hpp"

namespace pcor {

using namespace internal;

namespace {

using namespace internal::report;

/// Flights with one of their residuals, in the format of the panels.
Flights with_residual(const Improvement& improvement, std::vector<double> ImprovedFlight::*residual) {
  Flights flights;
  for (const ImprovedFlight& flight : improvement.flights) {
    flights.emplace_back();
    flights.back().samples = flight.samples;
    flights.back().before = flight.*residual;
  }
  return flights;
}

/// Flights of the diagnoses, followed by completely held-out flights.
Flights shown_flights(const Improvement& improvement) {
  Flights flights = improvement.steps.front().diagnosis.flights;
  const Flights all = with_residual(improvement, &ImprovedFlight::best);
  for (std::size_t f = flights.size(); f < all.size(); ++f) flights.push_back(all[f]);
  return flights;
}

/// Residuals of the initial, refitted and final model; the names of those that are known.
std::vector<std::string> add_model_columns(DiagnosisPanels& panels, const Improvement& improvement) {
  const auto before = [](const FlightDiagnosis& flight) { return flight.before; };
  std::vector<std::string> columns;
  const auto add = [&](const char* name, const std::string& title, auto residual) {
    if (panels.add_column(name, title, "hPa", with_residual(improvement, residual), before))
      columns.emplace_back(name);
  };
  add("model-given", "residual, given model", &ImprovedFlight::given);
  add("model-refitted", "residual, refitted", &ImprovedFlight::refitted);
  add("model-best", "residual, best model", &ImprovedFlight::best);
  return columns;
}

/// Residuals of the models over time, averaged so that noise does not hide the slow changes.
void add_models_in_time(DiagnosisPanels& panels, const Improvement& improvement,
                        std::vector<std::string> columns) {
  if (columns.empty()) return;
  constexpr double averaging_time = 60.0;  // s
  std::string caption = fmt::format("Means over {:g} s.", averaging_time);
  const std::vector<std::string> names = held_out_names(improvement);
  if (!names.empty()) caption += fmt::format(" Held out: {}.", join_list(names));
  panels.add(TimePanel{"Residuals of the models in time", std::move(caption), std::move(columns), "residual",
                       "", averaging_time});
}

ReportTable steps_table(const Improvement& improvement) {
  ReportTable table;
  table.title = "Steps of the selection";
  table.caption = held_out_text(improvement);
  table.headers = {"model",
                   "free coefficients",
                   "rms in the fit, hPa",
                   improvement.holdout_is_flights ? "rms held out, hPa" : "rms not in the fit, hPa",
                   "noise, hPa",
                   "not separable from",
                   "conclusion"};
  for (const ImproveStep& step : improvement.steps) {
    table.rows.push_back({step_name(step), std::to_string(step.terms), cell(step.rms_train, 3),
                          cell(step.rms_holdout, 3), cell(step.noise_rms, 3), join_list(step.aliases),
                          sentence(step.learnt)});
  }
  return table;
}

void summarise(Report& report, const Improvement& improvement) {
  summarise_held_out(report, improvement.fit.flights);
  const ImproveStep& first = improvement.steps.front();
  const ImproveStep& last = improvement.steps.back();
  const char* const outside = improvement.holdout_is_flights ? "held-out samples" : "parts outside the fit";
  report.summary.push_back(
      improvement.steps.size() == 1
          ? fmt::format(
                "The rms residual is {} hPa, with the coefficients fitted again {} hPa, and {} hPa on {}; "
                "the noise is {} hPa.",
                hpa(improvement.given_rms_train), hpa(last.rms_train), hpa(last.rms_holdout), outside,
                hpa(last.noise_rms))
          : fmt::format("On {} the rms residual changes from {} to {} hPa; the noise is {} hPa.", outside,
                        hpa(first.rms_holdout), hpa(last.rms_holdout), hpa(last.noise_rms)));
  for (const ImproveStep& step : improvement.steps) {
    if (step.added.empty()) continue;
    std::string text = fmt::format("Added: {}; the rms residual becomes {} hPa.",
                                   name_with_id(step.title, step.added), hpa(step.rms_holdout));
    if (!step.aliases.empty())
      text += fmt::format(" These flights cannot distinguish it from {}.", join_list(step.aliases));
    report.summary.push_back(std::move(text));
    if (const std::string rivals = rivals_text(step); !rivals.empty())
      report.summary.push_back(sentence("Of " + step.added + ": " + rivals));
  }
  if (const std::string text = flaps_out_text(improvement.fit.flaps_out, "the fit"); !text.empty())
    report.summary.push_back(sentence(text));
  if (!improvement.why_stopped.empty()) report.summary.push_back(sentence(improvement.why_stopped));
  std::string verdict = verdict_text(last.diagnosis);
  verdict.front() = static_cast<char>(std::tolower(static_cast<unsigned char>(verdict.front())));
  report.summary.push_back("After the last step: " + verdict + ".");
  for (const Finding& finding : last.diagnosis.findings) report.summary.push_back(finding_summary(finding));
  for (std::string& text : unexplained_text(last.diagnosis.unexplained))
    report.summary.push_back(std::move(text));
}

/// Fitted coefficients of an effect.
std::vector<CoefficientEstimate> fitted_of(const RefitResult& fit, const std::string& effect) {
  std::vector<CoefficientEstimate> estimates;
  for (const FittedParameter& p : fit.parameters) {
    if (p.name.rfind(effect + ".", 0) == 0)
      estimates.push_back({p.name.substr(effect.size() + 1), p.unit, p.value, p.standard_error});
  }
  return estimates;
}

/// Page of the effect that a step added, and its pictures.
void add_step(DiagnosisPanels& panels, const Improvement& improvement, std::size_t index) {
  using F = FlightDiagnosis;
  const ImproveStep& step = improvement.steps[index];
  const Diagnosis& before = improvement.steps[index - 1].diagnosis;
  const std::string heading = fmt::format("Step {}: {}", index, step.added);
  const std::string evidence = numbered("evidence", index);
  const std::string added = numbered("added", index);
  std::vector<std::string> inputs;
  for (const ModelEffect& effect : improvement.model.model.effects) {
    if (effect.id == step.added) inputs = inputs_of(effect);
  }
  inputs.push_back(added);
  const auto finding = std::find_if(before.findings.begin(), before.findings.end(), [&](const Finding& one) {
    return !one.of_reference && one.effect.id == step.added;
  });
  ReportText page{heading, unexplained_text(before.unexplained)};
  page.paragraphs.insert(page.paragraphs.begin(), "Added: " + name_with_id(step.title, step.added) + ".");
  if (finding != before.findings.end()) {
    page = finding_page(*finding, before.threshold, heading);
    const auto number = static_cast<std::size_t>(finding - before.findings.begin());
    panels.add_column(evidence, "evidence for " + step.added, "1/min", before.flights,
                      [number](const F& f) { return one_of(f.evidence, number); });
    panels.add_column(added, "added by " + step.added, "hPa", before.flights,
                      [number](const F& f) { return one_of(f.added, number); });
  }
  if (const std::vector<CoefficientEstimate> fitted = fitted_of(improvement.fit, step.added); !fitted.empty())
    page.paragraphs.push_back(
        fmt::format("{} {}.", step.rivals.empty() ? "In the best model" : "Fitted as the only added effect",
                    estimates_text(fitted)));
  panels.add(std::move(page));
  panels.add_binned("Residual without and with " + step.added + ", against its inputs", effect_caption,
                    {numbered("step", index - 1), numbered("step", index)}, inputs);
  panels.add_plane("Evidence for " + step.added + ", over Mach number and pressure",
                   "Orange supports the effect, blue contradicts it.", evidence);
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
  add_info(panels, top, start, {});

  std::vector<std::string> residuals;
  for (std::size_t i = 0; i < steps.size(); ++i) {
    add_traced(panels, steps[i].diagnosis);
    std::string name = numbered("step", i);
    if (panels.add_column(name, "residual, " + step_name(steps[i]), "hPa", steps[i].diagnosis.flights,
                          [](const FlightDiagnosis& f) { return f.before; }))
      residuals.push_back(std::move(name));
  }
  panels.measure_memory(top.flights, [](const FlightDiagnosis& f) -> const Series& { return f.before; });
  name_held_out(report, improvement);
  const std::vector<std::string> models = add_model_columns(panels, improvement);
  panels.add(steps_picture(improvement));
  if (what_if != nullptr) {
    const ModelEffect& last = improvement.fit.model.model.effects.back();
    panels.add_what_if(*what_if, "model-refitted", added > 0 ? inputs_of(last) : std::vector<std::string>{},
                       steps.back().noise_rms);
  }
  add_held_out(report, improvement.fit.flights);
  if (auto coefficients = coefficients_picture(improvement, start)) panels.add(std::move(*coefficients));
  if (!residuals.empty())
    panels.add_plane("Remaining residual over Mach number and pressure",
                     "Residual after the last step: one colour over a region is a bias there.",
                     residuals.back());
  panels.add_table(steps_table(improvement));
  add_models_in_time(panels, improvement, models);
  const std::vector<std::string> ends =
      residuals.size() < 2 ? residuals : std::vector{residuals.front(), residuals.back()};
  add_residual_in_time(panels, ends, refitted_text(top));
  add_residual_by_regime(panels, ends, refitted_text(top));
  for (std::size_t i = 1; i < steps.size(); ++i) add_step(panels, improvement, i);
  add_distribution_panels(panels, ends);
  panels.add_responses(ends, reads_laser(top));
  if (!residuals.empty()) add_unexplained(panels, top, residuals.back());
  add_tables(panels, top);
  return std::move(report);
}

}  // namespace pcor

#include <pcor/improve/improve.hpp>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include <pcor/improve/improvement_report.hpp>
#include "communicator.hpp"
#include "comparison.hpp"
#include "diagnosis.hpp"
#include "fit_options.hpp"
#include "model_selector.hpp"
#include "progress.hpp"
#include "report_origin.hpp"

namespace pcor::tool {
namespace {

struct ImproveArguments {
  CommonOptions common;
  ComparisonOptions comparison;
  CandidateOptions candidates;
  FitOptions fit;
  std::string model;
  std::string output;
  bool trace_variables = false;
  bool force = false;
};

std::vector<NextStep> next_steps(const Improvement& improvement, const ImproveArguments& options) {
  if (improvement.fit.defect_error > max_defect_error)
    return {
        {fmt::format("The flights do not determine delta-p: its standard error is {:.2f} hPa. Give a "
                     "further --reference",
                     improvement.fit.defect_error)}};
  return {{"To apply it", process_command(options.comparison.flights, improvement.model, options.output,
                                          options.comparison.timestamp_alignment)}};
}

void print(const Improvement& improvement, const ChosenReferences& references,
           const ImproveArguments& options) {
  if (is_verbose()) {
    print_references(references);
    print_formatted("reference: {}\n", improvement.fit.reference_text);
    print_formatted("fitted to {} samples; not used: {}\n", improvement.fit.samples,
                    mask_text(improvement.fit.masks));
    print_flaps_out(improvement.fit.flaps_out, "the fit");
    print_formatted("\n");
  }
  std::vector<std::string> added;
  for (const ImproveStep& step : improvement.steps) {
    if (!step.added.empty()) added.push_back(step.added);
  }
  const ImproveStep& last = improvement.steps.back();
  print_formatted("{}: rms {:.3f} hPa, held out {:.3f} hPa, noise {:.3f} hPa\n",
                  added.empty() ? "no effect added" : fmt::format("added {}", fmt::join(added, ", ")),
                  last.rms_train, last.rms_holdout, last.noise_rms);
  const auto figure = [](double rms) { return std::isnan(rms) ? std::string() : fmt::format("{:.4f}", rms); };
  print_formatted("{:<24} {:>10} {:>10} {:>10} {:>13}  {}\n", "rms, hPa", "training", "held out", "noise",
                  "coefficients", "rms of effect");
  print_formatted("{:<24} {:>10} {:>10}\n", "input model", figure(improvement.given_rms_train),
                  figure(improvement.given_rms_holdout));
  bool delivers_rivals = false;
  for (std::size_t i = 0; i < improvement.steps.size(); ++i) {
    const ImproveStep& step = improvement.steps[i];
    const Finding* const finding = i > 0 ? finding_of(improvement, i) : nullptr;
    print_formatted("{:<24} {:>10.4f} {:>10.4f} {:>10.4f} {:>13}{}\n",
                    step.added.empty() ? "refitted" : "+ " + step.added, step.rms_train, step.rms_holdout,
                    step.noise_rms, step.terms, finding == nullptr ? "" : "  " + finding->size_text(""));
    delivers_rivals = delivers_rivals || step.delivered != step.added;
  }
  if (delivers_rivals) {
    print_formatted("{:<24} {:>10} {:>10}\n", "output model", figure(improvement.rms_train),
                    figure(improvement.rms_holdout));
  }
  if (!options.fit.holdout.empty()) {
    std::vector<std::string> names;
    for (const std::string& path : options.fit.holdout)
      names.push_back(std::filesystem::path(path).filename().string());
    print_formatted("held out: {}\n", fmt::join(names, ", "));
  } else if (improvement.holdout_is_flights) {
    print_formatted("held out: the last {:.0f} % of every flight\n",
                    100.0 * (1.0 - options.fit.training_share));
  } else {
    print_formatted(
        "held out: five-fold cross-validation in blocks of 5 min, without outliers; hold out whole flights "
        "with --holdout\n");
  }
  print_fit_summary(improvement.fit);
  if (is_verbose()) {
    print_formatted("\n");
    for (const ImproveStep& step : improvement.steps) {
      print_formatted("{}\n", step.summary);
      if (const std::string text = rivals_text(step); !text.empty()) print_formatted("  {}\n", text);
    }
  }
  std::string stopped = improvement.stop_explanation;
  for (std::size_t at = 0; (at = stopped.find("; rejected: ", at)) != std::string::npos;)
    stopped.replace(at, 2, "\n");
  print_formatted("stopped: {}\n", stopped);
  if (is_verbose()) print_unexplained(improvement.steps.back().diagnosis.unexplained);
  print_notes(improvement.fit.notes);
  print_written_files({options.output, options.common.report, options.common.json});
  print_next_steps(next_steps(improvement, options));
}

void run(const ImproveArguments& options) {
  std::vector<std::filesystem::path> inputs =
      input_files(options.comparison, {options.model, options.candidates.file});
  inputs.insert(inputs.end(), options.fit.holdout.begin(), options.fit.holdout.end());
  prepare_outputs(options.common, {options.output}, inputs);
  JsonResult json(options.common);
  const CommandFlights of(options.comparison, options.fit.holdout);
  const ModelDefinition model =
      with_fit_options(read_model_for(options.model, of.flights, options.common), options.fit);
  const ChosenReferences references = references_to_fit(options.comparison, model, of.all());
  ImproveOptions improve_with;
  improve_with.refit.mask = mask_options(options.comparison);
  improve_with.refit.loss = *loss_named(options.fit.loss);
  improve_with.refit.training_share = options.fit.training_share;
  improve_with.refit.holdout = of.holdout;
  improve_with.refit.trust_reference = options.fit.trust_reference;
  improve_with.formulas = candidate_formulas(options.candidates, model, of.flights);
  improve_with.trace_variables = options.trace_variables;
  Improvement improvement;
  WhatIf tried;
  {
    std::optional<Progress> bar;
    improve_with.progress = [&](const std::string& what) { bar.emplace(what, !options.common.quiet); };
    improve_with.refit.progress = [&bar](std::size_t done, std::size_t total) { bar->show(done, total); };
    improvement = improve(of.flights, model, references.used, improve_with);
    if (!options.common.report.empty()) {
      tried = what_if(of.flights, improvement, references.used, improve_with);
      add_commands(tried, options.model, options.comparison.flights.front(),
                   command_line(options.comparison) + command_line(options.fit));
    }
  }
  require_improvement(improvement.rejection_reason, options.force, improvement.model);
  if (!is_speaker()) return;
  OutputTransaction together;
  write_model_output(improvement.model, options.output, inputs);
  if (!options.common.report.empty())
    write_report_of_run(improvement_report(improvement, model, &tried),
                        {{options.model, options.output},
                         options.comparison.flights,
                         options.fit.holdout,
                         next_steps(improvement, options)},
                        options.common);
  improvement.output = options.output;
  json.write(improvement);
  together.appear();
  if (wants_text(options.common, {options.output})) print(improvement, references, options);
}

}  // namespace

std::function<void()> add_improve(CLI::App& program) {
  auto options = std::make_shared<ImproveArguments>();
  CLI::App* command = program.add_subcommand(
      "improve", "Refit, diagnose and add missing effects repeatedly, until no effect is missing");
  add_comparison_options(*command, options->comparison);
  command->add_option("-m,--model", options->model, "initial model")->required()->type_name("MODEL.toml");
  command->add_option("-o,--output", options->output, "output model (written atomically); - for stdout")
      ->required()
      ->type_name("BEST.toml");
  add_fit_options(*command, options->fit);
  add_training_options(*command, options->fit, "every step");
  add_candidate_options(*command, options->candidates);
  command->add_flag("--trace-variables", options->trace_variables,
                    "if no effect of the catalogue explains the residual, add a formula of the correlated "
                    "variable, at the static ports unless total pressures show it as well");
  add_force_option(*command, options->force);
  add_common_options<Improvement>(*command, options->common);
  add_examples(
      *command,
      {"improve first.nc second.nc -m model.toml --holdout third.nc --trace-variables -o best.toml"});
  return [options] { run(*options); };
}

}  // namespace pcor::tool

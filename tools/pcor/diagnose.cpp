#include <pcor/diagnose/diagnose.hpp>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>

#include <pcor/base/error.hpp>
#include <pcor/base/suggest.hpp>
#include <pcor/base/utc.hpp>
#include <pcor/diagnose/diagnosis_report.hpp>
#include "communicator.hpp"
#include "comparison.hpp"
#include "diagnosis.hpp"
#include "fit_options.hpp"
#include "model_name.hpp"
#include "model_selector.hpp"
#include "progress.hpp"
#include "report_origin.hpp"

namespace pcor::tool {
namespace {

struct DiagnoseArguments {
  CommonOptions common;
  ComparisonOptions comparison;
  CandidateOptions candidates;
  FitOptions fit;
  std::string model;
  std::vector<std::string> not_variables;
  bool no_file_variables = false;
  bool full = false;
};

std::vector<std::filesystem::path> inputs_of(const DiagnoseArguments& options) {
  return input_files(options.comparison, {options.model, options.candidates.file});
}

/// The first items, and the number of the others.
std::string shortened_list(std::vector<std::string> items, std::size_t max_items = 5) {
  const std::size_t more = items.size() <= max_items ? 0 : items.size() - max_items;
  items.resize(items.size() - more);
  return fmt::format("{}{}", fmt::join(items, ", "), more == 0 ? "" : fmt::format(" and {} more", more));
}

void print_finding(const Finding& finding) {
  print_formatted("\n{}: {}\n", finding.id(), finding.title);
  if (finding.effect.is_formula()) print_formatted("  formula: {}\n", finding.effect.formula);
  print_formatted("  {}\n", kind_text(finding));
  if (!finding.largest_reference.empty()) print_formatted("  {}\n", finding.size_text());
  if (!finding.worst_flight.empty()) {
    print_formatted("  largest: {:+.3f} hPa in {} at {}\n", finding.worst, finding.worst_flight,
                    utc_text(finding.worst_time));
  }
  for (const Evidence& evidence : finding.evidence) {
    print_formatted("  {:>3.0f} % of the evidence: {} {} to {}  {}\n", 100.0 * evidence.share,
                    evidence.flight, utc_text(evidence.begin), utc_text(evidence.end, "%H:%M:%S"),
                    evidence.regimes);
  }
  for (const Alias& alias : finding.aliases) {
    const double typical = std::abs(alias.relative_size);
    const std::string size =
        typical == 0.0 ? ""
                       : fmt::format(", {:.{}f} times its typical size", typical, typical < 10.0 ? 1 : 0);
    print_formatted("  not distinguishable from {} with {}: correlation {:+.3f}, chi2 {:.1f} {}{}\n",
                    alias.effect, estimates_text(alias.estimates), alias.correlation,
                    std::abs(alias.chi2_difference), alias.chi2_difference < 0.0 ? "more" : "less", size);
  }
  if (!finding.advice.sentence.empty()) print_formatted("  advice: {}\n", finding.advice.sentence);
}

void print_findings(const std::vector<Finding>& findings) {
  if (findings.empty()) return;
  print_formatted("\n{:<20} {:<32} {:>9} {:>9} {:>8} {:>8} {:>9} {:>9} {:>7}\n", "missing effect",
                  "coefficient", "rms, hPa", "largest", "chi2", "p", "before", "after", "events");
  const auto held_out = [](double rms) { return std::isnan(rms) ? "-" : fmt::format("{:.4f}", rms); };
  for (const Finding& finding : findings) {
    print_formatted("{:<20} {:<32} {:>9.3f} {:>+9.3f} {:>8.1f} {:>8} {:>9} {:>9} {:>7.0f}\n", finding.id(),
                    estimates_text(finding.estimates), finding.largest_rms, finding.worst, finding.chi2,
                    probability(finding.p_value), held_out(finding.rms_before), held_out(finding.rms_after),
                    finding.events);
  }
  print_formatted(
      "before and after: rms, hPa, on held-out parts of the flights; events: separate times that support the "
      "effect\n");
  for (const Finding& finding : findings) print_finding(finding);
}

/// The findings, their rivals and the variables that the remaining residual is correlated with.
void print_short(const Diagnosis& diagnosis) {
  std::vector<std::string> advice;
  for (const Finding& finding : diagnosis.findings) {
    const std::string size = is_unusually_large(finding)
                                 ? fmt::format(" ({:.0f} times its usual size)", finding.relative_size)
                                 : "";
    print_formatted("{}: {}{}, {}, p {}\n", finding.id(), estimates_text(finding.estimates), size,
                    finding.size_text(), probability(finding.p_value));
    std::vector<std::string> rivals;
    for (const Alias& alias : finding.aliases) rivals.push_back(alias.effect);
    if (!rivals.empty()) print_formatted("  not distinguishable from {}\n", shortened_list(rivals));
    if (!finding.advice.sentence.empty()) advice.push_back(finding.advice.sentence);
  }
  if (!advice.empty())
    print_formatted("advice: {}{}\n", advice.front(),
                    advice.size() > 1 ? "; further advice with --verbose" : "");
  if (!diagnosis.unexplained.significant) return;
  std::vector<std::string> variables;
  for (const EmpiricalPredictor& variable : diagnosis.unexplained.variables) {
    if (!variable.similar_to.empty()) continue;
    std::vector<std::string> similar;
    for (const EmpiricalPredictor& other : diagnosis.unexplained.variables) {
      if (other.similar_to == variable.name) similar.push_back(other.name);
    }
    variables.push_back(fmt::format("{} (R2 {:.2f}{}{})", variable.name, variable.r2,
                                    similar.empty() ? "" : "; similar: ", fmt::join(similar, ", ")));
  }
  print_formatted("unexplained residual: {:.3f} hPa rms{}{}\n", diagnosis.unexplained.rms,
                  variables.empty() ? "" : ", correlated with ", shortened_list(variables));
}

void print_list(const std::string& title, const std::vector<std::string>& items, bool all) {
  if (!items.empty())
    print_formatted("{}: {}\n", title, all ? shortened_list(items, items.size()) : shortened_list(items));
}

void print_others(const Diagnosis& diagnosis, bool all) {
  std::vector<std::string> absorbed;
  std::vector<std::string> not_testable;
  std::vector<std::string> limits;
  for (const AbsorbedEffect& effect : diagnosis.absorbed)
    absorbed.push_back(fmt::format("{} (by {})", effect.effect, fmt::join(effect.by, ", ")));
  for (const NotTestable& effect : diagnosis.not_testable)
    not_testable.push_back(fmt::format("{} ({})", effect.effect, effect.reason));
  for (const UpperLimit& limit : diagnosis.limits) {
    const std::string sizes = limits_text(limit);
    limits.push_back(fmt::format("{} ({}{}{:.3f} hPa{}{})", limit.effect, sizes, sizes.empty() ? "" : ": ",
                                 limit.rms, limit.note.empty() ? "" : "; ", limit.note));
  }
  print_formatted("\n");
  print_list("not found, and at most (95 %)", limits, all);
  print_list("absorbed by the model", absorbed, all);
  print_list("not testable", not_testable, all);
}

/// The command that adds the findings, or the empirical term, and fits; otherwise the command that repeats
/// this for findings that one command cannot add. A sentence for each part that a model file cannot represent
/// comes first.
std::vector<NextStep> next_steps(const Diagnosis& diagnosis, const ModelDefinition& diagnosed,
                                 const DiagnoseArguments& options) {
  const std::string flights = advised_command_line(options.comparison) + command_line(options.fit);
  const std::string model = model_argument(options.model);
  const std::string compare =
      fmt::format("{} compare {} -m {}", program(), advised_command_line(options.comparison), model);
  const auto [detectable, tested] = detectable_at_usual_size(diagnosis);
  if (diagnosis.verdict == Verdict::none_detected && tested > 0 && detectable == 0)
    return {{"To test the model, add flights or a further reference. To see the residual", compare}};
  // A refit that decreases the rms by less than this share does not matter.
  constexpr double negligible = 0.02;
  if (diagnosis.verdict == Verdict::none_detected && diagnosis.is_refitted &&
      diagnosis.residual_rms_held_out < (1.0 - negligible) * diagnosis.rms_given) {
    return {{"No missing effect was detected, but a refit decreases the rms on held-out parts",
             fmt::format("{} refit {} -m {} -o {}", program(), flights, model,
                         output_file("fitted.toml", inputs_of(options)))}};
  }
  if (diagnosis.verdict == Verdict::none_detected) {
    return {{"To apply the model", process_command(options.comparison.flights, diagnosed, options.model,
                                                   options.comparison.timestamp_alignment)}};
  }
  const std::vector<std::filesystem::path> inputs = inputs_of(options);
  const std::string best = output_file("best.toml", inputs);
  const std::string and_fit =
      fmt::format(" -m {0} --flight {1} -o {2} && {3} refit {4} -m {2} -o {5}", model,
                  shell_path(options.comparison.flights.front()), output_file("extended.toml", inputs),
                  program(), flights, output_file("fitted.toml", inputs));
  const std::vector<Finding>& findings = diagnosis.findings;
  const auto of_catalogue = [](const Finding& finding) {
    return !finding.effect.is_formula() && !finding.may_be_of_reference();
  };
  const auto may_be_of_reference = [](const Finding& finding) { return finding.may_be_of_reference(); };
  const auto may_be_of_model = [](const Finding& finding) { return finding.may_be_of_model(); };
  if (!findings.empty() && std::all_of(findings.begin(), findings.end(), may_be_of_reference)) {
    const std::vector<std::string>& given = options.comparison.references;
    const bool has_third = std::any_of(given.begin(), given.end(), [](const std::string& reference) {
      return reference == "lams" || reference == "wind" || reference == "height";
    });
    return {{fmt::format("{}; the model is unchanged. To see it",
                         std::none_of(findings.begin(), findings.end(), may_be_of_model)
                             ? "The effect belongs to the reference system"
                         : has_third
                             ? "The references do not show which of the two systems has the error"
                             : "The difference of two systems does not show which of them has the error: a "
                               "further reference does (--reference lams, wind or height)"),
             compare}};
  }
  const bool sure = (diagnosis.verdict == Verdict::identified || diagnosis.verdict == Verdict::ambiguous) &&
                    std::all_of(findings.begin(), findings.end(),
                                [](const Finding& finding) { return finding.rival.empty(); });
  if (sure && std::all_of(findings.begin(), findings.end(), of_catalogue)) {
    std::vector<NextStep> steps;
    std::string add = program() + " add";
    for (const Finding& finding : findings) {
      add += " " + shell_quote(argument_of(finding.effect));
      if (!finding.is_shared) continue;
      steps.push_back(
          {fmt::format("{} was found {}, which a model file cannot represent: it is added without this part.",
                       finding.id(), finding.shape)});
    }
    steps.push_back({fmt::format("To add {} and fit", findings.size() == 1 ? "it" : "them"), add + and_fit});
    return steps;
  }
  if (sure && findings.size() == 1 && !findings[0].may_be_of_reference() &&
      findings[0].effect.parameter_names == std::vector<std::string>{"k"}) {
    const ModelEffect& effect = findings[0].effect;
    return {{"To add it and fit",
             fmt::format("{} add {} {} --where {}{}", program(), shell_quote(effect.id),
                         shell_option("--formula", effect.formula), info_of(effect.location).name, and_fit)}};
  }
  std::vector<std::string> roles;  // lines of the table [variables], each once: engine_torque = "ENGTRQ"
  for (const UnnamedRole& each : diagnosis.unnamed_roles) {
    std::string line = fmt::format("{} = \"{}\"", each.role, each.variable);
    if (std::find(roles.begin(), roles.end(), line) == roles.end()) roles.push_back(std::move(line));
  }
  const std::string improve = fmt::format("{} improve {} -m {}{} -o {}", program(), flights, model,
                                          command_line(options.candidates), best);
  if (!roles.empty())
    return {{fmt::format("First write {} into [variables] of {}. Then test its effect",
                         fmt::join(roles, " and "), options.model),
             improve}};
  if (!findings.empty()) return {{"To add helpful effects one after another", improve}};
  for (const EmpiricalPredictor& variable : diagnosis.unexplained.variables) {
    if (variable.formula.empty()) continue;
    return {{fmt::format("To test a formula of {} on held-out data", variable.name),
             fmt::format("{} improve {} -m {} --trace-variables -o {}", program(), flights, model, best)}};
  }
  return {{"To test a smooth surface on held-out data", improve}};
}

void print(const Diagnosis& diagnosis, const ModelDefinition& model, const ChosenReferences& references,
           const DiagnoseArguments& options) {
  print_formatted("{}: {}.\n", to_string(diagnosis.verdict), verdict_text(diagnosis));
  const bool in_full = is_verbose() || options.full;
  if (in_full) {
    print_formatted("\n");
    print_references(references);
    print_formatted("reference: {}\n", diagnosis.reference);
    print_formatted("used {} samples; not used: {}\n", diagnosis.samples, mask_text(diagnosis.masks));
  } else {
    print_short(diagnosis);
  }
  print_formatted("rms {:.3f} hPa; noise {:.3f} hPa", diagnosis.rms_given, diagnosis.noise_rms);
  if (diagnosis.is_refitted) {
    print_formatted("; rms {:.3f} hPa after a linear refit of the free coefficients", diagnosis.residual_rms);
  }
  print_formatted("\n");
  if (in_full) {
    print_flaps_out(diagnosis.flaps_out, "the diagnosis");
    print_findings(diagnosis.findings);
    print_unexplained(diagnosis.unexplained);
    print_others(diagnosis, options.full);
  }
  print_notes(diagnosis.notes);
  print_written_files({options.common.report, options.common.json});
  print_next_steps(next_steps(diagnosis, model, options));
}

/// @throws Error if no flight has a variable of --not-variable
void require_variables(const std::vector<std::string>& names, const FlightSet& flights) {
  if (names.empty()) return;
  const std::vector<std::string> known = variables_of_any(flights);
  for (const std::string& name : names) {
    if (std::find(known.begin(), known.end(), name) != known.end()) continue;
    const std::string meant = did_you_mean(name, known);
    throw Error(Error::Code::variable, fmt::format("--not-variable {}: no flight has this variable; {}", name,
                                                   meant.empty() ? "correct the name" : meant));
  }
}

void run(const DiagnoseArguments& options) {
  prepare_outputs(options.common, {}, inputs_of(options));
  JsonResult json(options.common);
  const FlightSet flights = CommandFlights(options.comparison).flights;
  require_variables(options.not_variables, flights);
  const ModelDefinition model =
      with_fit_options(read_model_for(options.model, flights, options.common), options.fit);
  const ChosenReferences references = references_to_fit(options.comparison, model, flights);
  DiagnoseOptions diagnose_with;
  diagnose_with.mask = mask_options(options.comparison);
  if (options.common.report.empty()) diagnose_with.series_of.emplace();
  diagnose_with.formulas = candidate_formulas(options.candidates, model, flights);
  diagnose_with.whole_file = !options.no_file_variables;
  diagnose_with.not_variables = options.not_variables;
  diagnose_with.training_share = options.fit.training_share;
  diagnose_with.trust_reference = options.fit.trust_reference;
  Diagnosis diagnosis;
  WhatIf tried;
  {
    Progress bar("diagnosing", !options.common.quiet);
    diagnose_with.progress = [&bar](std::size_t done, std::size_t total) { bar.show(done, total); };
    diagnosis = diagnose(flights, model, references.used, diagnose_with);
    if (!options.common.report.empty()) {
      diagnose_with.series_of = diagnosis.flights_with_records();
      tried = what_if(flights, model, references.used, what_if_candidates(diagnosis, diagnose_with.formulas),
                      {diagnose_with, {}, true, diagnosis.refitted_coefficients});
      add_commands(tried, options.model, options.comparison.flights.front(),
                   command_line(options.comparison) + command_line(options.fit));
    }
  }
  if (!is_speaker()) return;
  OutputTransaction together;
  if (!options.common.report.empty())
    write_report_of_run(
        diagnosis_report(diagnosis, model, &tried),
        {{options.model}, options.comparison.flights, {}, next_steps(diagnosis, model, options)},
        options.common);
  json.write(diagnosis);
  together.appear();
  if (wants_text(options.common)) print(diagnosis, model, references, options);
}

}  // namespace

std::function<void()> add_diagnose(CLI::App& program) {
  auto options = std::make_shared<DiagnoseArguments>();
  CLI::App* command =
      program.add_subcommand("diagnose", "Find the physical effects that a fitted model lacks");
  add_comparison_options(*command, options->comparison);
  command->add_option("-m,--model", options->model, "the model, fitted to these flights by refit")
      ->required()
      ->type_name("MODEL.toml");
  add_candidate_options(*command, options->candidates);
  add_fit_options(*command, options->fit);
  add_list_option(*command, "--not-variable", options->not_variables,
                  "exclude a variable of the flights from the search for unexplained structure")
      ->type_name("NAME");
  command->add_flag("--no-file-variables", options->no_file_variables,
                    "do not search the variables of the flights for unexplained structure");
  command->add_flag("--trust-reference", options->fit.trust_reference,
                    "assume that the references are exact: do not test effects of the references");
  command
      ->add_option("--training-share", options->fit.training_share,
                   "use only this fraction of every flight, its first part")
      ->check(CLI::Range(0.01, 1.0))
      ->capture_default_str();
  const char* const full = "print the lists of effects that were not found in full";
  command->add_flag("--full", options->full, full);
  add_deprecated_alias(*command->add_flag("--all", options->full, full), "--full");
  add_common_options<Diagnosis>(*command, options->common);
  add_examples(*command, {"diagnose first.nc second.nc -m fitted.toml --report diagnose.html",
                          "diagnose first.nc -m fitted.toml --try 'k * (ENGTRQ - 50) / 100'"});
  return [options] { run(*options); };
}

}  // namespace pcor::tool

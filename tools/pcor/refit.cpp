#include <pcor/fit/refit.hpp>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <optional>
#include <string>

#include <pcor/base/error.hpp>
#include <pcor/fit/refit_report.hpp>
#include "communicator.hpp"
#include "comparison.hpp"
#include "fit_options.hpp"
#include "flight_table.hpp"
#include "model_name.hpp"
#include "model_selector.hpp"
#include "progress.hpp"
#include "report_origin.hpp"

namespace pcor::tool {
namespace {

struct RefitArguments {
  CommonOptions common;
  ComparisonOptions comparison;
  std::string model;
  std::string output;
  std::string reference_output;
  std::string table;
  FitOptions fit;
  std::vector<std::string> stages;
  double memory_mib = 512.0;
  bool prior = false;
  bool force = false;
};

/// The parts between commas, without blanks around them.
std::vector<std::string> parts_of(const std::string& text) {
  std::vector<std::string> parts;
  std::size_t from = 0;
  while (from <= text.size()) {
    const std::size_t to = std::min(text.find(',', from), text.size());
    const std::string part = text.substr(from, to - from);
    const std::size_t first = std::min(part.find_first_not_of(' '), part.size());
    parts.push_back(part.substr(first, part.find_last_not_of(' ') + 1 - first));
    from = to + 1;
  }
  return parts;
}

/// Parses a stage like "pitch manoeuvre, speed run: static-alpha".
FitStage parse_stage(const std::string& text) {
  const std::size_t colon = text.find(':');
  if (colon == std::string::npos) {
    throw Error(
        Error::Code::usage,
        fmt::format("--stage '{}': give regimes and parameters, e.g. 'pitch manoeuvre: static-alpha.a1'",
                    text));
  }
  FitStage stage;
  for (const std::string& name : parts_of(text.substr(0, colon)))
    stage.regimes.push_back(regime_of(name, "--stage"));
  stage.parameters = parts_of(text.substr(colon + 1));
  return stage;
}

RefitOptions refit_options(const RefitArguments& options, const FlightSet& holdout) {
  RefitOptions refit;
  refit.mask = mask_options(options.comparison);
  refit.loss = *loss_named(options.fit.loss);
  refit.fix = options.fit.fix;
  refit.free = options.fit.free;
  std::vector<std::string> stages = options.stages;
  std::sort(stages.begin(), stages.end());  // the last digits do not depend on their order
  for (const std::string& stage : stages) refit.stages.push_back(parse_stage(stage));
  refit.fit_reference = !options.reference_output.empty();
  refit.use_prior = options.prior;
  refit.trust_reference = options.fit.trust_reference;
  refit.training_share = options.fit.training_share;
  refit.holdout = holdout;
  return refit;
}

void print_flights(const std::vector<FlightFit>& flights, const char* noise) {
  print_formatted("\n{:<32} {:>8} {:>10} {:>10} {:>10} {:>10} {:>9}\n", "flight, hPa", "samples",
                  "rms before", "rms after", "bias after", "scatter", noise);
  for (const FlightFit& flight : flights) {
    print_formatted("{:<32} {:>8} {:>10.3f} {:>10.3f} {:>+10.3f} {:>10.3f} {:>9.3f}\n",
                    flight.flight + (flight.holdout ? " (held out)" : ""), flight.after.samples,
                    flight.before.rms, flight.after.rms, flight.after.bias, flight.after.scatter(),
                    flight.after.noise_rms);
  }
}

/// Prints the flights with each further reference.
void print_further(const std::vector<FlightFit>& further) {
  for (auto first = further.begin(); first != further.end();) {
    const auto end = std::find_if(
        first, further.end(), [&](const FlightFit& flight) { return flight.reference != first->reference; });
    print_formatted("\nreference {}", first->reference);
    const bool by_gps = first->reference == "wind" || first->reference == "height";
    print_flights({first, end}, by_gps ? "max noise" : "noise");
    first = end;
  }
}

bool is_of_surface(const RefitResult& result, const std::string& parameter) {
  const std::vector<ModelEffect>& effects = result.model.model.effects;
  return std::any_of(effects.begin(), effects.end(), [&parameter](const ModelEffect& effect) {
    return effect.is_surface() && parameter.rfind(effect.id + ".", 0) == 0;
  });
}

/// Coefficients except those of surfaces; without --verbose only the fitted ones, at most `max_rows`.
void print_coefficients(const RefitResult& result, std::size_t max_rows) {
  const auto number = [](double error) { return std::isnan(error) ? "" : fmt::format("{:.3g}", error); };
  const auto likelihood = [&result](const std::string& error) {
    return result.is_by_gps() ? fmt::format("{:>13} ", error) : "";
  };
  print_formatted("{:<36} {:>13} {:>13} {:>13} {}{:>13}  {}\n", "coefficient", "before", "after",
                  result.is_by_gps() ? "stated error" : "std. error", likelihood("likelihood"), "jackknife",
                  "unit");
  std::size_t rows = 0, omitted = 0;
  for (const FittedParameter& p : result.parameters) {
    if (is_of_surface(result, p.name) || (!is_verbose() && !p.fitted)) continue;
    if (++rows > max_rows) {
      ++omitted;
      continue;
    }
    const std::string error = !p.fitted                      ? "fixed"
                              : p.at_bound                   ? "bound"
                              : std::isnan(p.standard_error) ? "unknown"
                                                             : fmt::format("{:.3g}", p.standard_error);
    print_formatted("{:<36} {:>13.6g} {:>13.6g} {:>13} {}{:>13}  {}\n", p.name, p.start, p.value, error,
                    likelihood(number(p.noise_error)), number(p.jackknife_error),
                    p.unit.empty() ? "see formula" : p.unit);
  }
  if (omitted > 0) print_formatted("and {} more: add --verbose\n", omitted);
  for (const SurfaceFit& surface : result.surfaces) {
    print_formatted("{}: second differences of {:.2g}, {:.1f} degrees of freedom\n", surface.effect,
                    surface.roughness, surface.degrees_of_freedom);
  }
  if (result.defect_error > 0.0)
    print_formatted("standard error of delta-p over the flights, by all coefficients: {:.2f} hPa\n",
                    result.defect_error);
}

/// ", before 0.123"; empty for NaN, if samples have no residual with the coefficients of the file.
std::string before_text(double rms) { return std::isnan(rms) ? "" : fmt::format(", before {:.3f}", rms); }

/// Number of the outliers, and their use in the fit.
std::string outliers_text(const RefitResult& result, const RefitArguments& options) {
  const char* const use = result.outliers == 0                         ? ""
                          : result.is_by_gps()                         ? " down-weighted"
                          : loss_named(options.fit.loss) == Loss::none ? " with full weight"
                                                                       : " dropped or down-weighted";
  return fmt::format("{} outliers{}", result.outliers, use);
}

/// The residual and the fitted coefficients.
void print_short(const RefitResult& result, const RefitArguments& options) {
  constexpr std::size_t max_rows = 6;
  print_formatted("rms {:.3f} hPa{}; {} {:.3f} hPa; {} samples, {}\n", result.rms,
                  before_text(result.rms_before), result.noise_label(), result.noise_rms, result.samples,
                  outliers_text(result, options));
  print_fit_summary(result);
  print_coefficients(result, max_rows);
  for (const FlightFit& flight : result.flights) {
    if (flight.holdout)
      print_formatted("held out {}: rms {:.3f} hPa{}, bias {:+.3f}\n", flight.flight, flight.after.rms,
                      before_text(flight.before.rms), flight.after.bias);
  }
}

void print_result(const RefitResult& result, const ChosenReferences& references,
                  const RefitArguments& options) {
  print_fit_summary(result);
  print_references(references);
  print_formatted("{}\n", result.estimator);
  print_formatted("reference: {}\n", result.reference_text);
  print_formatted("fitted to {} samples; not used: {}\n", result.samples, mask_text(result.masks));
  print_flaps_out(result.flaps_out, "the fit");
  print_formatted("\n");
  print_coefficients(result, result.parameters.size());
  print_formatted("\nrms {:.3f} hPa{}; {} {:.3f} hPa; {}\n", result.rms, before_text(result.rms_before),
                  result.noise_label(), result.noise_rms, outliers_text(result, options));
  print_formatted(
      "rms of residual / static pressure {:.5f}; standard deviation by the median of absolute values {:.3f} "
      "hPa\n",
      result.rms_over_pressure, result.bulk_rms);
  print_formatted("R2 {:.4f}; condition number {:.0f}\n", result.r_squared, result.condition_number);
  if (result.autocorrelation_time > 1.0) {
    print_formatted(
        "effective sample size: {1:.0f} of {0} samples, because the noise is correlated and drifts; the "
        "standard errors include this\n",
        result.samples, static_cast<double>(result.samples) / result.autocorrelation_time);
  }
  if (result.omissions.size() > 1) {
    print_formatted("\n{:<36} {:>10} {:>10}\n", "effect removed, others refitted", "rms, hPa", "R2");
    for (const Omission& omission : result.omissions)
      print_formatted("{:<36} {:>10.3f} {:>10.4f}\n", omission.effect, omission.rms, omission.r_squared);
  }
  bool any = false;
  for (std::size_t a = 0; a < result.covariance_names.size(); ++a) {
    for (std::size_t b = 0; b < a; ++b) {
      const double r = result.covariance[a][b] / std::sqrt(result.covariance[a][a] * result.covariance[b][b]);
      if (!(std::abs(r) > 0.9) || is_of_surface(result, result.covariance_names[a]) ||
          is_of_surface(result, result.covariance_names[b]))
        continue;
      if (!any) print_formatted("\ncorrelations above 0.9\n");
      any = true;
      print_formatted("  {} and {}: {:+.3f}\n", result.covariance_names[b], result.covariance_names[a], r);
    }
  }
  print_flights(result.flights, result.noise_label());
  print_further(result.further);
}

std::vector<NextStep> next_steps(const RefitArguments& options) {
  ComparisonOptions fitted = options.comparison;
  if (!options.reference_output.empty()) {
    const std::string first = fitted.references.front();
    const std::string before = first.substr(first.find(':'));
    for (std::string& reference : fitted.references) {
      const std::size_t colon = reference.find(':');
      if (colon != std::string::npos && reference.substr(colon) == before)
        reference = reference.substr(0, colon) + ":" + options.reference_output;
    }
  }
  return {{"To find missing effects", fmt::format("{} diagnose {} -m {}", program(),
                                                  advised_command_line(fitted), shell_path(options.output))}};
}

/// Comparison of the model before and after the fit, for the report.
Comparison before_against_after(const RefitResult& result, const ModelDefinition& model,
                                const References& references, const FlightSet& flights,
                                const RefitArguments& options) {
  CompareOptions compare_options;
  compare_options.mask = mask_options(options.comparison);
  References fitted = references;
  for (std::shared_ptr<const Reference>& reference : fitted) {
    const ModelDefinition* const system = reference->model();
    if (result.reference && system != nullptr && system->variables == result.reference->variables)
      reference = reference->with_model(*result.reference);
  }
  Progress bar("comparing for the report", !options.common.quiet);
  compare_options.progress = [&bar](std::size_t done, std::size_t total) { bar.show(done, total); };
  const bool holds_out = !options.fit.holdout.empty() || options.fit.training_share < 1.0;
  const std::string part = holds_out ? ", fitted and held-out samples" : "";
  return compare(
      flights, {{"before the fit" + part, model, references}, {"after the fit" + part, result.model, fitted}},
      compare_options);
}

/// Row for each flight, with the coefficients fitted to it alone.
FlightTable flight_table(const RefitResult& all, const ModelDefinition& model, const References& references,
                         const FlightSet& flights, RefitOptions with, const RefitArguments& options) {
  std::vector<std::string> columns{"flight",         "held_out",       "reference",
                                   "samples",        "rms_before_hpa", "bias_after_hpa",
                                   "bias_error_hpa", "rms_after_hpa",  "noise_rms_hpa"};
  std::vector<std::string> fitted;
  for (const FittedParameter& parameter : all.parameters) {
    if (!parameter.fitted) continue;
    fitted.push_back(parameter.name);
    columns.push_back(parameter.name + " alone");
    columns.push_back(parameter.name + " alone, standard error");
  }
  Progress bar("fitting each flight alone", !options.common.quiet);
  with.progress = [&bar](std::size_t done, std::size_t total) { bar.show(done, total); };
  const auto found = refit_per_flight(flights, model, references, with);
  std::map<std::string, std::vector<FittedParameter>> alone;
  for (std::size_t i = 0; i < flights.size(); ++i) alone.emplace(flights.name(i), found[i]);
  FlightTable table(columns);
  for (const FlightFit& flight : all.flights) {
    std::vector<std::string> row{flight.flight,
                                 flight.holdout ? "yes" : "no",
                                 flight.reference,
                                 std::to_string(flight.after.samples),
                                 cell(flight.before.rms),
                                 cell(flight.after.bias),
                                 cell(flight.after.bias_error),
                                 cell(flight.after.rms),
                                 cell(flight.after.noise_rms)};
    for (const std::string& name : fitted) {
      const std::vector<FittedParameter>& parameters = alone[flight.flight];
      const auto parameter = std::find_if(parameters.begin(), parameters.end(),
                                          [&name](const FittedParameter& each) { return each.name == name; });
      const bool is_known = !flight.holdout && parameter != parameters.end();
      row.push_back(is_known ? cell(parameter->value) : "");
      row.push_back(is_known ? cell(parameter->standard_error) : "");
    }
    table.add(std::move(row));
  }
  return table;
}

/// Writes the fitted models. @throws Error, before any file is written, if they are refused.
void write_model_outputs(RefitResult& result, const std::vector<std::filesystem::path>& inputs,
                         const RefitArguments& options) {
  require_improvement(result.rejection_reason, options.force, result.model);
  write_model_output(result.model, options.output, inputs);
  if (!result.reference) return;
  require_improvement(result.rejection_reason, options.force, *result.reference);
  write_model_output(*result.reference, options.reference_output, inputs);
}

/// The first reference is also fitted.
void put_static_systems_first(std::vector<std::string>& references) {
  std::stable_partition(references.begin(), references.end(),
                        [](const std::string& each) { return each.rfind("static:", 0) == 0; });
}

void run(const RefitArguments& options) {
  std::vector<std::filesystem::path> inputs = input_files(options.comparison, {options.model});
  inputs.insert(inputs.end(), options.fit.holdout.begin(), options.fit.holdout.end());
  prepare_outputs(options.common, {options.output, options.reference_output, options.table}, inputs);
  JsonResult json(options.common);
  const CommandFlights of(options.comparison, options.fit.holdout,
                          static_cast<std::size_t>(options.memory_mib * 1048576.0));
  const FlightSet all = of.all();
  const ModelDefinition model = read_model_for(options.model, of.flights, options.common);
  const ChosenReferences references = references_to_fit(options.comparison, model, all);
  RefitOptions refit_with = refit_options(options, of.holdout);
  RefitResult result;
  {
    Progress bar("fitting", !options.common.quiet);
    refit_with.progress = [&bar](std::size_t done, std::size_t total) { bar.show(done, total); };
    result = refit(of.flights, model, references.used, refit_with);
  }
  const bool is_refused = !result.rejection_reason.empty() && !options.force;
  std::optional<Comparison> comparison;
  if (!options.common.report.empty())
    comparison = before_against_after(result, model, references.used, all, options);
  std::optional<FlightTable> table;
  if (!options.table.empty())
    table = flight_table(result, model, references.used, of.flights, refit_with, options);
  all.require_unchanged();
  if (!is_speaker()) return;
  OutputTransaction together;
  if (comparison) {
    write_report_of_run(refit_report(result, *comparison),
                        {is_refused ? std::vector{options.model} : std::vector{options.model, options.output},
                         options.comparison.flights, options.fit.holdout,
                         is_refused ? std::vector<NextStep>{} : next_steps(options)},
                        options.common);
  }
  if (table) table->write(options.table);
  json.write(result);
  if (!is_refused) write_model_outputs(result, inputs, options);
  together.appear();
  const bool with_text = wants_text(options.common, {options.output, options.reference_output});
  if (with_text) {
    if (is_verbose())
      print_result(result, references, options);
    else
      print_short(result, options);
    print_notes(with_warnings(result.warnings, result.notes),
                std::max<std::size_t>(3, result.warnings.size()));
    print_written_files({options.common.report, options.table, options.common.json});
  }
  if (is_refused) require_improvement(result.rejection_reason, options.force, result.model);
  if (!with_text) return;
  print_written_files({options.output, options.reference_output});
  print_next_steps(next_steps(options));
}

}  // namespace

std::function<void()> add_refit(CLI::App& program) {
  auto options = std::make_shared<RefitArguments>();
  CLI::App* command = program.add_subcommand("refit", "Fit the free coefficients of a model to measurements");
  add_comparison_options(*command, options->comparison);
  command->add_option("-m,--model", options->model, "the model to fit")->required()->type_name("MODEL.toml");
  command->add_option("-o,--output", options->output, "output model (written atomically); - for stdout")
      ->required()
      ->type_name("FITTED.toml");
  add_table_option(*command, options->table,
                   "write a row for each flight to FILE.csv: its residuals before and after, and the "
                   "coefficients fitted to it alone");
  command
      ->add_option("--refit-reference", options->reference_output,
                   "fit the model of the second static system as well, and write it to this file")
      ->type_name("OTHER.toml");
  add_fit_options(*command, options->fit);
  add_list_option(*command, "--stage", options->stages,
                  "fit these coefficients using only these regimes (one free offset per interval); stages "
                  "are iterated to convergence: 'pitch manoeuvre: static-alpha'")
      ->type_name("REGIMES: NAMES");
  add_training_options(*command, options->fit, "the fit");
  command->add_flag(
      "--prior", options->prior,
      "apply a Gaussian prior at the starting values, with the covariance in the model file, "
      "otherwise with the typical size of each effect, for a formula the value itself, as standard error");
  command
      ->add_option("--memory", options->memory_mib,
                   "MiB of samples kept in memory between passes over the flights; the rest is read again")
      ->check(is_amount())
      ->capture_default_str();
  add_force_option(*command, options->force);
  add_common_options<RefitResult>(*command, options->common);
  add_examples(
      *command,
      {"refit first.nc second.nc -m model.toml -o fitted.toml --report refit.html",
       "refit first.nc second.nc --holdout third.nc -m model.toml -o fitted.toml",
       "refit first.nc second.nc -m model.toml --stage 'pitch manoeuvre: static-alpha' -o staged.toml"});
  return [options] {
    if (!options->reference_output.empty()) put_static_systems_first(options->comparison.references);
    run(*options);
  };
}

}  // namespace pcor::tool

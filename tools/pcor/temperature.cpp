#include <pcor/temperature/temperature.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>

#include <pcor/base/error.hpp>
#include <pcor/base/format_estimate.hpp>
#include "communicator.hpp"
#include "comparison.hpp"
#include "model_name.hpp"
#include "model_selector.hpp"
#include "progress.hpp"
#include "report_origin.hpp"

namespace pcor::tool {
namespace {

struct TemperatureArguments {
  CommonOptions common;
  ComparisonOptions comparison;
  std::string model;
  std::string output;
  std::string degree = "auto";
  std::string slope = "fitted";
  double slope_size = TemperatureOptions{}.slope_size * 1e5;  // m per 100 km
  TemperatureOptions temperature;
  bool iterate = false;
};

TemperatureOptions temperature_options(const TemperatureArguments& options) {
  TemperatureOptions result = options.temperature;
  result.mask = mask_options(options.comparison);
  if (options.degree != "auto") result.degree = std::stoi(options.degree);
  result.slope = *isobar_slope_named(options.slope);
  result.slope_size = options.slope_size * 1e-5;
  return result;
}

void print_flights(const TemperatureResult& result) {
  print_formatted("{:<28} {:>8} {:>10} {:>9} {:>9} {:>11} {:>10}\n", "flight", "samples", "segments",
                  "coldest", "warmest", "rms before", "rms after");
  for (const FlightHeights& flight : result.flights) {
    if (!flight.excluded.empty()) {
      print_formatted("{:<28} skipped: {}\n", flight.flight, flight.excluded);
      continue;
    }
    print_formatted("{:<28} {:>8} {:>10} {:>7.1f} C {:>7.1f} C {:>9.2f} m {:>8.2f} m\n", flight.flight,
                    flight.samples, flight.segments, flight.min_temperature, flight.max_temperature,
                    flight.rms_before, flight.rms_after);
  }
}

void print_parts(const TemperatureResult& result) {
  print_formatted("\n{:<28} {:>11} {:>20} {:>12}\n", "part", "temperature", "alone", "all flights");
  for (const std::vector<PartCorrection>* parts : result.parts()) {
    for (const PartCorrection& part : *parts)
      print_formatted("{:<28} {:>9.1f} C {:>18} K {:>+10.3f} K\n", part.part, part.temperature,
                      format_estimate(part.correction, part.standard_error), part.common);
  }
}

void print_law_errors(const TemperatureResult& result) {
  for (const LawError& error : result.law_errors)
    print_formatted(
        "According to the heights, delta-p lacks {} in {} of {}, a range of {:.2f} hPa over the flights; the "
        "error was subtracted.\n",
        format_estimate(error.change, error.standard_error), error.parameter, error.effect, error.range);
  if (result.humidity_change != 0.0)
    print_formatted("The heights change the vapour pressure by {} of its value.\n",
                    format_estimate(result.humidity_change, result.humidity_error));
}

void print_coefficients(const TemperatureResult& result) {
  print_formatted("T corrected = T + a0 + a1 t + ..., t in degC\n");
  print_formatted("{:<4} {:>12} {:>22} {:>27} {:>5}\n", "", "likelihood",
                  result.pressure_error > 0.0 ? "std. error" : "std. error, noise only",
                  "least squares on height", "unit");
  for (std::size_t k = 0; k < result.likelihood.coefficients.size(); ++k) {
    print_formatted("a{:<3} {:>+12.5g} {:>22.2g} {:>27} {:>5}\n", k, result.likelihood.coefficients[k],
                    result.likelihood.standard_errors[k],
                    fmt::format("{:+.4g} +- {:.2g}", result.least_squares.coefficients[k],
                                result.least_squares.standard_errors[k]),
                    coefficient_unit(k));
  }
}

void print_corrections(const TemperatureResult& result) {
  print_formatted("{:>12} {:>22}\n", "temperature", "correction");
  for (const TemperatureCorrection& at : result.corrections)
    print_formatted("{:>10.1f} C {:>20} K\n", at.temperature,
                    format_estimate(at.correction, at.standard_error));
}

void print_in_full(const TemperatureResult& result) {
  print_flights(result);
  print_formatted("\n");
  print_coefficients(result);
  print_formatted("Least squares assumes independent heights: its standard errors are too small.\n{}.\n",
                  pressure_error_text(result));
  print_law_errors(result);
  print_formatted("Least squares gives {} K, after subtraction of errors of the model.\n",
                  format_estimate(result.least_squares_add, result.least_squares_add_error));
  print_formatted("\n");
  print_corrections(result);
  print_parts(result);
  print_formatted(
      "\nnoise of the GPS height: {:.2f} m per sample, {:.2f} m correlated over {:.0f} s; the hydrostatic "
      "height drifts by {:.3f} m per minute\n",
      result.gps_noise, result.gps_wander, result.gps_wander_time, result.drift);
  print_formatted("\n{:<12} {:>16} {:>26}\n", "-2 ln L", "all flights", "held-out flights");
  for (const DegreeChoice& choice : result.degrees)
    print_formatted("{:<12} {:>16.1f} {:>26}\n", degree_name(choice.degree), choice.deviance,
                    std::isnan(choice.held_out)
                        ? "-"
                        : fmt::format("{:.1f} +- {:.1f}", choice.held_out, choice.held_out_error));
}

void print(const TemperatureResult& result) {
  if (is_verbose()) {
    print_in_full(result);
  } else {
    print_corrections(result);
    for (const FlightHeights& flight : result.flights) {
      if (!flight.excluded.empty()) print_formatted("{}: skipped: {}\n", flight.flight, flight.excluded);
    }
  }
  print_notes(with_warnings(result.warnings, result.notes), std::max<std::size_t>(3, result.warnings.size()));
}

void print(const IterativeCalibration& result) {
  print_formatted("{:<6} {:>10} {:>22} {:>24}  {}\n", "round", "rms, hPa", "change of delta-p, hPa",
                  "change of temperature, K", "coefficients");
  for (std::size_t i = 0; i < result.rounds.size(); ++i) {
    const CalibrationRound& round = result.rounds[i];
    std::string coefficients;
    for (const double a : round.coefficients) coefficients += fmt::format("{:+.5g} ", a);
    print_formatted("{:<6} {:>10.4f} {:>22.4f} {:>24.4f}  {}\n", i + 1, round.rms_hpa, round.defect_change,
                    round.temperature_change, coefficients);
  }
  print_formatted("{}\n\n", result.converged ? "pressure and temperature have converged"
                                             : "not converged: use the result with care");
}

/// Used flights, as named by the user.
std::vector<std::string> used_flights(const TemperatureResult& result, const TemperatureArguments& options) {
  std::vector<std::string> used;
  for (std::size_t i = 0; i < options.comparison.flights.size(); ++i) {
    if (result.flights.at(i).excluded.empty()) used.push_back(options.comparison.flights[i]);
  }
  return used;
}

std::vector<NextStep> next_steps(const TemperatureResult& result, const TemperatureArguments& options) {
  const auto process = [&](const std::string& model) {
    return process_command(used_flights(result, options), result.model, model,
                           options.comparison.timestamp_alignment);
  };
  if (result.rejection_reason.empty() && result.is_implausible()) {
    ComparisonOptions flights = options.comparison;
    flights.references.clear();
    return {{"To find the cause of the large correction",
             fmt::format("{} check {} -m {}", program(), advised_command_line(flights),
                         model_argument(options.model))}};
  }
  if (result.rejection_reason.empty()) return {{"To apply it", process(options.output)}};
  return {
      {"Flights that climb and descend by 3 km and more, there and back along the same track, determine "
       "the correction better. To apply the input model",
       process(options.model)}};
}

void run(const TemperatureArguments& options) {
  const std::vector<std::filesystem::path> inputs = input_files(options.comparison, {options.model});
  prepare_outputs(options.common, {options.output}, inputs);
  if (options.iterate && options.temperature.archived)
    throw Error(Error::Code::usage,
                "--iterate refits the pressures and requires flights as recorded; remove --archived");
  if (!options.iterate && !options.comparison.references.empty())
    throw Error(Error::Code::usage, "--reference gives the references of --iterate; give both or neither");
  JsonResult json(options.common);
  const FlightSet flights = CommandFlights(options.comparison).flights;
  const ModelDefinition model = read_model_for(options.model, flights, options.common);
  TemperatureOptions with = temperature_options(options);
  IterativeCalibration in_turn;
  TemperatureResult& result = in_turn.temperature;
  {
    Progress bar(options.iterate ? "fitting and calibrating iteratively" : "reading", !options.common.quiet);
    with.progress = [&bar](std::size_t done, std::size_t total) { bar.show(done, total); };
    if (options.iterate) {
      RefitOptions refit_with;
      refit_with.mask = with.mask;
      refit_with.progress = with.progress;
      const References references = references_to_fit(options.comparison, model, flights).used;
      in_turn = calibrate_iteratively(flights, model, references, refit_with, with);
    } else {
      result = fit_temperature(flights, model, with);
    }
  }
  if (!is_speaker()) return;
  const bool is_refused = !result.rejection_reason.empty() && !with.dry_air;
  OutputTransaction together;
  if (!options.common.report.empty())
    write_report_of_run(temperature_report(result),
                        {is_refused ? std::vector{options.model} : std::vector{options.model, options.output},
                         options.comparison.flights,
                         {},
                         next_steps(result, options)},
                        options.common);
  json.write(in_turn);
  if (!is_refused) {
    require_improvement(result.rejection_reason, with.dry_air, result.model);
    write_model_output(result.model, options.output, inputs);
  }
  together.appear();
  const bool with_text = wants_text(options.common, {options.output});
  if (with_text) {
    if (options.iterate) print(in_turn);
    print(result);
    print_written_files({options.common.report, options.common.json});
  }
  if (is_refused) require_improvement(result.rejection_reason, with.dry_air, result.model);
  if (!with_text) return;
  print_written_files({options.output});
  if (!result.rejection_reason.empty()) print_formatted("Not recommended: {}.\n", result.rejection_reason);
  print_next_steps(next_steps(result, options));
}

}  // namespace

std::function<void()> add_temperature(CLI::App& program) {
  auto options = std::make_shared<TemperatureArguments>();
  CLI::App* command = program.add_subcommand(
      "temperature", "Calibrate the temperature by GPS heights and the hydrostatic equation");
  add_comparison_options(*command, options->comparison);
  command->add_option("-m,--model", options->model, "the model whose pressures and thermometer are used")
      ->required()
      ->type_name("MODEL.toml");
  command
      ->add_option("-o,--output", options->output,
                   "output model with the correction (written atomically); - for stdout")
      ->required()
      ->type_name("FITTED.toml");
  command->add_option("--degree", options->degree, "highest power of the temperature in the correction")
      ->check(CLI::IsMember({"auto", "0", "1", "2"}))
      ->capture_default_str();
  command->add_option("--slope", options->slope, "treatment of the slope of isobars")
      ->check(CLI::IsMember({"fitted", "none", "level-legs", "climb-descent", "whole-flight"}))
      ->capture_default_str();
  command
      ->add_option("--slope-size", options->slope_size,
                   "prior standard deviation of the slope of isobars, m per 100 km; the other choices of "
                   "--slope use a third of it")
      ->check(is_amount())
      ->capture_default_str();
  command
      ->add_option("--pressure-error", options->temperature.pressure_error,
                   "standard deviation of constant errors of the static pressure, hPa, one the same at all "
                   "pressures and one proportional to the pressure; part of the standard errors (default: "
                   "0.1 for the transducer; for the model its stated value, otherwise 0.3)")
      ->check(is_amount());
  command
      ->add_option("--min-climb-rate", options->temperature.min_climb_rate,
                   "exclude climbs and descents below this rate, m/s")
      ->check(is_amount())
      ->capture_default_str();
  command->add_flag("--skip-returning", options->temperature.skip_returning,
                    "skip flights that end where they began");
  command->add_flag(
      "--archived", options->temperature.archived,
      "the flights were written by 'pcor process --hydrostatic': start from their HYDSTEP and ATX");
  command->add_flag("--iterate", options->iterate,
                    "refit the pressures and calibrate the temperature alternately to convergence");
  CLI::Option* const reference = command->get_option("--reference");
  reference->description(reference->get_description() + "; with --iterate only");
  add_force_option(*command, options->temperature.dry_air);
  add_common_options<IterativeCalibration>(*command, options->common);
  add_examples(*command,
               {"temperature climbs.nc -m data/scenarios/models/c130-psfd-eq18.toml -o calibrated.toml"});
  return [options] { run(*options); };
}

}  // namespace pcor::tool

#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <pcor/campaign/chosen_references.hpp>
#include <pcor/compare/compare.hpp>
#include <pcor/fit/refit.hpp>
#include "command.hpp"

namespace pcor::tool {

/// Options of every sub-command that compares a model with measurements.
struct ComparisonOptions {
  std::vector<std::string> flights{};
  std::vector<std::string> references{};
  std::vector<std::string> exclude{};
  std::string intervals{};
  double min_airspeed = MaskOptions{}.min_airspeed;
  std::optional<double> max_flaps{};
  TimestampAlignment timestamp_alignment = TimestampAlignment::begin;
  bool skip_unreadable = false;  ///< flights that cannot be opened are removed from `flights`
};

/// Validator: a finite number, zero or more.
CLI::Validator is_amount();

void add_comparison_options(CLI::App& command, ComparisonOptions& options);

/// Adds the option --time-stamp.
void add_time_stamp_option(CLI::App& command, TimestampAlignment& alignment);

/// Adds the options of `add_comparison_options` without the reference: flights, and selection of samples.
void add_flight_options(CLI::App& command, ComparisonOptions& options);

/// Regime called `name` in the option `option`. @throws Error with the known names.
Regime regime_of(const std::string& name, const std::string& option);

/// @throws Error if a regime is unknown or the file of intervals cannot be read.
MaskOptions mask_options(const ComparisonOptions& options);

/// Flights of a command, opened once: fitted or compared flights, and held-out flights.
struct CommandFlights {
  FlightSet flights{};
  FlightSet holdout{};

  /// @param memory as `FlightSetOptions::memory`
  CommandFlights(const ComparisonOptions& options, const std::vector<std::string>& held_out = {},
                 std::size_t memory = FlightSetOptions{}.memory);

  FlightSet all() const { return flights.with(holdout); }
};

/// Files that the options read, and others, for `refuse_overwriting`.
std::vector<std::filesystem::path> input_files(const ComparisonOptions& options,
                                               const std::vector<std::string>& others);

/// Options as on a command line, for the suggested next commands.
std::string command_line(const ComparisonOptions& options);

/// Options as on a command line, for suggested commands: many flights are shortened to the first and the
/// last.
std::string advised_command_line(const ComparisonOptions& options);

/// Output file in advice: `name`, with a number before its extension if an input has that name: "best2.toml".
std::string output_file(const std::string& name, const std::vector<std::filesystem::path>& inputs);

/// Advised command that corrects the flights by the model in the file `path`, several flights into a folder.
/// It has a suffix if the command would otherwise give a result the name of an input.
std::string process_command(const std::vector<std::string>& flights, const ModelDefinition& model,
                            const std::string& path, TimestampAlignment alignment);

std::vector<std::filesystem::path> flight_paths(const ComparisonOptions& options);

/// References of a fit: the references given by the options, otherwise LAMS and the total pressure of a
/// second pair. The uncertainty of the others, due to changing winds and sloping isobars, is not known well
/// enough to use them by default: a height error of one thousandth, and moving air, appear in a diagnosis as
/// a few tenths of a kelvin at the thermometer.
/// @param flights the held-out flights must allow the references as well
ChosenReferences references_to_fit(const ComparisonOptions& options, const ModelDefinition& model,
                                   const FlightSet& flights);

/// Prints the used and unused references of a model, if there are several.
void print_references(const ChosenReferences& references);

/// Prints the residual with flaps out, on a separate line; prints no line if there are no such samples.
void print_flaps_out(const Statistics& flaps_out, const std::string& of_what);

/// Prints a significant bias of held-out parts first, then the model error and the drift of the noise.
void print_fit_summary(const RefitResult& fit);

}  // namespace pcor::tool

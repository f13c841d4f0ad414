#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <pcor/campaign/chosen_references.hpp>
#include <pcor/compare/compare.hpp>
#include "command.hpp"

namespace pcor::tool {

/// The options of every sub-command that holds a model against measurements.
struct ComparisonOptions {
  std::vector<std::string> flights{};
  std::vector<std::string> references{};
  std::vector<std::string> exclude{};
  std::string intervals{};
  double min_airspeed = MaskOptions{}.min_airspeed;
  std::optional<double> max_flaps{};
  std::string timestamp_alignment = "begin";
  bool skip_unreadable = false;  ///< flights that cannot be opened are taken from `flights`
};

/// A check of an option: a finite number, zero or more.
CLI::Validator is_amount();

void add_comparison_options(CLI::App& command, ComparisonOptions& options);

/// As `add_comparison_options`, without the reference: flights, and which samples take part.
void add_flight_options(CLI::App& command, ComparisonOptions& options);

/// The regime called `name` on the option `option`. @throws Error with the names that there are.
Regime regime_of(const std::string& name, const std::string& option);

/// @throws Error if a regime has no such name or the file of intervals cannot be read.
MaskOptions mask_options(const ComparisonOptions& options);

/// The flights of a command, opened once for all that it does: those that are fitted or compared, and those
/// that are held out.
struct CommandFlights {
  FlightSet flights{};
  FlightSet holdout{};

  /// @param memory as `FlightSetOptions::memory`
  CommandFlights(const ComparisonOptions& options, const std::vector<std::string>& held_out = {},
                 std::size_t memory = FlightSetOptions{}.memory);

  FlightSet all() const { return flights.with(holdout); }
};

/// The files that the options read, for `refuse_overwriting`.
std::vector<std::filesystem::path> input_files(const ComparisonOptions& options);

/// The options as they stand on a command line, for the commands that a user is advised to run next.
std::string command_line(const ComparisonOptions& options);

/// The same for the commands that are advised: of more flights than anyone reads the first and the last.
std::string advised_command_line(const ComparisonOptions& options);

std::vector<std::filesystem::path> flight_paths(const ComparisonOptions& options);

/// What a model is fitted to: the references that the options name, else LAMS and the total pressure of a
/// second pair. What the others leave to their noise, winds that change and slopes of surfaces of one
/// pressure, is not known well enough to be taken unasked: heights that are off by a thousandth, and air that
/// is not at rest, look to a diagnosis like some tenths of a kelvin at the thermometer.
/// @param flights those that are held out, too, must allow the references
ChosenReferences references_to_fit(const ComparisonOptions& options, const ModelDefinition& model,
                                   const FlightSet& flights);

/// Prints which references a model is held against and which not, where there are several to tell of.
void print_references(const ChosenReferences& references);

nlohmann::ordered_json as_json(const Statistics& statistics);

/// Prints what the residual is where flaps are out, on a line of its own; nothing where none are.
void print_flaps_out(const Statistics& flaps_out, const std::string& of_what);
nlohmann::ordered_json masks_as_json(const std::array<std::size_t, mask_count>& masks);

}  // namespace pcor::tool

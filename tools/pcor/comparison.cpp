#include "comparison.hpp"

#include <algorithm>
#include <array>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <charconv>
#include <cmath>
#include <system_error>
#include <utility>

#include <pcor/base/error.hpp>
#include <pcor/base/suggest.hpp>
#include <pcor/flight/readable_flights.hpp>
#include <pcor/model/formula.hpp>
#include <pcor/realtime/chain.hpp>
#include "communicator.hpp"
#include "model_name.hpp"

namespace pcor::tool {

CLI::Validator is_amount() {
  const auto check = [](const std::string& text) -> std::string {
    double value = -1.0;
    const char* const end = text.data() + text.size();
    const auto [rest, status] = std::from_chars(text.data(), end, value);
    const bool number = status == std::errc{} && rest == end && std::isfinite(value);
    return number && value >= 0.0 ? "" : text + " is not a number of zero or more";
  };
  return {check, "NUMBER"};
}

void add_comparison_options(CLI::App& command, ComparisonOptions& options) {
  add_flight_options(command, options);
  add_list_option(
      command, "--reference", options.references,
      "measurement compared with the model: " + reference_forms() +
          "; default: lams and, if recorded, total (the command compare adds height and wind); a flight "
          "without laser needs this option")
      ->type_name("REFERENCE");
}

namespace {

/// Removes the flights that cannot be opened, and reports them. @throws Error if no flights remain.
void leave_out_unreadable(std::vector<std::string>& flights) {
  const std::vector<std::string> reasons = reasons_unreadable({flights.begin(), flights.end()}, comm());
  std::vector<std::string> readable;
  for (std::size_t i = 0; i < flights.size(); ++i) {
    if (reasons[i].empty()) {
      readable.push_back(flights[i]);
    } else {
      tell_choices({Note(fmt::format("skipped: {}", reasons[i]))}, false);
    }
  }
  if (readable.empty())
    throw Error(Error::Code::file,
                fmt::format("all {} flights are unreadable; check the files", flights.size()));
  flights = std::move(readable);
}

}  // namespace

void add_flight_options(CLI::App& command, ComparisonOptions& options) {
  command.add_option("FLIGHT.nc", options.flights, "the flights, netCDF or ICARTT files")
      ->required()
      ->type_name("");
  add_list_option(command, "--exclude", options.exclude, "exclude a flight regime, e.g. turn or cloud")
      ->type_name("REGIME");
  command
      .add_option("--intervals", options.intervals,
                  "flight regimes to add or to remove, and times to exclude; format: docs/intervals.md")
      ->type_name("FILE.toml");
  command.add_option("--min-airspeed", options.min_airspeed, "exclude samples below this airspeed, m/s")
      ->check(is_amount())
      ->capture_default_str();
  command
      .add_option("--max-flaps", options.max_flaps,
                  "exclude samples with flaps above N percent (default 5; no limit if an effect of the model "
                  "uses the flaps)")
      ->check(is_amount());
  add_time_stamp_option(command, options.timestamp_alignment);
  command.add_flag("--skip-unreadable", options.skip_unreadable,
                   "skip files that are damaged or not flights, with a warning");
  command.parse_complete_callback([&options] {
    options.references = in_order(options.references);
    if (options.skip_unreadable) leave_out_unreadable(options.flights);
  });
}

void add_time_stamp_option(CLI::App& command, TimestampAlignment& alignment) {
  const auto set = [&alignment](const std::string& name) {
    alignment = name == "middle" ? TimestampAlignment::middle : TimestampAlignment::begin;
  };
  command
      .add_option_function<std::string>("--time-stamp", set,
                                        "position of the time of a record in its averaging interval")
      ->check(CLI::IsMember({"begin", "middle"}))
      ->default_str("begin");
}

Regime regime_of(const std::string& name, const std::string& option) {
  const Regime regime = regime_named(name);
  if (regime != Regime::count) return regime;
  std::vector<std::string> known;
  for (const RegimeInfo& info : regime_info) known.emplace_back(info.name);
  const std::string meant = did_you_mean(name, known);
  throw Error(Error::Code::usage,
              fmt::format("{} '{}': unknown regime; {}", option, name,
                          meant.empty() ? fmt::format("the regimes are {}", fmt::join(known, ", ")) : meant));
}

MaskOptions mask_options(const ComparisonOptions& options) {
  MaskOptions mask;
  mask.min_airspeed = options.min_airspeed;
  mask.max_flaps = options.max_flaps;
  for (const std::string& name : options.exclude) mask.exclude.push_back(regime_of(name, "--exclude"));
  if (!options.intervals.empty()) mask.intervals = read_intervals(options.intervals);
  return mask;
}

CommandFlights::CommandFlights(const ComparisonOptions& options, const std::vector<std::string>& held_out,
                               std::size_t memory) {
  std::vector<std::filesystem::path> paths = flight_paths(options);
  paths.insert(paths.end(), held_out.begin(), held_out.end());
  const FlightSet all(paths, {options.timestamp_alignment, &comm(), memory});
  flights = all.part(0, options.flights.size());
  holdout = all.part(options.flights.size(), held_out.size());
}

std::vector<std::filesystem::path> flight_paths(const ComparisonOptions& options) {
  return {options.flights.begin(), options.flights.end()};
}

namespace {

std::string with_options(std::string line, const ComparisonOptions& options) {
  for (const std::string& reference : options.references)
    line += "--reference " + reference_argument(reference) + " ";
  for (const std::string& regime : options.exclude) line += "--exclude " + shell_quote(regime) + " ";
  if (!options.intervals.empty()) line += "--intervals " + shell_path(options.intervals) + " ";
  if (options.min_airspeed != MaskOptions{}.min_airspeed)
    line += fmt::format("--min-airspeed {} ", options.min_airspeed);
  if (options.max_flaps) line += fmt::format("--max-flaps {} ", *options.max_flaps);
  if (options.timestamp_alignment == TimestampAlignment::middle) line += "--time-stamp middle ";
  line.pop_back();
  return line;
}

std::string all_flights(const std::vector<std::string>& flights) {
  std::string words;
  for (const std::string& flight : flights) words += shell_path(flight) + " ";
  return words;
}

/// Many flights are shortened to the first and the last.
std::string advised_flights(const std::vector<std::string>& flights) {
  constexpr std::size_t max_to_read = 16;
  return flights.size() <= max_to_read
             ? all_flights(flights)
             : shell_path(flights.front()) + " ... " + shell_path(flights.back()) + " ";
}

}  // namespace

std::vector<std::filesystem::path> input_files(const ComparisonOptions& options,
                                               const std::vector<std::string>& others) {
  std::vector<std::filesystem::path> files = flight_paths(options);
  for (const std::string& reference : options.references) {
    for (const std::string prefix : {"static:", "total:"}) {
      if (reference.compare(0, prefix.size(), prefix) == 0)
        files.emplace_back(reference.substr(prefix.size()));
    }
  }
  files.emplace_back(options.intervals);
  files.insert(files.end(), others.begin(), others.end());
  return files;
}

std::string command_line(const ComparisonOptions& options) {
  return with_options(all_flights(options.flights), options);
}

std::string output_file(const std::string& name, const std::vector<std::filesystem::path>& inputs) {
  const std::filesystem::path first(name);
  std::string output = name;
  const auto is_output = [&output](const std::filesystem::path& input) { return input.filename() == output; };
  for (int number = 2; std::any_of(inputs.begin(), inputs.end(), is_output); ++number)
    output = fmt::format("{}{}{}", first.stem().string(), number, first.extension().string());
  return output;
}

namespace {

/// Whether `process` reads a role. Other roles of the model serve comparisons, such as the true airspeed.
bool is_processed(const std::optional<Chain>& chain, Quantity role) {
  return !chain || chain->needs(role) || is_always_read(role);
}

/// Variables that `process` reads with a model, and names in its formulas.
std::vector<std::string> names_read_by(const ModelDefinition& model) {
  std::vector<std::string> names;
  const std::optional<Chain> chain = Chain::build(model.model, model.roles(), nullptr);
  for (const auto& [role, variable] : model.variables) {
    if (is_processed(chain, role)) names.push_back(variable);
  }
  for (const ModelEffect& effect : model.model.effects) {
    if (!effect.is_formula()) continue;
    const auto formula = Formula::parse(effect.formula, effect.parameter_names);
    if (formula) names.insert(names.end(), formula->variables().begin(), formula->variables().end());
  }
  return names;
}

/// Whether a result of `process` has the name of a variable that the model reads.
bool reads_results(const ModelDefinition& model) {
  constexpr std::array<const char*, 7> results{"PCOR", "PSXC", "QCXC", "MACHX", "ATX", "TASX", "PCORFLAG"};
  const std::vector<std::string> names = names_read_by(model);
  return std::any_of(results.begin(), results.end(), [&](const char* result) {
    return std::find(names.begin(), names.end(), model.output_name(result)) != names.end();
  });
}

}  // namespace

std::string process_command(const std::vector<std::string>& flights, const ModelDefinition& model,
                            const std::string& path, TimestampAlignment alignment) {
  return fmt::format("{} process {}-m {}{}{} -o {}", program(), advised_flights(flights),
                     model_argument(path),
                     alignment == TimestampAlignment::middle ? " --time-stamp middle" : "",
                     reads_results(model) ? " --suffix _NEW" : "",
                     flights.size() == 1 ? output_file("corrected.nc", {flights.front()}) : "corrected");
}

std::string advised_command_line(const ComparisonOptions& options) {
  return with_options(advised_flights(options.flights), options);
}

ChosenReferences references_to_fit(const ComparisonOptions& options, const ModelDefinition& model,
                                   const FlightSet& flights) {
  ChosenReferences chosen = read_references(options.references, model, flights);
  if (!options.references.empty()) return chosen;
  const auto held_together = std::stable_partition(chosen.used.begin(), chosen.used.end(),
                                                   [](const auto& each) { return each->is_of_one_sample(); });
  for (auto each = held_together; each != chosen.used.end(); ++each) {
    chosen.not_used.push_back(
        fmt::format("{}: compare shows it, and refit, diagnose and improve use it if --reference names it",
                    (*each)->name()));
  }
  chosen.used.erase(held_together, chosen.used.end());
  return chosen;
}

void print_references(const ChosenReferences& references) {
  std::vector<std::string> names;
  for (const auto& reference : references.used) names.push_back(reference->name());
  if (names.size() > 1) print_formatted("references: {}\n", fmt::join(names, ", "));
  for (const std::string& why_not : references.not_used)
    print_formatted("not used as a reference: {}\n", why_not);
}

void print_flaps_out(const Statistics& flaps_out, const std::string& of_what) {
  if (flaps_out.samples > 0) print_formatted("{}\n", flaps_out_text(flaps_out, of_what));
}

void print_fit_summary(const RefitResult& fit) {
  const std::optional<HeldOutPart> held_out = worst_held_out(fit.flights);
  if (held_out && held_out->is_off()) print_formatted("Warning: {}.\n", held_out->text());
  if (fit.misfit_rms > 0.0)
    print_formatted(
        "Model error varying with the flight state: {:.2f} hPa (rms); slow drift of the noise: {:.2f} hPa.\n",
        fit.misfit_rms, fit.drift_rms);
  if (fit.between_flights > 0.0)
    print_formatted("Standard deviation between flights of the mean residual: {:.2f} hPa.\n",
                    fit.between_flights);
}

}  // namespace pcor::tool

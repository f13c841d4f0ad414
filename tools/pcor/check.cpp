#include <pcor/checks/check.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <pcor/model_io/model_definition.hpp>
#include "communicator.hpp"
#include "comparison.hpp"
#include "flight_table.hpp"
#include "model_name.hpp"
#include "model_selector.hpp"
#include "progress.hpp"
#include "report_origin.hpp"

namespace pcor::tool {
namespace {

struct CheckArguments {
  CommonOptions common;
  ComparisonOptions flights;
  std::string model;
  std::string reference;
  std::string table;
};

/// Prefix of the reference of a check; the model of the second system follows.
const std::string second_system = "static:";
/// Prefix of the total pressure of a pair of variables without a model: "total:PS_A+QC_A".
const std::string second_pair = "total:";

bool is_pair(const std::string& reference) {
  return reference.rfind(second_pair, 0) == 0 && reference.find('+') != std::string::npos;
}

/// Validator of the option that names a second static system.
CLI::Validator is_second_system() {
  const auto check = [](const std::string& reference) -> std::string {
    for (const std::string& form : {second_system, second_pair}) {
      if (reference.rfind(form, 0) == 0) return "";
    }
    return fmt::format(
        "'{}' is not a second system; omit --reference (check uses GPS and laser without it), or give "
        "static:OTHER.toml, total:OTHER.toml or total:STATIC+DYNAMIC",
        reference);
  };
  return {check, ""};
}

/// File of the second system's model; empty if not given.
std::string second_model(const CheckArguments& options) {
  if (options.reference.empty() || is_pair(options.reference)) return "";
  return options.reference.substr(options.reference.find(':') + 1);
}

std::vector<std::filesystem::path> inputs_of(const CheckArguments& options) {
  return input_files(options.flights, {options.model, second_model(options)});
}

ModelDefinition read_second(const CheckArguments& options) {
  const std::string& text = options.reference;
  return is_pair(text) ? *read_reference(text, {})->model() : read_model(second_model(options));
}

/// Text like "-0.154 +- 0.024 hPa, difference of the systems; tolerance 0.3", and why a verdict is withheld.
std::string key_number(const CheckResult& result) {
  const TestStatistic& key = result.key;
  return fmt::format("{:+.3f} +- {:.3f} {}, {}; tolerance {:g}{}{}", key.value, key.standard_error, key.unit,
                     key.what, key.tolerance, result.inconclusive_reason.empty() ? "" : "; ",
                     result.inconclusive_reason);
}

/// Prints the first rows of a table in columns, the first left-aligned and the others right-aligned.
void print(const ReportTable& table) {
  constexpr std::size_t max_rows = 20;
  const std::size_t rows = std::min(table.rows.size(), max_rows);
  std::vector<std::size_t> widths;
  for (std::size_t column = 0; column < table.headers.size(); ++column) {
    std::size_t width = table.headers[column].size();
    for (std::size_t row = 0; row < rows; ++row) width = std::max(width, table.rows[row][column].size());
    widths.push_back(width);
  }
  const auto print_row = [&widths](const std::vector<std::string>& cells) {
    print_formatted("    {:<{}}", cells[0], widths[0]);
    for (std::size_t column = 1; column < cells.size(); ++column)
      print_formatted("  {:>{}}", cells[column], widths[column]);
    print_formatted("\n");
  };
  print_row(table.headers);
  for (std::size_t row = 0; row < rows; ++row) print_row(table.rows[row]);
  if (rows < table.rows.size())
    print_formatted("    and {} more in --json and --report\n", table.rows.size() - rows);
}

/// CheckArguments as on a command line, for the suggested commands.
std::string command_line(const CheckArguments& options) {
  std::string line = advised_command_line(options.flights);
  if (!options.model.empty()) line += " -m " + model_argument(options.model);
  return line;
}

std::size_t count_of(const Checks& checks, CheckVerdict verdict) {
  return static_cast<std::size_t>(std::count_if(
      checks.results.begin(), checks.results.end(),
      [verdict](const CheckResult& result) { return result.was_run && result.verdict == verdict; }));
}

/// Suggested next step: first for a fault that a refit cannot correct, then for the temperature, then for the
/// model. Empty if none remains.
std::vector<NextStep> next_steps(const Checks& checks, const CheckArguments& options,
                                 const std::optional<ModelDefinition>& model) {
  const auto fails = [&](const std::string& name) {
    return std::any_of(checks.results.begin(), checks.results.end(), [&](const CheckResult& result) {
      return result.name == name && result.was_run && result.verdict == CheckVerdict::inconsistent;
    });
  };
  const std::string second =
      options.reference.empty() ? "" : " --reference " + reference_argument(options.reference);
  std::vector<NextStep> pictures;
  if (options.common.report.empty())
    pictures.push_back({"To see the pictures", fmt::format("{} check {}{} --report check.html", program(),
                                                           command_line(options), second)});
  if (fails("total-pressure")) {
    pictures.insert(pictures.begin(),
                    {"A transducer, a pitot or a line of one system is wrong. No term of the model can "
                     "correct it, because static defects cancel in the total pressure."});
    return pictures;
  }
  const std::size_t inconsistent = count_of(checks, CheckVerdict::inconsistent);
  const std::vector<std::filesystem::path> inputs = inputs_of(options);
  if (model && (fails("layers") || fails("lams-temperature"))) {
    return {{"To find the thermometer's error by the height",
             fmt::format("{} temperature {} -o {}", program(), command_line(options),
                         output_file("calibrated.toml", inputs))}};
  }
  const bool has_laser = model && model->variables.count(Quantity::lams_airspeed) > 0;
  // A total pressure does not determine the static defect.
  const bool has_second_system = options.reference.rfind(second_system, 0) == 0;
  if (inconsistent > 0 && model && (has_laser || has_second_system)) {
    return {{"To refit the model and find missing effects",
             fmt::format("{} improve {}{} -o {}", program(), command_line(options), has_laser ? "" : second,
                         output_file("improved.toml", inputs))}};
  }
  if (inconsistent == 0 && model && count_of(checks, CheckVerdict::consistent) > 0) {
    return {{"To apply the model", process_command(options.flights.flights, *model, options.model,
                                                   options.flights.timestamp_alignment)}};
  }
  return pictures;
}

void print_details(const Checks& checks) {
  print_formatted(
      "inconsistent: larger than the tolerance and than three standard errors; consistent: within the "
      "tolerance, by two standard errors\n");
  for (const CheckResult& result : checks.results) {
    print_formatted("\n{}: {}\n", result.name,
                    result.was_run ? result.finding : "not run: " + result.reason + ".");
    if (result.was_run) {
      print_formatted("  {}: {}.\n", to_string(result.verdict), result.explanation);
      print_formatted("  limitations: {}\n", result.limitations);
    }
    if (!result.tables.empty()) print(result.tables.front());
    for (const Note& note : result.notes) {
      // The first note of a check that was not run repeats its reason.
      if (result.was_run || result.reason.find(note.text) == std::string::npos)
        print_formatted("  note: {}.\n", format_note(note));
    }
  }
}

void print(const Checks& checks, const CheckArguments& options, const std::optional<ModelDefinition>& model) {
  std::vector<std::string> counts;
  const auto add_count = [&counts](std::size_t count, std::string_view what) {
    if (count > 0) counts.push_back(fmt::format("{} {}", count, what));
  };
  for (const CheckVerdict verdict :
       {CheckVerdict::inconsistent, CheckVerdict::consistent, CheckVerdict::inconclusive})
    add_count(count_of(checks, verdict), to_string(verdict));
  add_count(
      static_cast<std::size_t>(std::count_if(checks.results.begin(), checks.results.end(),
                                             [](const CheckResult& result) { return !result.was_run; })),
      "not run");
  print_formatted("{}{}{}\n", checks.model, checks.model.empty() ? "" : ": ", fmt::join(counts, ", "));
  print_formatted("{:<18} {:<14} {}\n", "check", "verdict", "number");
  std::vector<std::string> not_run;
  for (const CheckResult& result : checks.results) {
    if (result.was_run)
      print_formatted("{:<18} {:<14} {}\n", result.name, to_string(result.verdict), key_number(result));
    else
      not_run.push_back(result.name);
  }
  if (!not_run.empty()) print_formatted("not run: {}\n", fmt::join(not_run, ", "));
  if (is_verbose()) print_details(checks);
  print_notes(checks.notes);
  print_written_files({options.common.report, options.table, options.common.json});
  print_formatted("{}.\n", summary_of(checks));
  print_next_steps(next_steps(checks, options, model));
}

/// Row for each check of each flight, which is checked separately.
///
/// @param together the checks of all flights, which equal the checks of the flight if there is only one
FlightTable flight_table(const FlightSet& flights, const std::optional<ModelDefinition>& model,
                         const CheckOptions& how, const Checks& together) {
  FlightTable table(
      {"flight", "check", "verdict", "value", "standard_error", "unit", "what", "tolerance", "reason"});
  std::vector<std::vector<CheckResult>> alone{together.results};
  if (flights.size() > 1) alone = check_per_flight(flights, model, how);
  for (std::size_t i = 0; i < flights.size(); ++i) {
    const std::string name = flights.name(i);
    for (const CheckResult& result : alone[i]) {
      if (result.was_run) {
        const TestStatistic& key = result.key;
        table.add({name, result.name, std::string(to_string(result.verdict)), cell(key.value),
                   cell(key.standard_error), key.unit, key.what, cell(key.tolerance),
                   result.inconclusive_reason});
      } else {
        table.add({name, result.name, "not run", "", "", "", "", "", result.reason});
      }
    }
  }
  return table;
}

std::vector<std::string> models_of(const CheckArguments& options) {
  std::vector<std::string> models;
  for (const std::string& model : {options.model, second_model(options)}) {
    if (!model.empty()) models.push_back(model);
  }
  return models;
}

void run(const CheckArguments& options) {
  prepare_outputs(options.common, {options.table}, inputs_of(options));
  JsonResult json(options.common);
  const FlightSet flights = CommandFlights(options.flights).flights;
  std::optional<ModelDefinition> model;
  if (!options.model.empty()) model = read_model_for(options.model, flights, options.common);
  CheckOptions check_options;
  check_options.mask = mask_options(options.flights);
  if (!options.reference.empty()) check_options.second = read_second(options);
  Checks checks;
  {
    Progress bar("checking", !options.common.quiet);
    check_options.progress = [&bar](std::size_t done, std::size_t total) { bar.show(done, total); };
    checks = check(flights, model, check_options);
  }
  std::optional<FlightTable> table;
  if (!options.table.empty()) table = flight_table(flights, model, check_options, checks);
  if (!is_speaker()) return;
  OutputTransaction together;
  if (!options.common.report.empty())
    write_report_of_run(check_report(checks),
                        {models_of(options), options.flights.flights, {}, next_steps(checks, options, model)},
                        options.common);
  if (table) table->write(options.table);
  json.write(checks);
  together.appear();
  if (wants_text(options.common)) print(checks, options, model);
}

}  // namespace

std::function<void()> add_check(CLI::App& program) {
  auto options = std::make_shared<CheckArguments>();
  CLI::App* command = program.add_subcommand(
      "check",
      "Test the corrected pressures independently of the fit: redundant systems, manoeuvres, layers");
  add_flight_options(*command, options->flights);
  command
      ->add_option("-m,--model", options->model,
                   "model to check (default: corrected variables of the flight)")
      ->type_name("MODEL.toml");
  command
      ->add_option(
          "--reference", options->reference,
          "static:OTHER.toml, model of a second static system (default: second pressure pair, uncorrected)")
      ->check(is_second_system())
      ->type_name("static:OTHER.toml");
  CLI::Option* const old = command->add_option_function<std::string>(
      "--second", [options](const std::string& model) { options->reference = second_system + model; });
  add_deprecated_alias(*old, "--reference static:OTHER.toml");
  add_table_option(*command, options->table,
                   "write one row per check and flight to FILE.csv, each flight checked separately");
  add_common_options<Checks>(*command, options->common);
  add_examples(*command,
               {"check first.nc second.nc third.nc -m best.toml --report check.html",
                "check first.nc -m model.toml --reference static:data/models/c130-psfrd-eq18.toml"});
  return [options] { run(*options); };
}

}  // namespace pcor::tool

#include <pcor/process/process_flights.hpp>
#include <pcor/process/process_report.hpp>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include <pcor/base/error.hpp>
#include <pcor/base/utc.hpp>
#include "command.hpp"
#include "comparison.hpp"
#include "model_name.hpp"
#include "model_selector.hpp"
#include "progress.hpp"
#include "report_origin.hpp"

namespace pcor::tool {
namespace {

namespace fs = std::filesystem;

struct ProcessArguments {
  CommonOptions common;
  std::vector<std::string> inputs;
  std::string model;
  std::string models;  ///< folder of models, one of which is selected for each flight
  std::string output;
  std::string correct_with = "model";
  std::string uncertainty;
  ProcessFlightsOptions flights;  ///< the other options
};

/// Command that makes one output alone.
std::string command_line(const ProcessTask& task, const ProcessArguments& options) {
  const ProcessOptions& process = options.flights.process;
  std::string line =
      fmt::format("pcor " PCOR_VERSION " process {} {} {} -o {}", shell_path(task.input.string()),
                  options.models.empty() ? "-m" : "--models", shell_path(options.model + options.models),
                  shell_path(task.output.string()));
  if (options.correct_with != "model") line += " --correct-with " + options.correct_with;
  if (process.timestamp_alignment == TimestampAlignment::middle) line += " --time-stamp middle";
  if (!options.uncertainty.empty()) line += " --uncertainty " + options.uncertainty;
  if (!process.suffix.empty()) line += " " + shell_option("--suffix", process.suffix);
  if (process.copy_all) line += " --all";
  if (process.hydrostatic) line += " --hydrostatic";
  if (process.keep_frozen) line += " --keep-frozen";
  return line;
}

std::size_t count_of(const std::vector<ProcessedFlight>& flights, FlightState state) {
  return static_cast<std::size_t>(std::count_if(
      flights.begin(), flights.end(), [state](const ProcessedFlight& each) { return each.state == state; }));
}

/// JSON result of several flights.
struct ProcessedFlights {
  std::string model{};
  std::string models{};
  std::string output{};
  std::vector<ProcessedFlight> flights{};
};

template <class Field>
void describe(const ProcessedFlights& self, Field& field) {
  field("model", self.model, "model of all flights");
  field("models", self.models, "folder of models");
  field("output", self.output, "folder of the results");
  field("processed", count_of(self.flights, FlightState::processed), "number processed");
  field("up_to_date", count_of(self.flights, FlightState::up_to_date), "number up to date");
  field("unreadable", count_of(self.flights, FlightState::unreadable), "number unreadable");
  field("flights", self.flights, "result of each flight, if there are several");
}

using Flags = decltype(ProcessSummary::flagged);

void print_flags(const Flags& flagged) {
  bool any = false;
  for (std::size_t i = 0; i < quality_info.size(); ++i) {
    if (flagged[i] == 0) continue;
    if (!any) print_formatted("{:>9}  {:<32} {}\n", "samples", "quality bit", "meaning");
    any = true;
    print_formatted("{:>9}  {:<32} {}\n", flagged[i], quality_info[i].name,
                    is_verbose() ? quality_info[i].meaning : quality_info[i].brief);
  }
}

/// Next step for the first processed flight; empty if no flight was processed.
std::vector<NextStep> next_steps(const std::vector<ProcessedFlight>& flights, const std::string& report) {
  const auto done = std::find_if(flights.begin(), flights.end(), [](const ProcessedFlight& each) {
    return each.state == FlightState::processed;
  });
  if (done == flights.end()) return {};
  if (!report.empty()) return {{"To look at the result, open in a browser: " + shell_path(report)}};
  return {{"To look at the result",
           fmt::format("ncdump -v {} {} | less", shell_quote(done->summary.outputs.front()),
                       shell_path(done->output.string()))}};
}

/// Prints the summary of one flight.
void print(const ProcessedFlight& of) {
  const ProcessSummary& summary = of.summary;
  std::string flight;
  for (const std::string& part : {summary.project, summary.flight, summary.aircraft}) {
    if (part.empty()) continue;
    if (!flight.empty()) flight += ' ';
    flight += part;
  }
  print_formatted("{}{}{} to {} UTC: {} records, {} sample{} in a record\n", flight,
                  flight.empty() ? "" : ", ", utc_text(summary.start_time), utc_text(summary.end_time),
                  summary.records, summary.rate, summary.rate == 1 ? "" : "s");
  print_formatted("corrected {} of {} samples", summary.corrected, summary.samples);
  if (summary.in_flight > 0) {
    print_formatted("; in flight (dynamic pressure of {:.0f} hPa and more) {} with {}",
                    summary.flying_dynamic_pressure, summary.in_flight, format_defect(summary));
  } else if (summary.corrected > 0) {
    print_formatted("; all of them on the ground (dynamic pressure below {:.0f} hPa)",
                    summary.flying_dynamic_pressure);
  }
  print_formatted("\n");
  if (summary.gaps > 0) print_formatted("{} gap{} in time\n", summary.gaps, summary.gaps == 1 ? "" : "s");
  print_flags(summary.flagged);
  const auto bits = std::count_if(summary.flagged.begin(), summary.flagged.end(),
                                  [](std::size_t samples) { return samples > 0; });
  const auto warnings = std::count_if(summary.notes.begin(), summary.notes.end(),
                                      [](const Note& note) { return note.severity == Severity::warning; });
  constexpr std::size_t few = 1, usual = 3;  // fewer below a long table, but all warnings
  print_notes(summary.notes, std::max(bits > 5 ? few : usual, static_cast<std::size_t>(warnings)));
  print_formatted("{} {}: {}\n", wrote(of.output), of.output.string(), fmt::join(summary.outputs, " "));
}

/// Several flights as a table: a row when a flight is done, and common notes at the end.
class Table {
 public:
  Table(const std::vector<ProcessTask>& tasks, bool with_models) : with_models_(with_models) {
    for (const ProcessTask& task : tasks) width_ = std::max(width_, task.input.filename().string().size());
  }

  void add(const ProcessedFlight& flight) {
    if (!has_head_) {
      print_formatted("{:<{}} {:>9} {:>9} {:>9} {:>9} {:>9}{}\n", "flight", width_, "samples", "corrected",
                      "delta-p", "least", "greatest", with_models_ ? "  model" : "");
    }
    has_head_ = true;
    const ProcessSummary& summary = flight.summary;
    print_formatted("{:<{}} ", flight.input.filename().string(), width_);
    if (flight.state != FlightState::processed) {
      print_formatted("{}\n", flight.reason.empty() ? std::string(to_string(flight.state))
                                                    : "not corrected: " + flight.reason);
    } else if (summary.in_flight == 0) {
      print_formatted("{:>9} {:>9} {:>9} {:>9} {:>9}{}\n", summary.samples, summary.corrected, "no flight",
                      "", "", model_of(flight));
    } else {
      print_formatted("{:>9} {:>9} {:>9.2f} {:>9.2f} {:>9.2f}{}\n", summary.samples, summary.corrected,
                      summary.mean_defect, summary.min_defect, summary.max_defect, model_of(flight));
    }
  }

  static void end(const std::vector<ProcessedFlight>& flights, const std::string& folder) {
    if (count_of(flights, FlightState::processed) > 0)
      print_formatted("delta-p: mean in flight, hPa, with minimum and maximum\n");
    Flags flagged{};
    for (const ProcessedFlight& flight : flights) {
      for (std::size_t i = 0; i < flagged.size(); ++i) flagged[i] += flight.summary.flagged[i];
    }
    print_flags(flagged);
    // Each note once, with its flight or the number of its flights.
    constexpr std::size_t max_notes = 6;
    std::map<Note, std::vector<std::string>> names;
    for (const ProcessedFlight& flight : flights) {
      for (const Note& note : flight.summary.notes) names[note].push_back(flight.input.filename().string());
    }
    Notes notes;
    for (const auto& [note, of] : names) {
      const std::string whose =
          of.size() == 1 ? of.front() : fmt::format("each of {} of {} flights", of.size(), flights.size());
      notes.emplace_back(note.severity, fmt::format("{}: {}", whose, note.text));
    }
    print_notes(notes, max_notes);
    print_formatted("\n{} flights: {} processed into {}, {} up to date, {} not corrected\n", flights.size(),
                    count_of(flights, FlightState::processed), folder,
                    count_of(flights, FlightState::up_to_date), count_of(flights, FlightState::unreadable));
  }

 private:
  std::string model_of(const ProcessedFlight& flight) const {
    return with_models_ ? "  " + flight.model.model.name : std::string();
  }

  bool with_models_;
  std::size_t width_ = 24;
  bool has_head_ = false;
};

UncertaintyPart part_named(const std::string& name) {
  if (name == "total") return UncertaintyPart::total;
  if (name == "systematic") return UncertaintyPart::systematic;
  if (name == "random") return UncertaintyPart::random;
  return name == "none" ? UncertaintyPart::none : UncertaintyPart::total_if_stated;
}

/// Several flights are written to a folder, which is created; a single one if the output is an existing
/// folder.
bool wants_folder(const ProcessArguments& options) {
  std::error_code code;
  if (fs::is_directory(options.output, code)) return true;
  const bool is_there = fs::exists(options.output, code);
  const bool looks_like_a_folder = !options.output.empty() && options.output.back() == '/';
  if (options.inputs.size() == 1 && !looks_like_a_folder) return false;
  if (is_there || fs::path(options.output).extension() == ".nc") {
    throw Error(Error::Code::usage,
                fmt::format("{} {}; several flights need an output directory; give an existing or a new one",
                            options.output, is_there ? "is a file" : "has the extension of a file"));
  }
  return true;
}

std::vector<ProcessTask> tasks_of(const ProcessArguments& options, bool folder) {
  const std::vector<fs::path> flights(options.inputs.begin(), options.inputs.end());
  std::vector<ProcessTask> tasks = folder ? tasks_in_folder(flights, options.output)
                                          : std::vector<ProcessTask>{{flights.front(), options.output, {}}};
  std::vector<fs::path> models{options.model};
  if (!options.models.empty()) models = models_in(options.models);
  refuse_overwriting({options.common.json, options.common.report}, flights);
  for (ProcessTask& task : tasks) {
    task.history = command_line(task, options);
    std::vector<fs::path> inputs = models;
    inputs.push_back(task.input);
    refuse_overwriting({task.output, options.common.json, options.common.report}, inputs);
  }
  return tasks;
}

/// Folder for several flights, created if absent, and removed if it remains empty.
class OutputFolder {
 public:
  explicit OutputFolder(fs::path folder) : folder_(std::move(folder)) {
    std::error_code code;
    is_new_ = fs::create_directories(folder_, code);
    if (code) {
      throw Error(Error::Code::output,
                  fmt::format("{}: the folder cannot be created: {}; choose another output", folder_.string(),
                              code.message()));
    }
  }
  OutputFolder(const OutputFolder&) = delete;
  OutputFolder& operator=(const OutputFolder&) = delete;
  ~OutputFolder() {
    std::error_code holds_files;
    if (is_new_) fs::remove(folder_, holds_files);
  }

 private:
  fs::path folder_;
  bool is_new_ = false;
};

/// Like `process_flights`; an error that stops several flights adds how to process the others.
std::vector<ProcessedFlight> process_all(const std::vector<ProcessTask>& tasks, const ModelSelector& model_of,
                                         const ProcessFlightsOptions& options) {
  try {
    return process_flights(tasks, model_of, options);
  } catch (const Error& error) {
    if (tasks.size() == 1 || error.code() == Error::Code::output) throw;
    throw Error(
        error.code(),
        fmt::format("{}; finished outputs are kept; --skip-unreadable processes the remaining flights",
                    error.what()));
  }
}

/// One model for all flights, or a selection for each flight.
ModelSelector models_of(const ProcessArguments& options) {
  if (!options.models.empty()) {
    return [models = models_in(options.models), &options](const fs::path& flight) {
      return model_for_flight(models, flight, options.common);
    };
  }
  const FlightSet flights(std::vector<fs::path>(options.inputs.begin(), options.inputs.end()));
  return [model = read_model_for(options.model, flights, options.common)](const fs::path&) { return model; };
}

void run(const ProcessArguments& options) {
  const bool folder = wants_folder(options);
  const std::vector<ProcessTask> tasks = tasks_of(options, folder);
  const bool many = tasks.size() > 1;
  require_writable(options.common.report);
  JsonResult json(options.common);
  const ModelSelector model_of = models_of(options);
  std::optional<OutputFolder> output_folder;
  if (folder) output_folder.emplace(options.output);
  ProcessFlightsOptions process = options.flights;
  if (options.correct_with == "lams") process.process.correct_with = CorrectWith::lams;
  process.process.uncertainty = part_named(options.uncertainty);
  std::optional<Progress> bar;
  process.on_flight_start = [&](std::size_t task) {
    bar.emplace(many ? fmt::format("processing {} of {}", task + 1, tasks.size()) : "processing",
                !options.common.quiet);
  };
  process.process.progress = [&bar](std::size_t done, std::size_t total) { bar->show(done, total); };
  const bool text = wants_text(options.common);
  std::optional<Table> table;
  if (many && text) table.emplace(tasks, !options.models.empty());
  process.on_flight_end = [&](const ProcessedFlight& flight) {
    bar.reset();
    if (table) table->add(flight);
  };
  std::optional<OutputTransaction> together;
  if (!many) together.emplace();  // each of many outputs appears when it is done
  ProcessedFlights result{options.model, options.models, options.output,
                          process_all(tasks, model_of, process)};
  for (ProcessedFlight& flight : result.flights) flight.model_label = options.model;
  const std::vector<ProcessedFlight>& flights = result.flights;
  const bool none = count_of(flights, FlightState::unreadable) == flights.size();
  if (!options.common.report.empty() && !none) {
    write_report_of_run(process_report(flights, process.process.suffix),
                        {{options.model + options.models}, options.inputs, {}, next_steps(flights, "")},
                        options.common);
  }
  if (many)
    json.write(result);
  else
    json.write(flights.front());
  if (together) together->appear();
  if (table) Table::end(flights, options.output);
  if (none) {
    throw Error(Error::Code::file, many ? fmt::format("processing failed for all {} flights", flights.size())
                                        : flights.front().reason);
  }
  if (!text) return;
  const ProcessedFlight& first = flights.front();
  if (!many && first.state == FlightState::processed) {
    print(first);
  } else if (!many) {
    print_formatted("{} is up to date for this version, flight, model and options\n", first.output.string());
  }
  print_written_files({options.common.report, options.common.json});
  print_next_steps(next_steps(flights, options.common.report));
}

}  // namespace

std::function<void()> add_process(CLI::App& program) {
  auto options = std::make_shared<ProcessArguments>();
  CLI::App* command =
      program.add_subcommand("process", "Correct flights: run every sample through the real-time loop");
  command->add_option("FLIGHT.nc", options->inputs, "the flights, netCDF or ICARTT files")
      ->required()
      ->type_name("");
  CLI::Option* const model =
      command->add_option("-m,--model", options->model, "the model of the pressure system")
          ->type_name("MODEL.toml");
  command
      ->add_option("--models", options->models,
                   "folder of models, instead of one model: each flight is corrected by the model for its "
                   "aircraft, date and variables")
      ->excludes(model)
      ->type_name("FOLDER");
  command->parse_complete_callback([options] {
    if (options->model.empty() && options->models.empty()) throw CLI::RequiredError("--model or --models");
  });
  command
      ->add_option("-o,--output", options->output,
                   "output file (written atomically); for several flights a folder with one file each")
      ->required()
      ->check(is_file_name())
      ->type_name("OUT.nc");
  command->add_flag("--if-stale", options->flights.if_stale,
                    "skip an output that was made from the same flight, model and options by this version, "
                    "according to its hashes");
  command->add_flag("--skip-unreadable", options->flights.skip_unreadable,
                    "continue after a flight that cannot be read or lacks inputs of the model, and give the "
                    "reason in its row");
  command
      ->add_option("--correct-with", options->correct_with,
                   "source of the correction of PSXC and QCXC: the model, or the laser air-motion sensor "
                   "(LAMS) where it is valid")
      ->check(CLI::IsMember({"model", "lams"}))
      ->capture_default_str();
  add_time_stamp_option(*command, options->flights.process.timestamp_alignment);
  command
      ->add_option("--uncertainty", options->uncertainty,
                   "write the standard uncertainties of results: total, only the systematic or only the "
                   "random part, or no uncertainty with none (default: total if the model states any)")
      ->check(CLI::IsMember({"total", "systematic", "random", "none"}));
  command
      ->add_option("--suffix", options->flights.process.suffix, "add S to the names of the derived variables")
      ->type_name("S");
  command->add_flag("--all", options->flights.process.copy_all,
                    "copy all non-text input variables; list those not copied");
  command->add_flag("--hydrostatic", options->flights.process.hydrostatic,
                    "write HYDSTEP, the change of hydrostatic height per kelvin from sample to sample");
  command->add_flag("--keep-frozen", options->flights.process.keep_frozen,
                    "correct the readings of frozen sensors as well (default: missing)");
  add_common_options<ProcessedFlight, ProcessedFlights>(*command, options->common);
  add_examples(*command, {"process third.nc -m best.toml -o corrected.nc",
                          "process third.nc -m best.toml --all --suffix _NEW -o everything.nc"});
  return [options] { run(*options); };
}

}  // namespace pcor::tool

#include <pcor/process/process.hpp>

#include <fmt/format.h>

#include <cmath>
#include <memory>
#include <string>

#include <pcor/words/utc.hpp>
#include "command.hpp"
#include "progress.hpp"

namespace pcor::tool {
namespace {

struct Options {
  CommonOptions common;
  std::string input;
  std::string model;
  std::string output;
  std::string correct_with = "model";
  std::string time_stamp = "begin";
  std::string uncertainty;
  std::string suffix;
  bool copy_all = false;
  bool hydrostatic = false;
};

std::string command_line(const Options& options) {
  std::string line = fmt::format("pcor " PCOR_VERSION " process {} -m {} -o {}", quoted(options.input),
                                 quoted(options.model), quoted(options.output));
  if (options.correct_with != "model") line += " --correct-with " + options.correct_with;
  if (options.time_stamp != "begin") line += " --time-stamp " + options.time_stamp;
  if (!options.uncertainty.empty()) line += " --uncertainty " + options.uncertainty;
  if (!options.suffix.empty()) line += " --suffix " + quoted(options.suffix);
  if (options.copy_all) line += " --all";
  if (options.hydrostatic) line += " --hydrostatic";
  return line;
}

nlohmann::ordered_json as_json(const ProcessSummary& summary, const Options& options) {
  nlohmann::ordered_json result;
  result["input"] = options.input;
  result["output"] = options.output;
  result["model"] = options.model;
  result["aircraft"] = summary.aircraft;
  result["project"] = summary.project;
  result["flight"] = summary.flight;
  result["start"] = utc_text(summary.first_time, iso_time);
  result["end"] = utc_text(summary.last_time, iso_time);
  result["records"] = summary.records;
  result["rate"] = summary.rate;
  result["samples"] = summary.samples;
  result["corrected"] = summary.corrected;
  result["flying_dynamic_pressure_hpa"] = summary.flying_dynamic_pressure;
  result["in_flight"] = summary.in_flight;
  result["gaps"] = summary.gaps;
  result["delta_p_hpa"] = {
      {"mean", summary.mean_defect}, {"least", summary.least_defect}, {"greatest", summary.greatest_defect}};
  nlohmann::ordered_json flags;
  for (std::size_t i = 0; i < quality_facts.size(); ++i)
    flags[std::string(quality_facts[i].name)] = summary.flagged[i];
  result["flags"] = flags;
  result["variables"] = summary.outputs;
  result["notes"] = summary.notes;
  return result;
}

void print(const ProcessSummary& summary, const Options& options) {
  std::string flight;
  for (const std::string& part : {summary.project, summary.flight, summary.aircraft}) {
    if (part.empty()) continue;
    if (!flight.empty()) flight += ' ';
    flight += part;
  }
  fmt::print("{}{}{} to {} UTC: {} records, {} sample{} in a record\n", flight, flight.empty() ? "" : ", ",
             utc_text(summary.first_time), utc_text(summary.last_time), summary.records, summary.rate,
             summary.rate == 1 ? "" : "s");
  fmt::print("corrected {} of {} samples", summary.corrected, summary.samples);
  if (summary.in_flight > 0) {
    fmt::print(
        "; in flight, at a dynamic pressure of {:.0f} hPa and more, {} with delta-p {:.2f} hPa in the "
        "mean, {:.2f} to {:.2f} hPa",
        summary.flying_dynamic_pressure, summary.in_flight, summary.mean_defect, summary.least_defect,
        summary.greatest_defect);
  } else if (summary.corrected > 0) {
    fmt::print("; none of them in flight, at a dynamic pressure of {:.0f} hPa and more",
               summary.flying_dynamic_pressure);
  }
  fmt::print("\n");
  if (summary.gaps > 0) fmt::print("{} gap{} in time\n", summary.gaps, summary.gaps == 1 ? "" : "s");
  bool flagged = false;
  for (std::size_t i = 0; i < quality_facts.size(); ++i) {
    if (summary.flagged[i] == 0) continue;
    if (!flagged) fmt::print("\n{:>9}  {:<32} {}\n", "samples", "quality bit", "meaning");
    flagged = true;
    fmt::print("{:>9}  {:<32} {}\n", summary.flagged[i], quality_facts[i].name, quality_facts[i].meaning);
  }
  for (const std::string& note : summary.notes) fmt::print("\nNote: {}.\n", note);
  fmt::print("\nwrote {} to {}\n", fmt::join(summary.outputs, " "), options.output);
  say_written({options.common.json});
  fmt::print("To look at the result: ncdump -v {} {} | less\n", summary.outputs.front(),
             quoted(options.output));
}

UncertaintyPart part_named(const std::string& name) {
  if (name == "total") return UncertaintyPart::total;
  if (name == "systematic") return UncertaintyPart::systematic;
  if (name == "random") return UncertaintyPart::random;
  return name == "none" ? UncertaintyPart::none : UncertaintyPart::total_if_stated;
}

void run(const Options& options) {
  refuse_overwriting({options.output, options.common.json}, {options.input, options.model});
  JsonResult json(options.common);
  const ModelFile model = read_model(options.model);
  ProcessOptions process;
  process.correct_with = options.correct_with == "lams" ? CorrectWith::lams : CorrectWith::model;
  process.time_stamp = options.time_stamp == "middle" ? TimeStamp::middle : TimeStamp::begin;
  process.copy_all = options.copy_all;
  process.hydrostatic = options.hydrostatic;
  process.uncertainty = part_named(options.uncertainty);
  process.suffix = options.suffix;
  process.history = command_line(options);
  ProcessSummary summary;
  {
    Progress bar("processing", !options.common.quiet);
    process.progress = [&bar](std::size_t done, std::size_t total) { bar.show(done, total); };
    summary = process_flight(options.input, model, options.output, process);
  }
  json.write(as_json(summary, options));
  if (wants_text(options.common)) print(summary, options);
}

}  // namespace

std::function<void()> add_process(CLI::App& program) {
  auto options = std::make_shared<Options>();
  CLI::App* command =
      program.add_subcommand("process", "Correct a flight: run every sample through the real-time loop");
  command->add_option("input", options->input, "the flight, a netCDF file")->required()->type_name("IN.nc");
  command->add_option("-m,--model", options->model, "the model of the pressure system")
      ->required()
      ->type_name("MODEL.toml");
  command->add_option("-o,--output", options->output, "the file to write, whole or not at all")
      ->required()
      ->check(is_file_name())
      ->type_name("OUT.nc");
  command
      ->add_option("--correct-with", options->correct_with,
                   "what PSXC and QCXC are corrected with: the model, or the laser air-motion sensor (LAMS) "
                   "where it is valid")
      ->check(CLI::IsMember({"model", "lams"}))
      ->capture_default_str();
  command
      ->add_option("--time-stamp", options->time_stamp,
                   "whether the time of a record is the beginning or the middle of its second")
      ->check(CLI::IsMember({"begin", "middle"}))
      ->capture_default_str();
  command
      ->add_option("--uncertainty", options->uncertainty,
                   "write the standard uncertainties of results: total, or the part that is systematic or "
                   "random alone, or none; without this option the total where the model states any")
      ->check(CLI::IsMember({"total", "systematic", "random", "none"}));
  command->add_option("--suffix", options->suffix, "add S to the names of the derived variables")
      ->type_name("S");
  command->add_flag("--all", options->copy_all, "copy every variable of the input");
  command->add_flag("--hydrostatic", options->hydrostatic,
                    "write HYDSTEP, the change of hydrostatic height per kelvin from sample to sample");
  add_common_options(*command, options->common, false);
  add_examples(*command, {"process third.nc -m best.toml -o corrected.nc",
                          "process third.nc -m best.toml --all --suffix _NEW -o everything.nc"});
  return [options] { run(*options); };
}

}  // namespace pcor::tool

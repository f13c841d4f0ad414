#include <pcor/simulate/simulate.hpp>

#include <fmt/format.h>

#include <memory>
#include <optional>

#include <pcor/base/utc.hpp>
#include "command.hpp"
#include "progress.hpp"

namespace pcor::tool {

namespace {

struct SimulateArguments {
  CommonOptions common;
  std::string scenario;
  std::string output;
  std::optional<std::uint64_t> seed{};
};

std::string command_line(const SimulateArguments& options, std::uint64_t seed) {
  return fmt::format("pcor " PCOR_VERSION " simulate {} -o {} --seed {}", shell_path(options.scenario),
                     shell_path(options.output), seed);
}

void print_legs(const SimulationSummary& summary) {
  print_formatted("\n");
  print_formatted("{:<16} {:>8}  {:>8} {:>8} {:>8} {:>12} {:>12}\n", "leg", "begin", "end", "m", "hPa",
                  "TAS m/s", "alpha deg");
  for (const SimulatedLeg& leg : summary.legs) {
    print_formatted("{:<16} {:>8}  {:>8} {:>8.0f} {:>8.1f} {:>12} {:>12}\n", leg.kind,
                    utc_text(leg.start_time, "%H:%M:%S"), utc_text(leg.end_time, "%H:%M:%S"), leg.altitude,
                    leg.pressure, fmt::format("{:.0f} to {:.0f}", leg.min_speed, leg.max_speed),
                    fmt::format("{:.1f} to {:.1f}", leg.min_attack, leg.max_attack));
  }
  print_formatted("\n");
}

void print(const SimulationSummary& summary, const SimulateArguments& options) {
  print_formatted("{}, {}, {} to {} UTC: {} records, {} legs, seed {}\n", summary.name, summary.aircraft,
                  utc_text(summary.start_time), utc_text(summary.end_time), summary.records,
                  summary.legs.size(), summary.seed);
  if (is_verbose()) print_legs(summary);
  std::vector<std::string> errors = summary.effects;
  for (std::string& error : errors)
    error = error == "unknown" ? "an error of the scenario's own formula (unknown)" : error;
  if (!errors.empty()) print_formatted("simulated errors: {}\n", fmt::join(errors, ", "));
  print_formatted("{} {} variables, and the true values as TRUE_..., to {}\n", wrote(options.output),
                  summary.variables.size(), options.output);
  print_written_files({options.common.json});
  print_formatted("To see where a model fails on it: {} compare {} -m MODEL.toml\n", program(),
                  shell_path(options.output));
}

void run(const SimulateArguments& options) {
  refuse_overwriting({options.output, options.common.json}, {options.scenario});
  JsonResult json(options.common);
  Scenario scenario = read_scenario(options.scenario);
  if (options.seed) scenario.seed = *options.seed;
  SimulateOptions simulate;
  simulate.history = command_line(options, scenario.seed);
  OutputTransaction together;
  SimulationSummary summary;
  {
    Progress bar("simulating", !options.common.quiet);
    simulate.progress = [&bar](std::size_t done, std::size_t total) { bar.show(done, total); };
    summary = simulate_flight(scenario, options.output, simulate);
  }
  summary.scenario = options.scenario;
  json.write(summary);
  together.appear();
  if (wants_text(options.common)) print(summary, options);
}

}  // namespace

std::function<void()> add_simulate(CLI::App& program) {
  auto options = std::make_shared<SimulateArguments>();
  CLI::App* command = program.add_subcommand("simulate", "Simulate a flight whose true pressures are known");
  command
      ->add_option("scenario", options->scenario,
                   "the flight plan, the atmosphere, and the errors of the instruments")
      ->required()
      ->type_name("SCENARIO.toml");
  command->add_option("-o,--output", options->output, "output file (written atomically)")
      ->required()
      ->check(is_file_name())
      ->type_name("OUT.nc");
  command->add_option("--seed", options->seed, "seed of the random numbers, overrides the scenario's")
      ->check(CLI::Range(std::int64_t{0}, std::numeric_limits<std::int64_t>::max()))
      ->type_name("N");
  add_common_options(*command, options->common, false,
                     [] { return KeyLists{json_keys(SimulationSummary{})}; });
  add_examples(*command, {"simulate data/scenarios/c130-hidden.toml -o first.nc",
                          "simulate data/scenarios/c130-hidden.toml --seed 102 -o second.nc"});
  return [options] { run(*options); };
}

}  // namespace pcor::tool

#include <pcor/process/process_flights.hpp>

#include <fmt/format.h>

#include <map>
#include <system_error>

#include <pcor/base/error.hpp>
#include "process/origin.hpp"

namespace pcor {

namespace fs = std::filesystem;

std::string_view to_string(FlightState state) {
  if (state == FlightState::processed) return "processed";
  return state == FlightState::up_to_date ? "up to date" : "unreadable";
}

std::vector<ProcessTask> tasks_in_folder(const std::vector<fs::path>& flights, const fs::path& folder) {
  std::vector<ProcessTask> tasks;
  std::map<fs::path, fs::path> flight_called;
  for (const fs::path& flight : flights) {
    const fs::path name = flight.filename();
    const auto [other, is_new] = flight_called.emplace(name, flight);
    if (!is_new) {
      throw Error(Error::Code::usage,
                  fmt::format("{} and {} would have the same output, {}; process them into two folders",
                              other->second.string(), flight.string(), (folder / name).string()));
    }
    std::error_code code;
    if (fs::equivalent(fs::absolute(flight).parent_path(), folder, code)) {
      throw Error(
          Error::Code::usage,
          fmt::format("{} lies in the output folder {} and is never overwritten; choose another folder",
                      flight.string(), folder.string()));
    }
    tasks.push_back({flight, folder / name});
  }
  return tasks;
}

std::vector<ProcessedFlight> process_flights(const std::vector<ProcessTask>& tasks,
                                             const ModelSelector& model_of,
                                             const ProcessFlightsOptions& options) {
  std::vector<ProcessedFlight> flights;
  for (std::size_t i = 0; i < tasks.size(); ++i) {
    if (options.on_flight_start) options.on_flight_start(i);
    ProcessedFlight& flight = flights.emplace_back();
    flight.input = tasks[i].input;
    flight.output = tasks[i].output;
    try {
      flight.model = model_of(flight.input);
      if (options.if_stale &&
          internal::is_up_to_date(flight.output, flight.input, flight.model, options.process)) {
        flight.state = FlightState::up_to_date;
      } else {
        ProcessOptions process = options.process;
        process.history = tasks[i].history;
        flight.summary = process_flight(flight.input, flight.model, flight.output, process);
      }
    } catch (const Error& error) {
      if (!options.skip_unreadable || error.code() == Error::Code::output) throw;
      flight.state = FlightState::unreadable;
      flight.reason = error.what();
    }
    if (options.on_flight_end) options.on_flight_end(flight);
  }
  return flights;
}

}  // namespace pcor

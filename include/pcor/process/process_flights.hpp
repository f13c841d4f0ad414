#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include <pcor/flight/readable_flights.hpp>
#include <pcor/process/process.hpp>

namespace pcor {

/// A flight that is to be processed.
struct ProcessTask {
  std::filesystem::path input;
  std::filesystem::path output;
  std::string history{};  ///< what the output says of its making, e.g. a command line that makes it alone
};

/// What became of a flight.
enum class FlightState { processed, up_to_date, unreadable };

/// "processed", "up to date" or "unreadable".
std::string_view to_string(FlightState state);

struct ProcessedFlight {
  std::filesystem::path input;
  std::filesystem::path output;
  FlightState state = FlightState::processed;
  ModelDefinition model{};   ///< by which it was corrected; empty where none could be told
  ProcessSummary summary{};  ///< of a flight that was processed
  std::string reason{};      ///< why it could not be read, one line
};

/// The model that a flight is to be corrected by. It may throw Error where there is none.
using ModelSelector = std::function<ModelDefinition(const std::filesystem::path& flight)>;

/// How several flights are processed.
struct ProcessFlightsOptions {
  ProcessOptions process{};      ///< of each flight; the history is that of its task
  bool if_stale = false;         ///< leave alone what `is_up_to_date`
  bool skip_unreadable = false;  ///< go on after a flight that cannot be read or lacks what the model needs
  /// In a copy of the process, all flights to be skipped for a crash are found before the first is processed;
  /// of those with `if_stale` that have an output already none is opened for it.
  OpenedIn opened_in = OpenedIn::this_process;
  std::function<void(std::size_t task)> begins{};             ///< told before each flight
  std::function<void(const ProcessedFlight& flight)> ends{};  ///< told after each flight
};

/// One task for each flight, into a folder under the name that it has.
/// @throws Error if two flights have one name, or one lies in the folder itself.
std::vector<ProcessTask> tasks_in_folder(const std::vector<std::filesystem::path>& flights,
                                         const std::filesystem::path& folder);

/// Processes flights one after the other, each by its model, as `process_flight` does. Memory does not grow
/// with their number, but for what is said of each.
///
/// @throws Error as `process_flight`; what was done before stays. With `skip_unreadable` an error of a flight
/// is the `reason` of its entry instead; one of an output is thrown all the same.
std::vector<ProcessedFlight> process_flights(const std::vector<ProcessTask>& tasks,
                                             const ModelSelector& model_of,
                                             const ProcessFlightsOptions& options = {});

}  // namespace pcor

#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include <pcor/process/process.hpp>

namespace pcor {

/// Input and output of one flight.
struct ProcessTask {
  std::filesystem::path input;
  std::filesystem::path output;
  /// History attribute of the output, e.g. a command line that reproduces this output alone.
  std::string history{};
};

/// Outcome for one flight.
enum class FlightState { processed, up_to_date, unreadable };

/// Text: "processed", "up to date" or "unreadable".
std::string_view to_string(FlightState state);

struct ProcessedFlight {
  std::filesystem::path input;
  std::filesystem::path output;
  FlightState state = FlightState::processed;
  ModelDefinition model{};    ///< model used; empty if no model could be selected
  ProcessSummary summary{};   ///< empty unless the flight was processed
  std::string reason{};       ///< reason for which it could not be read, one line
  std::string model_label{};  ///< name of the model in JSON; default: that in the model file
};

template <class Field>
void describe(const ProcessedFlight& self, Field& field) {
  field("input", self.input.string(), "file of the flight");
  field("output", self.output.string(), "file of the result");
  field("model", self.model_label.empty() ? self.model.model.name : self.model_label, "model of the flight");
  field("state", self.state, "processed, up to date or unreadable");
  if (field.has(self.state == FlightState::unreadable))
    field("reason", self.reason, "reason for which the flight is unreadable; otherwise absent");
  if (field.has(self.state == FlightState::processed)) describe(self.summary, field);
}

/// Selects the model for a flight. May throw Error if there is no model.
using ModelSelector = std::function<ModelDefinition(const std::filesystem::path& flight)>;

/// How several flights are processed.
struct ProcessFlightsOptions {
  ProcessOptions process{};  ///< options of each flight; the history is replaced by that of the task
  /// True: skip an output that is up to date: it holds the SHA-256 of the bytes of the flight, of the model
  /// and of the options with this version of the program, and all are equal. The flight is read completely,
  /// unless the model or the options differ. If a file cannot be read, the output is not up to date.
  bool if_stale = false;
  /// True: continue after a flight that cannot be read or lacks a variable of the model.
  bool skip_unreadable = false;
  std::function<void(std::size_t task)> on_flight_start{};             ///< callback before each flight
  std::function<void(const ProcessedFlight& flight)> on_flight_end{};  ///< callback after each flight
};

/// One task for each flight, with an output of the same file name in `folder`.
/// @throws Error if two flights have the same file name, or one lies in the folder itself.
std::vector<ProcessTask> tasks_in_folder(const std::vector<std::filesystem::path>& flights,
                                         const std::filesystem::path& folder);

/// Processes flights sequentially with `process_flight`, each by its selected model. Memory does not depend
/// on the number of flights, except for their results.
///
/// @throws Error as `process_flight`; completed outputs remain. With `skip_unreadable` an error of a flight
/// becomes the `reason` of its entry; an error of an output is still thrown.
std::vector<ProcessedFlight> process_flights(const std::vector<ProcessTask>& tasks,
                                             const ModelSelector& model_of,
                                             const ProcessFlightsOptions& options = {});

}  // namespace pcor

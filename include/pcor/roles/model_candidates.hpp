#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <pcor/flight/flight.hpp>
#include <pcor/model_io/model_definition.hpp>

namespace pcor {

/// A law in a model file, and how it goes with a flight of its aircraft.
struct ModelCandidate {
  std::filesystem::path path;
  ModelDefinition model;
  std::vector<std::string> lacks{};  ///< variables of the model that the flight does not have
  bool is_in_time = false;           ///< the flight is within the time for which the law is stated to hold
  std::string why_not{};  ///< what else stands against it, as a variable that has no value; empty for nothing

  /// The flight can be corrected by it.
  bool fits() const { return is_in_time && lacks.empty() && why_not.empty(); }
};

/// The laws of a flight's aircraft among model files, those that fit first; of these, those that its operator
/// processes such flights with (`LawInfo::in_processing`), and of these, those of the pressures that its
/// aircraft's data name first. The aircraft is known by the registration, which stands in both: "C-130
/// N130AR" and "N130AR". Of a file that cannot be read `notes` says why.
std::vector<ModelCandidate> model_candidates(const Flight& flight,
                                             const std::vector<std::filesystem::path>& models,
                                             std::vector<std::string>& notes);

/// The one law that a flight is to be corrected by: the first of `model_candidates`, where no other stands
/// level with it. Where the operator processes such flights with another, which needs what this one
/// does not have, `notes` says so.
/// @throws Error if a model cannot be read, none fits, or several do and nothing says which is the
/// operator's; the message names them.
ModelCandidate model_candidate(const Flight& flight, const std::vector<std::filesystem::path>& models,
                               std::vector<std::string>& notes);

}  // namespace pcor

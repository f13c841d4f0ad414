#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <pcor/base/note.hpp>
#include <pcor/flight/flight.hpp>
#include <pcor/model_io/model_definition.hpp>

namespace pcor {

/// Model file with its applicability to a flight of its aircraft.
struct ModelCandidate {
  std::filesystem::path path;
  ModelDefinition model;
  std::vector<std::string> lacks{};  ///< variables of the model that are absent from the flight
  bool is_in_time = false;           ///< true: the flight date is within the validity of the model
  std::string why_not{};  ///< other reasons against it, such as a variable without values; otherwise empty

  /// True if the model can be applied to the flight.
  bool fits() const { return is_in_time && lacks.empty() && why_not.empty(); }
};

template <class Field>
void describe(const ModelCandidate& self, Field& field) {
  field("name", self.model.model.name, "name of the model");
  field("model", self.path.string(), "file of the model");
  field("lacks", self.lacks, "variables of the model that are absent from the flight");
  field("is_in_time", self.is_in_time, "whether the model is valid at the date of the flight");
  field("why_not", self.why_not, "other reason against the model");
}

/// Doubt about the dates of a law: "beginning not stated; note: ...". Empty if the law states its first and
/// last day, or is used operationally.
std::string doubt_of_dates(const LawInfo& law);

/// Names of the applicable models, each with its doubt: "a, b (beginning not stated; note: ...)".
std::string applicable_text(const std::vector<ModelCandidate>& laws);

/// Models of a flight's aircraft among model files, sorted: applicable ones first; among these, operational
/// ones (`LawInfo::operational`) first, then those without a doubt about their dates, then those of the
/// pressures that the aircraft's data list first.
/// The aircraft is identified by a common registration: "C-130 N130AR" and "N130AR". `notes` reports
/// unreadable files.
std::vector<ModelCandidate> model_candidates(const Flight& flight,
                                             const std::vector<std::filesystem::path>& models, Notes& notes);

/// Selected model for a flight: the first of `model_candidates`, if it is unique in rank. `notes` reports an
/// operational model that needs variables absent from the flight.
/// @throws Error if a model cannot be read, no model is applicable, or several are and it is unknown which
/// one is operational; the message names them.
ModelCandidate model_candidate(const Flight& flight, const std::vector<std::filesystem::path>& models,
                               Notes& notes);

}  // namespace pcor

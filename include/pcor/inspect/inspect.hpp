#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <pcor/flight/flight.hpp>
#include <pcor/inspect/gps_design.hpp>
#include <pcor/model_io/model_definition.hpp>
#include <pcor/regimes/regimes.hpp>
#include <pcor/residuals/samples.hpp>
#include <pcor/roles/model_candidates.hpp>

namespace pcor {

/// The variable that would play a role.
struct InspectedRole {
  std::string role;         ///< "vertical_speed"; also of a series that no model reads, as "longitude"
  std::string variable;     ///< "VELD_GIN"
  std::string unit;         ///< as the file says, or the data of its aircraft where these know better
  bool is_turned = false;   ///< its sign is turned to be that of the role
  int rate = 1;             ///< samples in a record
  double present = 0.0;     ///< the part of the samples that have a value
  std::string trap{};       ///< what a user of it should know; may be empty
  bool is_verified = true;  ///< the name is in a public document of the aircraft
  std::vector<std::string> others{};  ///< further variables that could play it
  std::string why{};  ///< the evidence where its name is not one of the aircraft's; else empty
};

/// What is wrong, or coarse, with a variable.
struct Problem {
  std::string variable;
  std::string kind;   ///< "jump", "recorded in steps"
  std::string times;  ///< UTC
  double number = 0.0;
  std::string unit;
  std::string action;  ///< what is done about it, and how to have it otherwise
};

/// A variable that may play a role, by name, long name, unit and values.
struct InspectedCandidate {
  std::string variable;
  double score = 0.0;  ///< 0 to 1
  std::string why;
};

/// A role that no variable plays, and what cannot be done without it.
struct MissingRole {
  std::string role;
  std::string description;
  std::vector<std::string> looked_for;  ///< names of variables
  std::string cost;                     ///< a sentence without its end; empty where nothing needs it
  std::vector<std::string> effects;     ///< of the catalogue, which cannot be fitted or diagnosed
};

/// What a flight holds.
struct Inspection {
  std::string path;
  std::string aircraft{};
  std::string project{};
  std::string flight{};
  std::string institution{};
  std::string family{};  ///< whose names were looked for: "faam-core"
  std::string family_title{};
  std::vector<std::string> alike{};  ///< the families whose files it is like; several are doubt, none a guess
  TimeAxis time{};
  std::size_t records = 0;
  std::map<int, std::size_t> rates{};  ///< how many variables have so many samples in a record
  std::vector<InspectedRole> roles{};
  std::vector<MissingRole> missing{};
  std::map<std::string, std::vector<InspectedCandidate>> candidates{};  ///< of each role, the likeliest first
  std::vector<std::string> not_used{};  ///< variables that play no role and are candidates for none
  std::vector<Problem> problems{};
  /// What a law can be fitted to, as `--reference` takes it: "wind" and "height"; empty: nothing.
  std::vector<std::string> references{};
  std::string why_no_model{};  ///< what its pressures lack; empty if it has a model
  bool has_results = false;    ///< its inputs have names that `process` gives its results
  bool is_corrected = false;   ///< the pressures of the model are corrected already
  std::string
      corrected_pressure{};  ///< the static pressure that the flight's own processing corrected; may be empty
  std::vector<FrozenSpan>
      frozen{};  ///< sensors that stand still in flight, for longer than their noise allows
  std::vector<Interval> intervals{};   ///< what was flown; empty without pressures
  std::vector<ModelCandidate> laws{};  ///< for this aircraft, those that fit first
  std::optional<GpsDesign> by_gps{};   ///< empty without pressures or GPS
  std::vector<std::string> notes{};
  std::optional<ModelDefinition>
      model{};  ///< ready to run: the roles, and terms that a refit finds; none without pressures
  std::shared_ptr<const FlightSamples> samples{};  ///< what pictures are made of; null without pressures
};

/// Looks at a flight: what it is, which variable plays which role, what is missing and what that costs, what
/// was flown, which of the `laws` (model files) are for it. A file of `laws` that cannot be read is a note.
/// @param roles whose names are looked for: an aircraft of data/aircraft, or a file that ends in ".toml";
/// empty for the one that the flight tells
/// @throws Error if the flight cannot be read, or there are no such roles
Inspection inspect_flight(const std::filesystem::path& path,
                          const std::vector<std::filesystem::path>& laws = {},
                          TimestampAlignment timestamp_alignment = TimestampAlignment::begin,
                          const std::string& roles = "");

}  // namespace pcor

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

/// Variable found for a role.
struct InspectedRole {
  std::string role;         ///< "vertical_speed"; also series without a role in a model, such as "longitude"
  std::string variable;     ///< "VELD_GIN"
  std::string unit;         ///< unit in the file, corrected by the data of its aircraft
  bool is_turned = false;   ///< true: its sign is opposite to that of the role
  int rate = 1;             ///< samples per record
  double present = 0.0;     ///< fraction of valid samples, 0 to 1
  std::string trap{};       ///< caveat for its users; may be empty
  bool is_verified = true;  ///< the name is in a public document of the aircraft
  std::vector<std::string> others{};  ///< other variables that match the role
  std::string why{};                  ///< evidence, if the name is not one of the aircraft's; otherwise empty
};

/// Defect or coarse resolution of a variable.
struct Problem {
  std::string variable;
  std::string kind;   ///< "jump", "recorded in steps"
  std::string times;  ///< UTC
  double number = 0.0;
  std::string unit;
  std::string action;  ///< action taken, and how to change it
};

/// Variable that may match a role, by name, long name, unit and values.
struct InspectedCandidate {
  std::string variable;
  double score = 0.0;  ///< 0 to 1
  std::string why;
};

/// Role without a variable, and the consequence.
struct MissingRole {
  std::string role;
  std::string description;
  std::vector<std::string> looked_for;  ///< searched names of variables
  /// Consequence, a clause without full stop; empty if the role is not needed.
  std::string cost;
  std::vector<std::string> effects;  ///< effects of the catalogue that cannot be fitted or diagnosed
};

/// Contents of a flight.
struct Inspection {
  std::string path;
  std::string aircraft{};
  std::string project{};
  std::string flight{};
  std::string institution{};
  std::string family{};  ///< naming convention, e.g. "faam-core"
  std::string family_title{};
  std::vector<std::string> alike{};  ///< matching naming conventions; several: ambiguous, empty: unknown
  TimeAxis time{};
  std::size_t records = 0;
  std::map<int, std::size_t> rates{};  ///< number of variables for each number of samples per record
  std::vector<InspectedRole> roles{};
  std::vector<MissingRole> missing{};
  /// Candidates for each role, by decreasing score.
  std::map<std::string, std::vector<InspectedCandidate>> candidates{};
  std::vector<std::string> not_used{};  ///< variables without a role that are not candidates either
  std::vector<Problem> problems{};
  /// References to which a model can be fitted, as for `--reference`: "wind" and "height"; may be empty.
  std::vector<std::string> references{};
  std::string why_no_model{};          ///< reason why the flight has no model; empty if it has one
  bool has_results = false;            ///< true: its inputs have names used for results of `process`
  bool is_corrected = false;           ///< true: the pressures of the model are already corrected
  std::string corrected_pressure{};    ///< static pressure corrected in the flight file; may be empty
  std::vector<FrozenSpan> frozen{};    ///< sensors with constant readings for longer than their noise permits
  std::vector<Interval> intervals{};   ///< regimes of the flight; empty without pressures
  std::vector<ModelCandidate> laws{};  ///< models for this aircraft, best match first
  std::optional<GpsDesign> by_gps{};   ///< empty without pressures or GPS
  std::vector<std::string> notes{};
  /// Runnable model: the roles, and terms with zero coefficients for a refit; empty without pressures.
  std::optional<ModelDefinition> model{};
  std::shared_ptr<const FlightSamples> samples{};  ///< samples of the figures; nullptr without pressures
};

/// Inspects a flight: metadata, variables of the roles, missing roles and their consequences, regimes, and
/// matching models among `laws` (model files). Unreadable files of `laws` are reported in a note.
/// @param roles naming convention: an aircraft of data/aircraft, or a file with the suffix ".toml"; default:
/// detected from the flight
/// @throws Error if the flight cannot be read, or the naming convention does not exist
Inspection inspect_flight(const std::filesystem::path& path,
                          const std::vector<std::filesystem::path>& laws = {},
                          TimestampAlignment timestamp_alignment = TimestampAlignment::begin,
                          const std::string& roles = "");

}  // namespace pcor

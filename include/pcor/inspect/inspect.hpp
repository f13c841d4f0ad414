#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <pcor/base/note.hpp>
#include <pcor/flight/flight.hpp>
#include <pcor/model_io/model_definition.hpp>
#include <pcor/regimes/regimes.hpp>
#include <pcor/report/report.hpp>
#include <pcor/residuals/samples.hpp>
#include <pcor/residuals/statistics.hpp>
#include <pcor/roles/model_candidates.hpp>
#include <pcor/roles/role_candidate.hpp>

namespace pcor {

/// How well the manoeuvres of a flight determine delta-p by GPS: standard errors, hPa.
struct GpsDesign {
  double level = 0.0;   ///< mean over the flight
  double slope = 0.0;   ///< change with the airspeed at one static pressure, rms over the flight
  double attack = 0.0;  ///< change with the attack, rms over the flight; NaN without that term
  bool by_wind = false;
  bool by_height = false;

  bool determines_level() const { return level < max_defect_error; }
};

template <class Field>
void describe(const GpsDesign& self, Field& field) {
  field("level", self.level, "standard error of the mean of delta-p over the flight", "hPa");
  field("slope", self.slope, "standard error of its change with the airspeed, rms over the flight", "hPa");
  field("attack", self.attack, "standard error of its change with the attack, rms over the flight", "hPa");
}

/// Errors that a refit with `--reference wind --reference height` would state, from the manoeuvres and the
/// gusts alone, before any fit, with usual sizes of the variations of the atmosphere. An error of several hPa
/// is that of the prior: the flight does not determine this part.
/// @param model with the roles, and terms that a refit finds
/// @return empty without velocity over the ground and height
std::optional<GpsDesign> gps_design(const Flight& flight, const ModelDefinition& model);

/// Variable found for a role.
struct InspectedRole {
  std::string role;      ///< "vertical_speed"; also series without a role in a model, such as "longitude"
  std::string variable;  ///< "VELD_GIN"
  std::string unit;      ///< unit in the file, corrected by the data of its aircraft
  bool is_sign_inverted = false;      ///< true: its sign is opposite to that of the role
  int rate = 1;                       ///< samples per record
  double present = 0.0;               ///< fraction of valid samples, 0 to 1
  std::string caveat{};               ///< caveat for its users; may be empty
  bool is_verified = true;            ///< the name is in a public document of the aircraft
  std::vector<std::string> others{};  ///< other variables that match the role
  std::string why{};                  ///< evidence, if the name is not one of the aircraft's; otherwise empty
};

template <class Field>
void describe(const InspectedRole& self, Field& field) {
  field("variable", self.variable, "variable of the flight");
  field("unit", self.unit, "unit in the file, corrected by the data of the aircraft");
  field("sign", self.is_sign_inverted ? "-" : "+",
        "-: the sign of the variable is opposite to that of the role");
  field("rate", self.rate, "samples in a record");
  field("present", self.present, "fraction of valid samples");
  field("trap", self.caveat, "caveat for users of the variable");
  field("verified", self.is_verified, "whether the name is in a public document of the aircraft");
  field("others", self.others, "other variables that match the role");
  field("why", self.why, "evidence, if the name is not one of the aircraft");
}

/// Defect or coarse resolution of a variable, or its contradiction of another one.
struct Problem {
  std::string variable;
  std::string kind;   ///< "jump", "recorded in steps", "temperature against height"
  std::string times;  ///< UTC
  double number = 0.0;
  std::string unit;
  std::string action;  ///< action taken, and how to change it
};

template <class Field>
void describe(const Problem& self, Field& field) {
  field("variable", self.variable, "variable of the flight");
  field("kind", self.kind, "jump, recorded in steps, or contradiction of another variable");
  field("times", self.times, "times of the problem, UTC");
  field("number", self.number, "size of the problem", "see unit");
  field("unit", self.unit, "unit of the number");
  field("action", self.action, "action taken, and how to change it");
}

/// Role without a variable, and the consequence.
struct MissingRole {
  std::string role;
  std::string description;
  std::vector<std::string> searched_names;  ///< searched names of variables
  /// Consequence, a clause without full stop; empty if the role is not needed.
  std::string cost;
  std::vector<std::string> effects;  ///< effects of the catalogue that cannot be fitted or diagnosed
};

template <class Field>
void describe(const MissingRole& self, Field& field) {
  field("role", self.role, "role without a variable");
  field("looked_for", self.searched_names, "names of variables that were searched");
  field("cost", self.cost, "consequence; empty if the role is not needed");
  field("effects", self.effects, "effects that cannot be fitted or diagnosed");
}

/// Contents of a flight.
struct Inspection {
  std::string path;
  std::string aircraft{};
  std::string project{};
  std::string flight{};
  std::string institution{};
  std::string naming{};  ///< naming convention, e.g. "faam-core"
  std::string naming_title{};
  /// Naming conventions that match; several: ambiguous, empty: unknown.
  std::vector<std::string> matching_namings{};
  TimeAxis time{};
  std::size_t records = 0;
  std::map<int, std::size_t> rates{};  ///< number of variables for each number of samples per record
  std::vector<InspectedRole> roles{};
  std::vector<MissingRole> missing{};
  /// Candidates for each role, by decreasing score.
  std::map<std::string, std::vector<RoleCandidate>> candidates{};
  std::vector<std::string> not_used{};  ///< variables without a role that are not candidates either
  std::vector<Problem> problems{};
  /// References to which a model can be fitted, as for `--reference`: "lams", "pressure:PS_A", "wind"; may be
  /// empty.
  std::vector<std::string> references{};
  std::string why_no_model{};          ///< reason why the flight has no model; empty if it has one
  bool is_corrected = false;           ///< true: the pressures of the model are already corrected
  std::vector<FrozenSpan> frozen{};    ///< sensors with constant readings for longer than their noise permits
  std::vector<Interval> intervals{};   ///< regimes of the flight; empty without pressures
  std::vector<ModelCandidate> laws{};  ///< models for this aircraft, best match first
  std::optional<GpsDesign> by_gps{};   ///< empty without pressures or GPS
  std::vector<std::string> next{};     ///< commands that continue, filled by a program that knows its name
  std::string unreadable{};            ///< reason if the flight cannot be read, filled by the caller
  Notes notes{};
  /// Runnable model: the roles, and terms with zero coefficients for a refit; empty without pressures.
  std::optional<ModelDefinition> model{};
  std::shared_ptr<const FlightSamples> samples{};  ///< samples of the figures; nullptr without pressures
};

template <class Field>
void describe(const Inspection& self, Field& field) {
  field("path", self.path, "file of the flight");
  if (field.has(!self.unreadable.empty()))
    field("unreadable", self.unreadable, "reason, if unreadable; no other keys then");
  if (!field.has(self.unreadable.empty())) return;
  field("aircraft", self.aircraft, "aircraft, from the attributes of the file");
  field("project", self.project, "project, from the attributes of the file");
  field("flight", self.flight, "number of the flight, from the attributes of the file");
  field("institution", self.institution, "institution, from the attributes of the file");
  field("names_of", self.naming, "naming convention of the variables");
  field("alike", self.matching_namings, "matching naming conventions");
  const double highest_rate = self.rates.empty() ? 0.0 : self.rates.rbegin()->first / self.time.step;
  field("rate_hz", highest_rate, "highest rate of a variable");
  field("records", self.records, "number of records");
  field.time("begin", self.time.first, "time of the first record");
  field.time("end", self.time.last, "time of the last record");
  field("gaps", self.time.gap_count, "number of gaps in time");
  std::vector<std::pair<std::string, InspectedRole>> roles;
  for (const InspectedRole& role : self.roles) roles.emplace_back(role.role, role);
  field("roles", roles, "variable of each role");
  field("missing", self.missing, "roles without a variable");
  field.list(
      "frozen", self.frozen, "sensors with constant readings", [&](const FrozenSpan& span, Field& frozen) {
        const auto time = [&](std::size_t sample) { return self.samples ? self.samples->time[sample] : 0.0; };
        frozen("role", span.quantity == Quantity::count ? "" : info_of(span.quantity).name,
               "role of the sensor");
        frozen.time("begin", time(span.first), "first sample");
        frozen.time("end", time(span.first + span.count - 1), "last sample");
      });
  field.list("regimes", self.intervals, "regimes of the flight", [](const Interval& interval, Field& regime) {
    regime("name", interval.regime == Regime::count ? "" : info_of(interval.regime).name, "regime");
    regime.time("begin", interval.begin, "begin of the interval");
    regime.time("end", interval.end, "end of the interval");
  });
  field("determines", self.by_gps, "how well GPS determines delta-p on this flight; absent without GPS");
  field("laws", self.laws, "models for this aircraft, best match first");
  field("candidates", self.candidates, "variables that may match each role, by decreasing score");
  field("not_used", self.not_used, "variables without a role, except candidates");
  field("problems", self.problems, "defects and coarse resolution of variables");
  field("why_no_model", self.why_no_model, "reason if the flight has no model");
  field("next", self.next, "commands that continue");
  field("notes", self.notes, "notes on the flight");
}

/// Inspects a flight: metadata, variables of the roles, missing roles and their consequences, regimes, and
/// matching models among `laws` (model files). Unreadable files of `laws` are reported in a note.
/// @param roles naming convention: an aircraft of data/aircraft, or a file with the suffix ".toml"; default:
/// detected from the flight
/// @throws Error if the flight cannot be read, or the naming convention does not exist
Inspection inspect_flight(const std::filesystem::path& path,
                          const std::vector<std::filesystem::path>& laws = {},
                          TimestampAlignment timestamp_alignment = TimestampAlignment::begin,
                          const std::string& roles = "");

/// Page of `pcor inspect`: track, height, speed and regimes of the flights, and tables of roles and missing
/// roles.
Report inspection_report(const std::vector<Inspection>& flights);

}  // namespace pcor

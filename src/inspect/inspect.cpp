#include <pcor/inspect/inspect.hpp>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <set>

#include <pcor/base/error.hpp>
#include <pcor/base/utc.hpp>
#include <pcor/effects/catalogue.hpp>
#include <pcor/residuals/reference.hpp>
#include <pcor/roles/resolve_variables.hpp>
#include "inspect/plausibility.hpp"
#include "residuals/ground_velocity.hpp"
#include "roles/computed_from.hpp"
#include "roles/model_inputs.hpp"
#include "roles/pressure_height.hpp"
#include "roles/recorded_series.hpp"
#include "roles/resolution.hpp"
#include "roles/role_evidence.hpp"
#include "roles/usual_variables.hpp"

namespace pcor {

using namespace internal;

namespace {

/// Consequences of missing series, in addition to the effects that need them.
constexpr std::array<std::pair<std::string_view, std::string_view>, 14> costs{{
    {"recovery_temperature",
     "no airspeed and no delta-p from LAMS, unless the temperature of the air is recorded"},
    {"dew_point", "the air is assumed dry, unless the vapour pressure is recorded"},
    {"lams_airspeed", "delta-p cannot be measured; use a second system, heights or winds as the reference"},
    {"attack", "the angle between laser beam and wind is unknown, and pitch manoeuvres need the pitch"},
    {"altitude", "no climbs, layers or hydrostatic temperature fit, unless another height is recorded"},
    {"vertical_speed", "it is computed from the altitude"},
    {"pitch", "pitch manoeuvres are found by the angle of attack, if that is recorded"},
    {"roll", "turns, circles and reverse headings are not found"},
    {"heading",
     "circles, reverse headings and yaw manoeuvres are found by the ground track, if that is recorded"},
    {"ground_speed", "winds cannot be compared"},
    {"ground_track", "winds cannot be compared"},
    {"flaps", "extended flaps are inferred from the lift"},
    {"liquid_water", "clouds are not found"},
    {"latitude", "standard gravity is used, and the slope of isobars is unknown"},
}};

/// Quantities from which a quantity is computed if it is not recorded.
std::vector<Quantity> sources_of(Quantity quantity) {
  for (const Rate& each : rates) {
    if (each.rate == quantity) return {each.quantity};
  }
  switch (quantity) {
    case Quantity::wetness:
      return {Quantity::liquid_water};
    case Quantity::attack_ratio:
      return {Quantity::attack_differential_pressure, Quantity::radome_dynamic_pressure};
    case Quantity::sideslip_ratio:
      return {Quantity::sideslip_differential_pressure, Quantity::radome_dynamic_pressure};
    default:
      return {quantity};
  }
}

/// Consequence if a series is not recorded; empty if no consequence is known.
std::string cost_of(std::string_view series) {
  const auto found =
      std::find_if(costs.begin(), costs.end(), [&](const auto& cost) { return cost.first == series; });
  return found == costs.end() ? "" : std::string(found->second);
}

/// Effects that need a role, also as a source of a derived quantity.
std::vector<std::string> effects_that_need(Quantity role) {
  std::vector<std::string> effects;
  for (const EffectInfo& info : effect_info) {
    bool needs = false;
    for (std::size_t i = 0; i < info.need_count(); ++i) {
      const std::vector<Quantity> sources = sources_of(info.needs[i]);
      needs = needs || std::find(sources.begin(), sources.end(), role) != sources.end();
    }
    if (needs) effects.emplace_back(info.id);
  }
  return effects;
}

/// Whether the words of a file state that a height is geometric.
bool says_geometric(const VariableInfo& variable) {
  std::vector<std::string> words = plain_words(variable.name);
  for (const std::string& word : plain_words(variable.long_name)) words.push_back(word);
  const std::string standard_name = variable.attribute("standard_name");
  if (standard_name == "altitude" || standard_name == "height_above_reference_ellipsoid") return true;
  constexpr std::array<std::string_view, 7> geometric{"gps",   "gnss",      "wgs", "geometric",
                                                      "geoid", "ellipsoid", "msl"};
  return std::any_of(words.begin(), words.end(), [&](const std::string& word) {
    return std::find(geometric.begin(), geometric.end(), word) != geometric.end();
  });
}

/// One flight that is looked at.
class Look {
 public:
  Look(const std::filesystem::path& path, TimestampAlignment timestamp_alignment, const std::string& roles)
      : flight_(path, timestamp_alignment),
        roles_(roles),
        naming_(roles.empty() ? naming_of(flight_) : naming_by_name(roles)) {
    result_.path = path.string();
  }

  Inspection run(const std::vector<std::filesystem::path>& laws) {
    identify();
    find_candidates();
    find_model();
    find_roles();
    mark_replaced();
    find_unused();
    look_at_samples();
    if (result_.model) {
      for (Problem& problem : find_problems(flight_, *result_.model))
        result_.problems.push_back(std::move(problem));
    }
    state_rounding();
    result_.laws = model_candidates(flight_, laws, result_.notes);
    find_reference();
    note_undetermined_level();
    return std::move(result_);
  }

 private:
  void identify() {
    result_.aircraft = flight_.aircraft();
    result_.project = flight_.project();
    result_.flight = flight_.flight_number();
    for (const char* name : {"institution", "Institution", "Source", "source"}) {
      if (result_.institution.empty()) result_.institution = flight_.attribute(name);
    }
    result_.naming = naming_.name;
    result_.naming_title = naming_.title;
    if (roles_.empty()) {
      for (const VariableNaming* naming : matching_namings(flight_))
        result_.matching_namings.push_back(naming->name);
    } else {
      result_.matching_namings = {naming_.name};
    }
    result_.time = flight_.time();
    result_.records = flight_.records();
    for (const std::string& name : flight_.variables()) {
      const VariableInfo& info = flight_.variable(name);
      if (info.is_series) ++result_.rates[info.rate];
    }
  }

  /// Uses the first convention if several match.
  void find_model() {
    ModelDefinition model;
    // The path to a file of the user is absolute, so that the model may be moved.
    model.roles_from =
        roles_.empty() || roles_ == naming_.name ? naming_.name : std::filesystem::absolute(roles_).string();
    model.model.aircraft = result_.aircraft;
    model.model.name =
        fmt::format("{} as recorded", result_.aircraft.empty() ? naming_.title : result_.aircraft);
    Notes notes;
    try {
      model = resolve_variables(model, flight_, notes);
    } catch (const Error& error) {
      if (error.code() == Error::Code::file) throw;
      if (!take_pressures_by_evidence(model)) {
        result_.why_no_model = what_pressures_lack(error);
        result_.notes.push_back(result_.why_no_model);
        return;
      }
    }
    const PressurePair pair{model.variables[Quantity::static_pressure],
                            model.variables[Quantity::dynamic_pressure]};
    const std::vector<PressurePair>& processed = naming_.processed;
    result_.is_corrected = std::find(processed.begin(), processed.end(), pair) != processed.end();
    if (result_.is_corrected) {
      result_.notes.push_back(warning_note(fmt::format("{} and {} are already corrected by the archive",
                                                       pair.static_pressure, pair.dynamic_pressure)));
    }
    if (const auto altitude = model.variables.find(Quantity::altitude);
        altitude != model.variables.end() && pressure_altitudes_.count(altitude->second) != 0)
      model.variables.erase(altitude);
    add_roles_by_evidence(model);
    const auto has = [&model](Quantity role) { return model.variables.count(role) != 0; };
    model.model.effects = {neutral_effect("static-constant"), neutral_effect("static-qp")};
    if (has(Quantity::radome_dynamic_pressure) && has(Quantity::attack_differential_pressure)) {
      model.model.effects.push_back(neutral_effect("static-alpha"));
    } else if (has(Quantity::attack)) {
      model.model.effects.push_back(neutral_effect("static-attack"));
    }
    model.law.source = source_without_law;
    result_.model = std::move(model);
  }

  void find_candidates() {
    result_.candidates = role_candidates(flight_);
    tell_heights_apart();
  }

  /// A pressure altitude is not a height of GPS under any name; a height that may be either is not sure.
  void tell_heights_apart() {
    constexpr std::string_view series = "altitude";
    std::vector<StatedPressure> pressures = static_pressures_of(flight_, ModelDefinition());
    for (const RoleCandidate& candidate : result_.candidates["static_pressure"]) {
      if (std::none_of(pressures.begin(), pressures.end(),
                       [&](const StatedPressure& each) { return each.variable == candidate.variable; }))
        pressures.push_back({candidate.variable, naming_.unit_of(candidate.variable)});
    }
    const QuantityInfo& info = *series_named(series);
    const std::string whole_flight =
        fmt::format("{} to {}", utc_text(flight_.time().first), utc_text(flight_.time().last, "%H:%M:%S"));
    const auto evidence_of = [&](const std::string& variable) {
      const UnitConversion conversion =
          flight_.conversion(variable, std::string(info.unit), "", naming_.unit_of(variable));
      const HeightEvidence evidence = height_evidence(
          flight_, read_values(flight_, variable, within_plausible_range(conversion, info)).values,
          pressures);
      if (evidence.kind == HeightEvidence::Kind::pressure_altitude &&
          pressure_altitudes_.insert(variable).second) {
        result_.problems.push_back(
            {variable, "pressure altitude, consistent with " + evidence.pressure, whole_flight,
             evidence.scatter, "hPa",
             "not used as altitude, because it is not a GPS height: a fit to it would be circular"});
      }
      if (const std::string problem = evidence.slope_problem(variable);
          !problem.empty() && impossible_heights_.insert(variable).second) {
        result_.problems.push_back({variable, "change of height impossible for the pressure", whole_flight,
                                    evidence.slope, "times the pressure altitude", problem});
      }
      return evidence;
    };
    for (const std::string& name : naming_.names_of(series)) {
      if (has_values(flight_, name, std::string(info.unit), naming_.unit_of(name))) evidence_of(name);
    }
    std::vector<RoleCandidate>& candidates = result_.candidates[std::string(series)];
    for (RoleCandidate& each : candidates) {
      if (!is_convertible(flight_.variable(each.variable).units, std::string(info.unit))) continue;
      const HeightEvidence evidence = evidence_of(each.variable);
      if (evidence.kind == HeightEvidence::Kind::gps) continue;
      each.why += "; " + to_string(evidence);
      if (evidence.kind == HeightEvidence::Kind::pressure_altitude) {
        result_.candidates["other_altitude"].push_back(each);
      } else if (!says_geometric(flight_.variable(each.variable))) {
        each.score = std::min(each.score, sure_score - 0.01);
        result_.notes.push_back(fmt::format(
            "write altitude = \"{0}\" into [variables] of the model if {0} is a GPS height; {0} is "
            "not used because it may be a pressure altitude: {1}",
            each.variable, to_string(evidence)));
      }
    }
    candidates.erase(std::remove_if(candidates.begin(), candidates.end(),
                                    [this](const RoleCandidate& each) {
                                      return pressure_altitudes_.count(each.variable) != 0;
                                    }),
                     candidates.end());
    for (const char* const name : {"altitude", "other_altitude", "static_pressure"}) {
      const auto found = result_.candidates.find(name);
      if (found == result_.candidates.end()) continue;
      if (found->second.empty()) {
        result_.candidates.erase(found);
        continue;
      }
      std::stable_sort(found->second.begin(), found->second.end(),
                       [](const RoleCandidate& a, const RoleCandidate& b) { return a.score > b.score; });
    }
  }

  /// The best candidate for a role; null if it is not sure.
  const RoleCandidate* sure_candidate(const std::string& series) const {
    if (!roles_.empty()) return nullptr;  // the user has chosen the names
    // A Mach number of the recording system is made of the pressures, and no independent one.
    if (series == info_of(Quantity::mach).name) return nullptr;
    const std::vector<RoleCandidate>& candidates = candidates_for(series);
    return is_sure(candidates) ? &candidates.front() : nullptr;
  }

  const std::vector<RoleCandidate>& candidates_for(const std::string& series) const {
    static const std::vector<RoleCandidate> none;
    const auto found = result_.candidates.find(series);
    return found == result_.candidates.end() ? none : found->second;
  }

  /// Finds the pressure pair of a file that matches no naming convention. The names then apply to this flight
  /// only.
  bool take_pressures_by_evidence(ModelDefinition& model) {
    if (!roles_.empty()) return false;
    const std::vector<RoleCandidate>& static_pressures = candidates_for("static_pressure");
    const std::vector<RoleCandidate>& dynamic_pressures = candidates_for("dynamic_pressure");
    if (static_pressures.empty() || dynamic_pressures.empty() ||
        static_pressures.front().variable == dynamic_pressures.front().variable)
      return false;
    model.roles_from.clear();
    model.variables[Quantity::static_pressure] = static_pressures.front().variable;
    model.variables[Quantity::dynamic_pressure] = dynamic_pressures.front().variable;
    for (const auto* candidates : {&static_pressures, &dynamic_pressures}) {
      if (is_sure(*candidates)) continue;
      result_.notes.push_back(fmt::format(
          "{} as {} is a guess: {}{}", candidates->front().variable,
          candidates == &static_pressures ? "static_pressure" : "dynamic_pressure", candidates->front().why,
          candidates->size() > 1
              ? fmt::format("; its rival is {}: {}", (*candidates)[1].variable, (*candidates)[1].why)
              : ""));
    }
    return true;
  }

  /// The error; if one of the two pressures was found, its name and the next step.
  std::string what_pressures_lack(const Error& error) const {
    const bool has_static = result_.candidates.count("static_pressure") != 0;
    const bool has_dynamic = result_.candidates.count("dynamic_pressure") != 0;
    if (!roles_.empty() || has_static == has_dynamic) return error.what();
    const std::string found = has_static ? "static" : "dynamic";
    const std::string missing = has_static ? "dynamic" : "static";
    const RoleCandidate& candidate = result_.candidates.at(found + "_pressure").front();
    return fmt::format(
        "{}: {} is a {} pressure ({}), but no {} pressure of a known name, unit and size was found; get the "
        "file with the {} pressure, or name it in the [variables] of a model",
        flight_.path().string(), candidate.variable, found, candidate.why, missing, missing);
  }

  /// Adds roles that the aircraft's names do not determine. A recorded Mach number is computed from the
  /// pressures, so it is not used.
  void add_roles_by_evidence(ModelDefinition& model) {
    const auto has = [&model](Quantity role) { return model.variables.count(role) != 0; };
    // A model has one temperature and one humidity.
    constexpr std::array temperatures{Quantity::recovery_temperature, Quantity::ambient_temperature};
    const auto has_another = [&has](Quantity role, const auto& alternatives) {
      return std::find(alternatives.begin(), alternatives.end(), role) != alternatives.end() &&
             std::any_of(alternatives.begin(), alternatives.end(), has);
    };
    for (std::size_t i = 0; i < role_count; ++i) {
      const auto role = static_cast<Quantity>(i);
      const std::string name(info_of(role).name);
      const RoleCandidate* const candidate = sure_candidate(name);
      const bool is_known =
          !result_.matching_namings.empty() && !first_with_values(flight_, naming_, name).empty();
      const bool is_chosen =
          has(role) || is_known || has_another(role, temperatures) || has_another(role, humidity_roles);
      if (candidate == nullptr || is_chosen) continue;
      const bool plays_a_role =
          std::any_of(model.variables.begin(), model.variables.end(),
                      [&](const auto& each) { return each.second == candidate->variable; });
      if (!plays_a_role) model.variables[role] = candidate->variable;
    }
    model.model.moist = std::any_of(humidity_roles.begin(), humidity_roles.end(), has);
  }

  /// Whether a variable belongs to a pair from the flight's own processing, by the aircraft's names.
  bool is_processed(const std::string& variable) const {
    return std::any_of(naming_.processed.begin(), naming_.processed.end(), [&](const PressurePair& pair) {
      return variable == pair.static_pressure || variable == pair.dynamic_pressure;
    });
  }

  /// Lists every variable without a role that is not a candidate for one either.
  void find_unused() {
    std::set<std::string> used{flight_.time_variable()};
    for (const InspectedRole& role : result_.roles) {
      used.insert(role.variable);
      used.insert(role.others.begin(), role.others.end());
    }
    for (const auto& [series, candidates] : result_.candidates) {
      for (const RoleCandidate& each : candidates) used.insert(each.variable);
    }
    std::vector<std::string> ignored;
    for (const std::string& name : flight_.variables()) {
      if (used.count(name) == 0) result_.not_used.push_back(name);
      const VariableInfo& info = flight_.variable(name);
      if (!info.ignored_range.empty()) ignored.push_back(fmt::format("{} ({})", name, info.ignored_range));
    }
    if (!ignored.empty()) {
      result_.notes.push_back(
          fmt::format("the valid ranges of these variables in the file are not numbers and were ignored: {}",
                      fmt::join(ignored, ", ")));
    }
  }

  /// States rounding as the noise of coarse pressures.
  void state_rounding() {
    if (!result_.model) return;
    for (const Quantity role : {Quantity::static_pressure, Quantity::dynamic_pressure}) {
      const double step = resolution_of(read_role(flight_, *result_.model, role).values);
      if (step >= coarse_pressure)
        result_.model->uncertainty.roles[role] = 0.001 * std::round(1000.0 * rounding_of(step));
    }
  }

  /// Finds the reference for a fit: laser, avionics, pressures that the operator derived from other sensors,
  /// heights. A pressure derived from the model's own pressures is not a reference.
  void find_reference() {
    if (!result_.model) return;
    const ModelDefinition& model = *result_.model;
    const auto has = [&](Quantity role) { return model.variables.count(role) != 0; };
    const std::string avionics(avionics_static_pressure);
    const bool has_temperature = has(Quantity::recovery_temperature) || has(Quantity::ambient_temperature);
    const bool has_heights = has(Quantity::altitude) && has(Quantity::latitude) && has_temperature;
    const std::string corrected = processed_static_pressure(flight_, naming_);
    const bool is_independent =
        !corrected.empty() &&
        !is_computed_from(flight_, corrected, model.variables.at(Quantity::static_pressure));
    const bool has_wind = has_temperature && has(Quantity::heading) &&
                          !read_ground_velocity(flight_, model).speed.values.empty();
    std::vector<std::string>& references = result_.references;
    if (has(Quantity::lams_airspeed)) {
      references = {"lams"};
    } else if (model.variables.at(Quantity::static_pressure) != avionics &&
               has_values(flight_, avionics, "hPa")) {
      references = {fmt::format("pressure:{}", avionics)};
    } else if (is_independent &&
               (naming_.name != known_namings().front().name || (!has_heights && !result_.is_corrected))) {
      references = {"pressure:" + corrected};
    } else {
      if (has_wind) references.emplace_back("wind");
      if (has_heights) references.emplace_back("height");
    }
  }

  /// Warns if neither a published model nor a reference of this flight gives the level of delta-p.
  void note_undetermined_level() {
    const bool has_law = std::any_of(result_.laws.begin(), result_.laws.end(),
                                     [](const ModelCandidate& law) { return law.fits(); });
    const bool is_by_gps =
        std::all_of(result_.references.begin(), result_.references.end(),
                    [](const std::string& each) { return each == "wind" || each == "height"; });
    if (!result_.model || has_law || !is_by_gps || (result_.by_gps && result_.by_gps->determines_level()))
      return;
    result_.notes.push_back(warning_note(fmt::format(
        "a refit keeps the level of delta-p of the input model: the level needs a "
        "laser, a second static system or {}",
        result_.by_gps && result_.by_gps->by_wind ? "circles or reverse headings" : "wind by GPS")));
  }

  /// The part of a series that has values.
  double present(const std::string& variable) const {
    const int rate = flight_.variable(variable).rate;
    std::size_t there = 0;
    std::vector<double> values;
    for (const RecordBlock block : blocks_of(flight_.records())) {
      values.resize(block.count * static_cast<std::size_t>(rate));
      flight_.read(variable, block, UnitConversion(), values.data());
      there += static_cast<std::size_t>(
          std::count_if(values.begin(), values.end(), [](double x) { return std::isfinite(x); }));
    }
    return static_cast<double>(there) /
           static_cast<double>(flight_.records() * static_cast<std::size_t>(rate));
  }

  std::vector<std::string> names_of(const std::string& series) const {
    std::vector<std::string> names = naming_.names_of(series);
    const auto add = [&names](const std::string& name) {
      if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
    };
    for (const PressurePair& pair : naming_.measured) {
      if (series == info_of(Quantity::static_pressure).name) add(pair.static_pressure);
      if (series == info_of(Quantity::dynamic_pressure).name) add(pair.dynamic_pressure);
    }
    if (series == info_of(Quantity::recovery_temperature).name) {
      for (const Thermometer& thermometer : naming_.thermometers) add(thermometer.variable);
    }
    return names;
  }

  void find_roles() {
    for (const std::string& series : names_of_series()) {
      const QuantityInfo& info = *series_named(series);
      const std::vector<std::string> names = names_of(series);
      std::vector<std::string> found;
      for (const std::string& name : names) {
        const bool is_wrong_height = series == "altitude" && pressure_altitudes_.count(name) != 0;
        if (!is_wrong_height && has_values(flight_, name, std::string(info.unit), naming_.unit_of(name)))
          found.push_back(name);
      }
      if (const RoleCandidate* const candidate = sure_candidate(series);
          found.empty() && candidate != nullptr) {
        add_role(series, {candidate->variable});
        if (!is_processed(candidate->variable)) result_.roles.back().why = candidate->why;
        for (const RoleCandidate& each : result_.candidates.at(series)) {
          if (each.variable != candidate->variable) result_.roles.back().others.push_back(each.variable);
        }
      } else if (found.empty()) {
        add_missing(info, names);
      } else {
        add_role(series, found);
      }
    }
  }

  void add_role(const std::string& series, const std::vector<std::string>& found) {
    InspectedRole& role = result_.roles.emplace_back();
    role.role = series;
    role.variable = found.front();
    const std::string stated = naming_.unit_of(role.variable);
    role.unit = stated.empty() ? flight_.variable(role.variable).units : stated;
    role.is_sign_inverted =
        UnitConversion::between(role.unit, std::string(series_named(series)->unit), {}).scale() < 0.0;
    role.rate = flight_.variable(role.variable).rate;
    role.present = present(role.variable);
    const auto caveat = naming_.caveats.find(role.variable);
    if (caveat != naming_.caveats.end()) role.caveat = caveat->second;
    role.is_verified = std::find(naming_.unverified.begin(), naming_.unverified.end(), role.variable) ==
                       naming_.unverified.end();
    role.others.assign(found.begin() + 1, found.end());
  }

  void add_missing(const QuantityInfo& info, const std::vector<std::string>& names) {
    MissingRole missing{std::string(info.name), std::string(info.description), names, cost_of(info.name), {}};
    const Quantity role = quantity_named(info.name);
    if (role == Quantity::mach || role == Quantity::date) return;  // pressures and times give these
    // The components give these.
    if ((role == Quantity::ground_speed || role == Quantity::ground_track) && has_ground_components()) return;
    if (role != Quantity::count) missing.effects = effects_that_need(role);
    if (!missing.cost.empty() || !missing.effects.empty() || !names.empty())
      result_.missing.push_back(std::move(missing));
  }

  bool has_ground_components() const {
    return !first_with_values(flight_, naming_, "ground_speed_east").empty() &&
           !first_with_values(flight_, naming_, "ground_speed_north").empty();
  }

  /// States a role of the table that the model does not read, because another role replaces it.
  void mark_replaced() {
    if (!result_.model) return;
    const std::map<Quantity, std::string>& variables = result_.model->variables;
    for (const auto& [role, other] :
         {std::pair(Quantity::ambient_temperature, Quantity::recovery_temperature),
          std::pair(Quantity::dew_point, Quantity::vapor_pressure),
          std::pair(Quantity::frost_point, Quantity::vapor_pressure),
          std::pair(Quantity::frost_point, Quantity::dew_point)}) {
      const auto reads = variables.find(other);
      if (variables.count(role) != 0 || reads == variables.end()) continue;
      for (InspectedRole& each : result_.roles) {
        if (each.role != info_of(role).name) continue;
        each.caveat += fmt::format("{}not in the model, which reads {} = {} instead",
                                   each.caveat.empty() ? "" : "; ", info_of(other).name, reads->second);
      }
    }
  }

  void look_at_samples() {
    if (!result_.model) return;
    const std::string pressure = result_.model->variables.at(Quantity::static_pressure);
    try {
      const auto samples = std::make_shared<FlightSamples>(
          read_samples(flight_, *result_.model, *pressure_reference(pressure), MaskOptions()));
      result_.frozen = samples->model.frozen;
      result_.intervals = samples->intervals;
      for (const Note& note : samples->notes) result_.notes.push_back(note);
      result_.samples = samples;
      result_.by_gps = gps_design(flight_, *result_.model);
    } catch (const Error& error) {
      if (error.code() == Error::Code::file) throw;
      result_.notes.emplace_back(error.what());
    }
  }

  Flight flight_;
  std::string roles_;
  const VariableNaming& naming_;
  std::set<std::string> pressure_altitudes_;
  std::set<std::string> impossible_heights_;
  Inspection result_;
};

}  // namespace

Inspection inspect_flight(const std::filesystem::path& path, const std::vector<std::filesystem::path>& laws,
                          TimestampAlignment timestamp_alignment, const std::string& roles) {
  return Look(path, timestamp_alignment, roles).run(laws);
}

}  // namespace pcor

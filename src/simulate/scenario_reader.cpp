#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>
#include <pcor/base/error.hpp>
#include <pcor/simulate/simulate.hpp>
#include <utility>

#include "base/phrasing.hpp"
#include "base/quoting.hpp"
#include "base/text_file.hpp"
#include "base/toml_reader.hpp"
#include "simulate/aircraft.hpp"
#include "simulate/effects.hpp"
#include "simulate/flight_plan.hpp"
#include "simulate/truth.hpp"

namespace pcor {

using namespace internal;

namespace {

using namespace simulate;

constexpr std::string_view scenario_format = "pcor-scenario/1";

constexpr double min_height = 10.0;  // m above the ground, of a low pass

/// The values that a number may have, with its unit for the message.
struct Domain {
  double minimum;
  double maximum;
  std::string_view unit;
};

constexpr double unlimited = 1e9;

/// Number of a table: key, destination and domain.
template <class Object>
struct NumberKey {
  std::string_view key;
  double Object::*value;
  Domain domain;
};

constexpr std::array<NumberKey<Scenario>, 5> scenario_keys{{
    {"latitude", &Scenario::latitude, {-85.0, 85.0, "deg"}},
    {"longitude", &Scenario::longitude, {-180.0, 180.0, "deg"}},
    {"heading", &Scenario::heading, {0.0, 360.0, "deg"}},
    {"weight", &Scenario::weight, {10000.0, 90000.0, "kg"}},
    {"recovery_factor", &Scenario::recovery_factor, {0.0, 1.2, ""}},
}};

constexpr std::array<NumberKey<Scenario::Atmosphere>, 18> atmosphere_keys{{
    {"ground_pressure", &Scenario::Atmosphere::ground_pressure, {500.0, 1100.0, "hPa"}},
    {"ground_height", &Scenario::Atmosphere::ground_height, {-400.0, 5000.0, "m"}},
    {"ground_temperature", &Scenario::Atmosphere::ground_temperature, {220.0, 330.0, "K"}},
    {"lapse_rate", &Scenario::Atmosphere::lapse_rate, {-5.0, 12.0, "K/km"}},
    {"inversion_height", &Scenario::Atmosphere::inversion_height, {0.0, 20000.0, "m"}},
    {"inversion_strength", &Scenario::Atmosphere::inversion_strength, {0.0, 20.0, "K"}},
    {"tropopause", &Scenario::Atmosphere::tropopause, {5000.0, 18000.0, "m"}},
    {"ground_humidity", &Scenario::Atmosphere::ground_humidity, {0.1, 100.0, "%"}},
    {"upper_humidity", &Scenario::Atmosphere::upper_humidity, {0.1, 100.0, "%"}},
    {"wind_speed", &Scenario::Atmosphere::wind_speed, {0.0, 40.0, "m/s"}},
    {"wind_from", &Scenario::Atmosphere::wind_from, {0.0, 360.0, "deg"}},
    {"wind_shear", &Scenario::Atmosphere::wind_shear, {-5.0, 10.0, "m/s per km"}},
    {"wind_drift", &Scenario::Atmosphere::wind_drift, {0.0, 10.0, "m/s"}},
    {"wind_drift_time", &Scenario::Atmosphere::wind_drift_time, {1.0, 1e5, "s"}},
    {"turbulence", &Scenario::Atmosphere::turbulence, {1e-9, 0.1, "m2/s3"}},
    {"boundary_layer", &Scenario::Atmosphere::boundary_layer, {1e-9, 0.1, "m2/s3"}},
    {"pressure_height_east", &Scenario::Atmosphere::pressure_height_east, {-100.0, 100.0, "m per 100 km"}},
    {"pressure_height_north", &Scenario::Atmosphere::pressure_height_north, {-100.0, 100.0, "m per 100 km"}},
}};

constexpr std::array<NumberKey<Scenario::Cloud>, 4> cloud_keys{{
    {"base", &Scenario::Cloud::base, {-400.0, 20000.0, "m"}},
    {"top", &Scenario::Cloud::top, {-400.0, 20000.0, "m"}},
    {"liquid", &Scenario::Cloud::liquid, {0.0, 10.0, "g/m3"}},
    {"cover", &Scenario::Cloud::cover, {0.0, 1.0, ""}},
}};

constexpr std::array<NumberKey<Scenario::Noise>, 4> noise_keys{{
    {"rms", &Scenario::Noise::rms, {0.0, unlimited, ""}},
    {"bias", &Scenario::Noise::bias, {-unlimited, unlimited, ""}},
    {"memory", &Scenario::Noise::memory, {0.0, 1e5, "s"}},
    {"resolution", &Scenario::Noise::resolution, {0.0, unlimited, ""}},
}};

constexpr std::array<NumberKey<Scenario::Lams>, 6> lams_keys{{
    {"elevation", &Scenario::Lams::elevation, {-45.0, 45.0, "deg"}},
    {"azimuth", &Scenario::Lams::azimuth, {-45.0, 45.0, "deg"}},
    {"mismatch", &Scenario::Lams::mismatch, {0.0, 10.0, "m/s"}},
    {"mismatch_memory", &Scenario::Lams::mismatch_memory, {0.0, 100.0, "s"}},
    {"dropout", &Scenario::Lams::dropout, {0.0, 1.0, ""}},
    {"clear_above", &Scenario::Lams::clear_above, {0.0, 50000.0, "m"}},
}};

constexpr std::array<NumberKey<Scenario::Avionics>, 2> avionics_keys{{
    {"response", &Scenario::Avionics::response, {0.0, 100.0, "s"}},
    {"delay", &Scenario::Avionics::delay, {-10.0, 10.0, "s"}},
}};

constexpr std::array<NumberKey<Scenario::Outliers>, 2> outlier_keys{{
    {"fraction", &Scenario::Outliers::fraction, {0.0, 1.0, ""}},
    {"size", &Scenario::Outliers::size, {0.0, unlimited, ""}},
}};

constexpr std::array<NumberKey<Scenario::Gap>, 2> gap_keys{{
    {"start", &Scenario::Gap::start, {0.0, unlimited, "s"}},
    {"duration", &Scenario::Gap::duration, {0.0, unlimited, "s"}},
}};

// The limits of altitude, speed, rate, low, high and amplitude depend on the leg and the aircraft
// (`leg_domain`).
constexpr std::array<NumberKey<Scenario::Leg>, 12> leg_keys{{
    {"duration", &Scenario::Leg::duration, {1.0, 86400.0, "s"}},
    {"altitude", &Scenario::Leg::altitude, {-400.0, unlimited, "m"}},
    {"speed", &Scenario::Leg::speed, {0.0, unlimited, "m/s"}},
    {"rate", &Scenario::Leg::rate, {0.5, 30.0, "m/s"}},
    {"low", &Scenario::Leg::low, {0.0, unlimited, "m/s"}},
    {"high", &Scenario::Leg::high, {0.0, unlimited, "m/s"}},
    {"period", &Scenario::Leg::period, {3.0, 120.0, "s"}},
    {"cycles", &Scenario::Leg::cycles, {1.0, 1000.0, ""}},
    {"amplitude", &Scenario::Leg::amplitude, {0.1, 15.0, "deg"}},
    {"roll", &Scenario::Leg::roll, {1.0, 60.0, "deg"}},
    {"angle", &Scenario::Leg::angle, {-3600.0, 3600.0, "deg"}},
    {"flaps", &Scenario::Leg::flaps, {0.0, 100.0, "percent"}},
}};

/// Domain of a number of a leg: the domain of its key, unless it depends on the kind or the aircraft.
Domain leg_domain(const NumberKey<Scenario::Leg>& number, Scenario::Leg::Kind kind,
                  const AircraftInfo& aircraft) {
  using Kind = Scenario::Leg::Kind;
  const bool slow = kind == Kind::take_off || kind == Kind::landing;
  if (number.key == "altitude") return {number.domain.minimum, aircraft.ceiling, "m"};
  if (number.key == "speed" || number.key == "low" || number.key == "high")
    return {slow ? aircraft.lift_off_speed : aircraft.min_speed, aircraft.max_speed, "m/s"};
  if (number.key == "rate" && kind == Kind::speed_run) return {0.05, 2.0, "m/s2"};
  if (number.key == "amplitude" && kind == Kind::pitch) return {0.1, 8.0, "m/s2"};
  return number.domain;
}

/// Domain of a parameter of an effect.
Domain parameter_domain(std::string_view key) {
  if (key == "tau" || key == "drying") return {0.0, 600.0, "s"};
  if (key == "seconds") return {-60.0, 60.0, "s"};
  if (key == "fraction") return {-1.0, 1.0, ""};
  if (key == "scale") return {-unlimited, unlimited, ""};
  return {-1e6, 1e6, ""};
}

/// The usual noise of every variable that the scenario's instruments record, by name.
///
/// Rms of 1-s means and resolutions, no biases: Cooper et al., wind uncertainty of the GV (NCAR technical
/// note), for pressures, attitude and GPS; others are estimates. GPS and heading errors have a memory of a
/// minute.
std::map<std::string, Scenario::Noise> usual_noise(const Scenario& scenario) {
  constexpr double minute = 60.0;  // s
  std::map<std::string, Scenario::Noise> noise{
      {"QCR", {0.03, 0.0, 0.0, 0.002}},    {"ADIFR", {0.02, 0.0, 0.0, 0.002}},
      {"BDIFR", {0.02, 0.0, 0.0, 0.002}},  {"EDPC", {0.02, 0.0, minute, 0.0}},
      {"DPXC", {0.1, 0.0, minute, 0.0}},   {"VLAMS", {0.05, 0.0, 0.0, 0.01}},
      {"PS_A", {0.1, 0.0, 0.0, 0.01}},     {"QC_A", {0.1, 0.0, 0.0, 0.01}},
      {"MACH_A", {2e-4, 0.0, 0.0, 1e-5}},  {"TASX", {0.2, 0.0, 0.0, 0.0}},
      {"PITCH", {0.02, 0.0, 0.0, 0.0}},    {"ROLL", {0.02, 0.0, 0.0, 0.0}},
      {"THDG", {0.04, 0.0, minute, 0.0}},  {"GGTRK", {0.02, 0.0, 0.0, 0.0}},
      {"GGSPD", {0.03, 0.0, minute, 0.0}}, {"GGALT", {0.15, 0.0, minute, 0.0}},
      {"GGVSPD", {0.03, 0.0, 0.0, 0.0}},   {"BNORMA", {0.02, 0.0, 0.0, 0.0}},
      {"PLWCC", {0.003, 0.0, 0.0, 0.0}},   {"PCAB", {0.2, 0.0, 0.0, 0.0}},
      {"ENGTRQ", {0.3, 0.0, 0.0, 0.0}},    {"TBAY", {0.05, 0.0, 0.0, 0.0}},
      {"RALT", {0.3, 0.0, 0.0, 0.0}},      {"BLONA", {0.02, 0.0, 0.0, 0.0}},
  };
  const AircraftInfo& aircraft = info_of(scenario.aircraft);
  for (const Thermometer& thermometer : {aircraft.thermometer, aircraft.second_thermometer})
    noise[std::string(thermometer.name)] = {0.1, 0.0, 0.0, 0.0};
  for (const Scenario::System& system : scenario.systems) {
    noise[system.static_pressure] = {0.01, 0.0, 0.0, 0.001};
    noise[system.dynamic_pressure] = {0.03, 0.0, 0.0, 0.001};
  }
  for (const TruthInfo& info : truth_info) {
    if (!info.recorded.empty()) noise.try_emplace(std::string(info.recorded));
  }
  return noise;
}

/// Reads a parsed file into a scenario, and rejects invalid contents with their position.
class Reader final : TomlReader {
 public:
  explicit Reader(std::string_view name) : TomlReader(name) { scenario_.file = name; }

  Scenario read(std::string_view text) {
    const toml::table root = parse(text);
    require_format(root, "a scenario", scenario_format);
    read_root(root);
    return std::move(scenario_);
  }

 private:
  std::string unknown(const Entry& entry) const override { return called(entry); }

  double number(const Entry& entry, const Domain& domain) const {
    const double value = TomlReader::number(entry);
    if (value < domain.minimum || value > domain.maximum) {
      const std::string unit = domain.unit.empty() ? "" : " " + std::string(domain.unit);
      fail(entry, "{} = {}{} is impossible; give a number from {} to {}{}", entry.key, value, unit,
           domain.minimum, domain.maximum, unit);
    }
    return value;
  }

  std::string one_of(const Entry& entry, const Names& known) const {
    std::string value = text(entry);
    if (std::find(known.begin(), known.end(), value) == known.end())
      fail(entry, "{}: {} is not a possible value; {}", called(entry), quote(value),
           suggestion_text(value, known));
    return value;
  }

  /// Calls `read(table, position)` for each table of a list of tables.
  template <class Read>
  void tables(const Entry& entry, Read read) const {
    const std::string requested = fmt::format("tables [[{}]]", entry.key);
    for (const toml::node& node : array(entry, requested)) {
      read(as<toml::table>(node, "this is not a table; give " + requested), node.source().begin);
    }
  }

  template <class Object, std::size_t count>
  Actions numbers(Object& object, const std::array<NumberKey<Object>, count>& keys) const {
    Actions actions;
    for (const NumberKey<Object>& key : keys) {
      actions.emplace_back(std::string(key.key), [this, &object, key](const Entry& entry) {
        object.*key.value = number(entry, key.domain);
      });
    }
    return actions;
  }

  // [noise] and [[leg]] depend on the sections before them, [[effect]] to [[gap]] on [noise].
  void read_root(const toml::table& root) {
    Actions actions = numbers(scenario_, scenario_keys);
    actions.insert(actions.end(),
                   {{"format", [](const Entry&) {}},
                    {"seed", [&](const Entry& entry) { read_seed(entry); }},
                    {"start", [&](const Entry& entry) { read_start(entry); }},
                    {"rate", [&](const Entry& entry) { read_rate(entry); }},
                    {"noiseless", [&](const Entry& entry) { scenario_.noise_on = !boolean(entry); }},
                    {"name", [&](const Entry& entry) { scenario_.name = text(entry); }},
                    {"aircraft", [&](const Entry& entry) { read_aircraft(entry); }},
                    {"atmosphere", [&](const Entry& section) { read_atmosphere(section); }},
                    {"system", [&](const Entry& section) { read_systems(section); }},
                    {"lams", [&](const Entry& section) { read_lams(section); }},
                    {"avionics", [&](const Entry& section) { read_avionics(section); }},
                    {"noise", [&](const Entry& section) { read_noise(section); }},
                    {"leg", [&](const Entry& section) { read_legs(section); }},
                    {"effect", [&](const Entry& section) { read_effects(section); }},
                    {"outliers", [&](const Entry& section) { read_outliers(section); }},
                    {"gap", [&](const Entry& section) { read_gaps(section); }}});
    each(root, "a scenario", actions,
         {{"name", "the scenario has no name; add name = \"...\""},
          {"aircraft", R"(the scenario has no aircraft; add aircraft = "C-130" or "GV")"},
          {"system", "there is no pair of pressures; add a [[system]]"},
          {"leg", "the scenario has no leg; add a [[leg]]"}});
  }

  void read_aircraft(const Entry& entry) {
    const bool is_gv = one_of(entry, {"C-130", "GV"}) == "GV";
    scenario_.aircraft = is_gv ? Scenario::Aircraft::gv : Scenario::Aircraft::c130;
  }

  void read_seed(const Entry& entry) {
    const std::int64_t seed = whole_number(entry);
    if (seed < 0) fail(entry, "seed = {} is negative; give 0 or more", seed);
    scenario_.seed = static_cast<std::uint64_t>(seed);
  }

  void read_start(const Entry& entry) {
    const auto& time =
        as<toml::date_time>(*entry.node, "'start' is not a time; write it as 2011-11-17T20:00:00Z");
    if (time.offset && time.offset->minutes != 0)
      fail(entry, "'start' is not UTC; write it as 2011-11-17T20:00:00Z");
    if (time.time.nanosecond != 0)
      fail(entry, "'start' is not a whole second; write it as 2011-11-17T20:00:00Z");
    scenario_.start = seconds_of(time);
  }

  void read_rate(const Entry& entry) {
    const std::int64_t rate = whole_number(entry);
    if (rate != 1 && rate != 5 && rate != 25)
      fail(entry, "rate = {} is impossible; give 1, 5 or 25 samples a second", rate);
    scenario_.rate = static_cast<int>(rate);
  }

  void read_atmosphere(const Entry& section) {
    Actions actions = numbers(scenario_.atmosphere, atmosphere_keys);
    actions.emplace_back("cloud", [this](const Entry& entry) {
      tables(entry, [this](const toml::table& layer, Position position) { read_cloud(layer, position); });
    });
    each(table(section), "[atmosphere]", actions);
    if (scenario_.atmosphere.inversion_height < scenario_.atmosphere.ground_height)
      fail(section.position, "the inversion is below the ground; give inversion_height above ground_height");
  }

  void read_cloud(const toml::table& layer, Position position) {
    Scenario::Cloud cloud;
    each(layer, "[[atmosphere.cloud]]", numbers(cloud, cloud_keys));
    if (!(cloud.base < cloud.top)) fail(position, "the cloud's base is not below its top; give base < top");
    scenario_.atmosphere.clouds.push_back(cloud);
  }

  void read_systems(const Entry& section) {
    tables(section, [this](const toml::table& items, Position position) {
      Scenario::System system;
      each(items, "[[system]]",
           {{"static", [&](const Entry& entry) { system.static_pressure = text(entry); }},
            {"dynamic", [&](const Entry& entry) { system.dynamic_pressure = text(entry); }},
            {"mach",
             [&](const Entry& entry) {
               system.independent_mach = one_of(entry, {"pair", "independent"}) != "pair";
             }},
            {"law", [&](const Entry& entry) { read_law(entry, system.law); }}});
      for (const auto& [key, name] :
           {std::pair{"static", system.static_pressure}, std::pair{"dynamic", system.dynamic_pressure}}) {
        if (name.empty()) fail(position, "the system has no {} = \"...\"; add it", key);
        for (const Scenario::System& other : scenario_.systems) {
          if (name == other.static_pressure || name == other.dynamic_pressure)
            fail(position, "{} belongs to two systems; give each its own", name);
        }
      }
      if (system.static_pressure == system.dynamic_pressure)
        fail(position, "static and dynamic are one variable; give each its own");
      scenario_.systems.push_back(system);
    });
    scenario_.noise = usual_noise(scenario_);
  }

  void read_law(const Entry& section, Scenario::Law& law) const {
    Actions actions;
    for (const FaultInfo& info : fault_info()) {
      if (info.term == nullptr) continue;
      actions.emplace_back(std::string(info.id), [this, &law, &info](const Entry& entry) {
        law.*info.term = number(entry, {-10.0, 10.0, ""});
      });
    }
    each(table(section), "law", actions);
  }

  void read_lams(const Entry& section) { each(table(section), "[lams]", numbers(scenario_.lams, lams_keys)); }

  void read_avionics(const Entry& section) {
    Actions actions = numbers(scenario_.avionics, avionics_keys);
    actions.emplace_back("law", [this](const Entry& entry) {
      read_law(entry, scenario_.avionics.law);
      scenario_.avionics.has_law = true;
      const Scenario::Law& law = scenario_.avionics.law;
      if (law.m1 == 0.0 && law.m2 == 0.0 && law.m3 == 0.0)
        fail(entry.position, "the law does not depend on the Mach number; add a term static-mach or another");
    });
    each(table(section), "[avionics]", actions);
  }

  // A table, or only the rms.
  void read_noise(const Entry& section) {
    for (const Entry& entry : entries_of(table(section))) {
      const auto found = scenario_.noise.find(entry.key);
      if (found == scenario_.noise.end()) {
        fail(entry.position, "no variable {} is recorded; {}", quote(entry.key),
             suggestion_text(entry.key, recorded()));
      }
      if (entry.node->is_table())
        each(*entry.node->as_table(), "the noise of " + entry.key, numbers(found->second, noise_keys));
      else
        found->second = {number(entry, {0.0, unlimited, ""}), 0.0, found->second.memory,
                         found->second.resolution};
    }
  }

  void read_legs(const Entry& section) {
    const AircraftInfo& aircraft = info_of(scenario_.aircraft);
    bool flying = false;
    double height = scenario_.atmosphere.ground_height;
    tables(section, [&](const toml::table& items, Position position) {
      Scenario::Leg leg;
      leg.position = position_of(position);
      const LegInfo& info = leg_kind(items, position);
      leg.kind = info.kind;
      Actions actions{{"kind", [](const Entry&) {}}};
      for (const std::string& key : split_words(std::string(info.keys))) {
        actions.emplace_back(key, [&](const Entry& entry) {
          const auto which = std::find_if(leg_keys.begin(), leg_keys.end(),
                                          [&](const auto& each) { return each.key == entry.key; });
          leg.*which->value = number(entry, leg_domain(*which, leg.kind, aircraft));
        });
      }
      each(items, fmt::format("a leg of kind {}", quote(info.name)), actions);
      complete(leg, aircraft);
      check_leg(leg, info, position, flying, height);
      scenario_.legs.push_back(leg);
    });
  }

  const LegInfo& leg_kind(const toml::table& items, Position position) const {
    if (const std::optional<Entry> entry = entry_of(items, "kind")) {
      const std::string kind = one_of(*entry, names_of(leg_info, &LegInfo::name));
      return *std::find_if(leg_info.begin(), leg_info.end(),
                           [&](const LegInfo& each) { return each.name == kind; });
    }
    fail(position, "the leg has no kind; add kind = \"level\" or another");
  }

  /// Checks the combination of numbers of a leg, and of the legs before it. `height` is the altitude they
  /// reach.
  void check_leg(const Scenario::Leg& leg, const LegInfo& info, Position position, bool& flying,
                 double& height) const {
    using Kind = Scenario::Leg::Kind;
    const bool starts = leg.kind == Kind::take_off || leg.kind == Kind::ground;
    if (starts == flying) {
      fail(position, flying ? fmt::format("{} in the air; put a landing before it", info.name)
                            : fmt::format("{} on the ground; put a take-off before it", info.name));
    }
    if (leg.kind == Kind::take_off) flying = true;
    if (leg.kind == Kind::landing) flying = false;
    const bool changes_height = leg.kind == Kind::climb || leg.kind == Kind::descent;
    if (changes_height && std::isnan(leg.altitude))
      fail(position, "the {} has no altitude; add altitude = ... (m)", info.name);
    if ((changes_height || leg.kind == Kind::take_off) &&
        leg.altitude < scenario_.atmosphere.ground_height + min_height)
      fail(position, "altitude = {} m is not {} m above the ground; give more", leg.altitude, min_height);
    if (leg.kind == Kind::climb && leg.altitude <= height)
      fail(position, "the climb to {} m begins at {} m; make it a descent", leg.altitude, height);
    if (leg.kind == Kind::descent && leg.altitude >= height)
      fail(position, "the descent to {} m begins at {} m; make it a climb", leg.altitude, height);
    if (changes_height || leg.kind == Kind::take_off) height = leg.altitude;
    if (leg.kind == Kind::landing) height = scenario_.atmosphere.ground_height;
    if (std::abs(leg.angle) < 1.0)
      fail(position, "angle = {} deg is not a {}; give 1 deg or more to either side", leg.angle, info.name);
    if (leg.kind == Kind::speed_run && !(leg.low < leg.high))
      fail(position, "low = {} m/s is not below high = {} m/s; give low < high", leg.low, leg.high);
  }

  void read_effects(const Entry& section) {
    tables(section, [this](const toml::table& items, Position position) {
      Scenario::Effect effect;
      const FaultInfo& info = effect_info(items, position);
      effect.id = info.id;
      Actions actions{{"id", [](const Entry&) {}},
                      {"on", [&](const Entry& entry) { effect.on = target(entry, info); }}};
      for (const FaultParameter& parameter : info.parameters) {
        const std::string key(parameter.key);
        if (!std::isnan(parameter.usual)) effect.parameters[key] = parameter.usual;
        actions.emplace_back(key, [&](const Entry& entry) {
          effect.parameters[entry.key] = number(entry, parameter_domain(entry.key));
        });
      }
      if (info.id == "unknown") add_unknown(effect, actions);
      each(items, fmt::format("the effect {}", quote(info.id)), actions);
      for (const FaultParameter& parameter : info.parameters) {
        if (effect.parameters.count(std::string(parameter.key)) == 0)
          fail(position, "{} has no {}; add {} = ... ({})", effect.id, parameter.key, parameter.key,
               parameter.unit);
      }
      if (info.target == Target::variable && effect.on.empty())
        fail(position, "{} has no variable; add on = \"VLAMS\" or another", effect.id);
      if (info.id == "unknown" && (effect.of.empty() || effect.location.empty()))
        fail(position,
             R"(unknown needs of = "...", the variable that causes it, and where = "static" or another)");
      check_effect(effect, position);
      scenario_.effects.push_back(effect);
    });
  }

  void add_unknown(Scenario::Effect& effect, Actions& actions) const {
    effect.shape = "linear";
    actions.emplace_back("where", [this, &effect](const Entry& entry) {
      effect.location = one_of(entry, {"static", "total", "lams", "temperature"});
    });
    actions.emplace_back("shape", [this, &effect](const Entry& entry) {
      effect.shape = one_of(entry, {"linear", "quadratic", "step", "sine"});
    });
    actions.emplace_back("of", [this, &effect](const Entry& entry) {
      effect.of = text(entry);
      if (find_series(effect.of) != nullptr) return;
      Names known{"hidden"};
      for (const TruthInfo& info : truth_info) {
        if (!info.recorded.empty()) known.emplace_back(info.recorded);
        if (!info.name.empty()) known.emplace_back(info.name);
      }
      fail(entry, "no variable {} is simulated; {}", quote(effect.of), suggestion_text(effect.of, known));
    });
  }

  /// Checks an effect in combination with the rest of the scenario.
  void check_effect(const Scenario::Effect& effect, Position position) const {
    const bool of_clouds = effect.id == "lams-cloud" || effect.id == "temp-wetting";
    if (of_clouds && scenario_.atmosphere.clouds.empty())
      fail(position, "{} needs a cloud; add an [[atmosphere.cloud]]", effect.id);
    if (effect.id != "unknown") return;
    const bool on_systems = effect.location == "static" || effect.location == "total";
    if (!on_systems && !effect.on.empty())
      fail(position, "an effect on the {} has no other target; remove 'on'", effect.location);
    if (effect.parameters.at("scale") == 0.0) fail(position, "scale = 0 is impossible; give another number");
  }

  const FaultInfo& effect_info(const toml::table& items, Position position) const {
    if (const std::optional<Entry> entry = entry_of(items, "id")) {
      const std::string id = text(*entry);
      if (const FaultInfo* info = find_fault(id)) return *info;
      fail(*entry, "no effect {} can be simulated; {}", quote(id),
           suggestion_text(id, names_of(fault_info(), &FaultInfo::id)));
    }
    fail(position, "the effect has no id; add id = \"static-lag\" or another");
  }

  std::string target(const Entry& entry, const FaultInfo& info) const {
    Names known;
    if (info.target == Target::variable) known = recorded();
    if (info.target == Target::system || info.id == "unknown") {
      for (const Scenario::System& system : scenario_.systems) {
        known.push_back(system.static_pressure);
        known.push_back(system.dynamic_pressure);
      }
    }
    if (known.empty()) fail(entry.position, "{} has a fixed target; remove 'on'", info.id);
    return one_of(entry, known);
  }

  void read_outliers(const Entry& section) {
    tables(section, [this](const toml::table& items, Position position) {
      Scenario::Outliers outliers;
      Actions actions = numbers(outliers, outlier_keys);
      actions.emplace_back("variable",
                           [&](const Entry& entry) { outliers.variable = one_of(entry, recorded()); });
      each(items, "[[outliers]]", actions);
      if (outliers.variable.empty()) fail(position, "the outliers have no variable; add variable = \"...\"");
      if (outliers.fraction == 0.0 || outliers.size == 0.0)
        fail(position, "the outliers have no effect; give a fraction and a size above 0");
      scenario_.outliers.push_back(outliers);
    });
  }

  void read_gaps(const Entry& section) {
    tables(section, [this](const toml::table& items, Position position) {
      Scenario::Gap gap;
      Actions actions = numbers(gap, gap_keys);
      actions.emplace_back("variable", [&](const Entry& entry) { gap.variable = one_of(entry, recorded()); });
      each(items, "[[gap]]", actions);
      if (gap.duration == 0.0) fail(position, "the gap has no duration; add duration = ... (s)");
      scenario_.gaps.push_back(gap);
    });
  }

  /// The variables that the scenario's instruments record.
  Names recorded() const {
    Names names;
    for (const auto& [name, noise] : scenario_.noise) names.push_back(name);
    return names;
  }

  Scenario scenario_;
};

}  // namespace

Scenario parse_scenario(std::string_view text, std::string_view name) { return Reader(name).read(text); }

Scenario read_scenario(const std::filesystem::path& path) {
  return parse_scenario(text_of_file(path, "a scenario"), path.string());
}

}  // namespace pcor

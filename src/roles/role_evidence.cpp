#include "roles/role_evidence.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <optional>
#include <utility>

#include <pcor/base/error.hpp>
#include "numerics/median.hpp"
#include "roles/recorded_series.hpp"
#include "roles/usual_variables.hpp"

namespace pcor::internal {
namespace {

/// Evidence for a series. Phrases are separated by semicolons and sorted by decreasing likelihood; the order
/// of words is free.
struct Signs {
  std::string_view series;
  std::string_view phrases;
  std::string_view not_words;       ///< words that exclude a name or long_name
  std::string_view standard_names;  ///< CF standard names
  double minimum, maximum;          ///< limits of the median in flight, in the unit of the series
};

constexpr std::string_view no_pressure = "dynamic total cabin differential vapor altitude bay error";
constexpr std::string_view no_temperature =
    "potential virtual equivalent cabin dew frost surface sea bay transducer housing internal";

constexpr std::array<Signs, 33> signs{{
    {"static_pressure", "static pressure;pressure static;ambient pressure;air pressure;ps", no_pressure,
     "air_pressure", 50, 1100},
    {"dynamic_pressure", "dynamic pressure;impact pressure;pitot pressure;qc",
     "static cabin attack sideslip radome vertical horizontal", "", 1, 500},
    {"recovery_temperature",
     "recovery temperature;recovery air temperature;total temperature;total air temperature;indicated "
     "temperature;tat",
     no_temperature, "", 180, 340},
    {"ambient_temperature",
     "ambient temperature;static air temperature;outside air temperature;air temperature;static temperature",
     "potential virtual equivalent cabin dew frost surface sea bay transducer total recovery indicated",
     "air_temperature", 170, 330},
    {"vapor_pressure", "vapor pressure;partial pressure water vapor", "saturation",
     "water_vapor_pressure;"
     "water_vapor_partial_pressure_in_air",
     0, 60},
    {"dew_point", "dew point temperature;dew point", "frost depression", "dew_point_temperature", 150, 310},
    {"frost_point", "frost point temperature;frost point", "dew depression", "", 150, 310},
    {"radome_dynamic_pressure", "radome dynamic pressure;radome pressure", "differential attack sideslip", "",
     1, 500},
    {"attack_differential_pressure",
     "attack differential pressure;vertical differential pressure;alpha differential pressure", "", "", -100,
     100},
    {"sideslip_differential_pressure",
     "sideslip differential pressure;horizontal differential pressure;beta differential pressure", "", "",
     -100, 100},
    {"attack", "angle attack;attack;aoa", "differential pressure rate", "", -15, 25},
    {"sideslip", "sideslip angle;sideslip;angle sideslip", "differential pressure rate", "", -15, 15},
    {"mach", "mach number;mach", "squared", "", 0.05, 2.5},
    {"true_airspeed", "true airspeed;true air speed;tas", "indicated calibrated", "platform_speed_wrt_air",
     20, 350},
    {"altitude", "gps altitude;altitude;gps height;wgs height;ellipsoid height;geometric height",
     "pressure radar density ground radio naca", "altitude", -500, 25000},
    {"other_altitude", "pressure altitude;inertial altitude", "density radar", "barometric_altitude", -1000,
     25000},
    {"vertical_speed", "vertical speed;vertical velocity;climb rate", "wind gust air up upward", "", -20, 20},
    {"latitude", "latitude", "minimum maximum", "latitude", -90, 90},
    {"longitude", "longitude", "minimum maximum", "longitude", -360, 360},
    {"pitch", "pitch;pitch angle", "rate propeller", "platform_pitch_angle;platform_pitch", -15, 25},
    {"roll", "roll;roll angle;bank angle", "rate", "platform_roll_angle;platform_roll", -90, 90},
    {"heading", "true heading;heading", "magnetic wind", "platform_orientation;platform_azimuth_angle", -360,
     720},
    {"ground_speed", "ground speed", "east north vector eastward northward component",
     "platform_speed_wrt_ground", 10, 450},
    {"ground_speed_east", "ground speed east;ground velocity east;eastward velocity", "wind", "", -450, 450},
    {"ground_speed_north", "ground speed north;ground velocity north;northward velocity", "wind", "", -450,
     450},
    {"ground_track", "ground track;track;track angle;course", "error cross", "platform_course", -360, 720},
    {"normal_acceleration", "normal acceleration", "", "", -20, 20},
    {"longitudinal_acceleration", "longitudinal acceleration", "", "", -20, 20},
    {"flaps", "flaps;flap;flap position", "", "", -5, 105},
    {"engine_torque", "engine torque;torque", "", "", -50, 20000},
    {"height_above_ground", "radar altitude;height above ground;radio altitude", "", "height", -100, 20000},
    {"liquid_water", "liquid water content;liquid water;lwc", "path raw output", "", -1, 10},
    {"cabin_pressure", "cabin pressure", "", "", 400, 1100},
}};

/// Abbreviations and the full words.
constexpr std::array<std::pair<std::string_view, std::string_view>, 24> written_out{{
    {"mag", "magnetic"},
    {"temp", "temperature"},
    {"press", "pressure"},
    {"pres", "pressure"},
    {"alt", "altitude"},
    {"lat", "latitude"},
    {"lon", "longitude"},
    {"long", "longitude"},
    {"hdg", "heading"},
    {"spd", "speed"},
    {"vel", "velocity"},
    {"vert", "vertical"},
    {"dyn", "dynamic"},
    {"stat", "static"},
    {"dewpoint", "dew point"},
    {"slip", "sideslip"},
    {"side", "sideslip"},
    {"vapour", "vapor"},
    {"groundspeed", "ground speed"},
    {"acc", "acceleration"},
    {"accel", "acceleration"},
    {"oat", "outside air temperature"},
    {"sat", "static air temperature"},
    {"gs", "ground speed"},
}};

std::vector<std::string> split(std::string_view text, char at) {
  std::vector<std::string> parts;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find(at), text.size());
    if (end > 0) parts.emplace_back(text.substr(0, end));
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return parts;
}

bool has(const std::vector<std::string>& words, const std::string& word) {
  return std::find(words.begin(), words.end(), word) != words.end();
}

/// Agreement of words with phrases: 0.45 if a short text equals the most likely phrase, 0 without agreement.
double likeness(const std::vector<std::string>& words, std::string_view phrases) {
  constexpr double full = 0.45, later_phrase = 0.03, other_word = 0.02;
  double best = 0.0;
  double rank = 0.0;
  for (const std::string& phrase : split(phrases, ';')) {
    const std::vector<std::string> requested = split(phrase, ' ');
    if (std::all_of(requested.begin(), requested.end(),
                    [&](const std::string& word) { return has(words, word); })) {
      const double others = std::min(5.0, static_cast<double>(words.size() - requested.size()));
      best = std::max(best, full - later_phrase * rank - other_word * others);
    }
    ++rank;
  }
  return best;
}

/// Evidence in the file for a variable, as text.
struct Described {
  const VariableInfo& info;
  std::vector<std::string> name{};
  std::vector<std::string> long_name{};
  std::string standard_name{};
};

std::optional<RoleCandidate> candidate_of(const Flight& flight, const Described& variable,
                                          const Signs& sign) {
  const QuantityInfo& info = *series_named(sign.series);
  std::vector<std::string> all = variable.name;
  all.insert(all.end(), variable.long_name.begin(), variable.long_name.end());
  for (const std::string& word : split(sign.not_words, ' ')) {
    if (has(all, word)) return std::nullopt;
  }
  const std::string unit(info.unit);
  // Any dimensionless unit converts to an angle.
  const bool states_unit = !variable.info.units.empty() && is_known_unit(variable.info.units);
  if (states_unit && !is_convertible(variable.info.units, unit)) return std::nullopt;
  const double by_name = likeness(variable.name, sign.phrases);
  const double by_long_name = likeness(variable.long_name, sign.phrases);
  const bool by_standard_name = has(split(sign.standard_names, ';'), variable.standard_name);
  double score = std::max({by_name, by_long_name, by_standard_name ? 0.45 : 0.0});
  if (score == 0.0) return std::nullopt;
  const int said = (by_name > 0.0 ? 1 : 0) + (by_long_name > 0.0 ? 1 : 0) + (by_standard_name ? 1 : 0);
  if (said > 1) score += 0.05;
  try {
    const UnitConversion conversion =
        states_unit ? flight.conversion(variable.info.name, unit) : UnitConversion();
    std::vector<double> values = some_values(flight, variable.info.name, conversion);
    values.erase(
        std::remove_if(values.begin(), values.end(), [](double value) { return !std::isfinite(value); }),
        values.end());
    if (values.empty()) return std::nullopt;
    const auto [minimum, maximum] = std::minmax_element(values.begin(), values.end());
    const std::string range =
        fmt::format("{:.5g} to {:.5g}{}", *minimum, *maximum, unit == "1" ? "" : " " + unit);
    const double middle = median(std::move(values));
    if (!(middle >= sign.minimum && middle <= sign.maximum)) return std::nullopt;
    const std::string who = by_standard_name ? fmt::format("its standard_name is {}", variable.standard_name)
                            : by_long_name > 0 ? fmt::format("it is called '{}'", variable.info.long_name)
                                               : fmt::format("its name is {}", fmt::join(variable.name, " "));
    return RoleCandidate{variable.info.name, score + (states_unit ? 0.25 : 0.1) + 0.25,
                         fmt::format("{}, with values of {}", who, range)};
  } catch (const Error& error) {
    if (error.code() == Error::Code::file) throw;
    return std::nullopt;
  }
}

/// The candidates for one series, or for all if `series` is empty.
std::map<std::string, std::vector<RoleCandidate>> candidates_of(const Flight& flight,
                                                                std::string_view series) {
  std::map<std::string, std::vector<RoleCandidate>> all;
  for (const std::string& name : flight.variables()) {
    const VariableInfo& info = flight.variable(name);
    // The truth of a simulated flight was not recorded.
    if (!info.is_series || name == flight.time_variable() || info.attribute("Category") == truth_category)
      continue;
    const Described described{info, plain_words(info.name), plain_words(info.long_name),
                              info.attribute("standard_name")};
    for (const Signs& sign : signs) {
      if (!series.empty() && sign.series != series) continue;
      if (std::optional<RoleCandidate> candidate = candidate_of(flight, described, sign))
        all[std::string(sign.series)].push_back(std::move(*candidate));
    }
  }
  for (auto& [name, candidates] : all) {
    std::stable_sort(candidates.begin(), candidates.end(),
                     [](const RoleCandidate& a, const RoleCandidate& b) { return a.score > b.score; });
  }
  return all;
}

}  // namespace

std::vector<std::string> plain_words(std::string_view text) {
  std::string spaced;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const auto letter = static_cast<unsigned char>(text[i]);
    const bool hump =
        i > 0 && std::isupper(letter) != 0 && std::islower(static_cast<unsigned char>(text[i - 1])) != 0;
    if (hump) spaced += ' ';
    spaced += std::isalpha(letter) != 0 ? static_cast<char>(std::tolower(letter)) : ' ';
  }
  std::vector<std::string> words;
  for (const std::string& word : split(spaced, ' ')) {
    const auto known = std::find_if(written_out.begin(), written_out.end(),
                                    [&](const auto& each) { return each.first == word; });
    for (const std::string& part : split(known == written_out.end() ? word : known->second, ' ')) {
      if (!has(words, part)) words.push_back(part);
    }
  }
  return words;
}

std::vector<RoleCandidate> role_candidates(const Flight& flight, std::string_view series) {
  return candidates_of(flight, series)[std::string(series)];
}

std::map<std::string, std::vector<RoleCandidate>> role_candidates(const Flight& flight) {
  return candidates_of(flight, "");
}

bool is_sure(const std::vector<RoleCandidate>& candidates) {
  if (candidates.empty() || candidates.front().score < sure_score) return false;
  return candidates.size() == 1 || candidates[0].score - candidates[1].score >= clear_lead;
}

std::string sure_variable(const Flight& flight, std::string_view series) {
  const std::vector<RoleCandidate> candidates = role_candidates(flight, series);
  return is_sure(candidates) ? candidates.front().variable : "";
}

}  // namespace pcor::internal

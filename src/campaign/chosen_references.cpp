#include <pcor/campaign/chosen_references.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <string_view>
#include <utility>

#include <pcor/base/error.hpp>
#include <pcor/flight/flight.hpp>
#include "parallel/flight_partition.hpp"
#include "residuals/ground_velocity.hpp"
#include "roles/recorded_series.hpp"

namespace pcor {

using namespace internal;

namespace {

bool names_temperature(const ModelDefinition& model) {
  return model.variables.count(Quantity::recovery_temperature) != 0 ||
         model.variables.count(Quantity::ambient_temperature) != 0;
}

/// Whether a model uses neither pressure of a pair.
bool is_other_pair(const ModelDefinition& model, const PressurePair& pair) {
  return pair.static_pressure != model.variables.at(Quantity::static_pressure) &&
         pair.dynamic_pressure != model.variables.at(Quantity::dynamic_pressure);
}

std::string why_no_height(const Flight& flight, const ModelDefinition& model) {
  if (!names_temperature(model)) return "the model names no temperature";
  if (read_role(flight, model, Quantity::altitude).values.empty()) return "the flight has no GPS height";
  if (read_role(flight, model, Quantity::latitude).values.empty()) return "the flight has no latitude";
  return "";
}

std::string why_no_wind(const Flight& flight, const ModelDefinition& model) {
  if (!names_temperature(model)) return "the model names no temperature";
  if (read_role(flight, model, Quantity::heading).values.empty()) return "the flight has no true heading";
  if (read_ground_velocity(flight, model).speed.values.empty()) return "the flight has no ground velocity";
  return "";
}

/// References that a flight allows in addition to LAMS. A reason is empty if the reference is available.
struct Allowed {
  bool laser = false;
  std::vector<std::pair<std::string, std::string>> pairs{};  ///< pressure pairs in order of preference
  std::string no_height{};
  std::string no_wind{};

  template <class Archive>
  void serialize(Archive& archive) {
    archive(laser, pairs, no_height, no_wind);
  }
};

Allowed allowed_by(const Flight& flight, const ModelDefinition& model) {
  Allowed allowed;
  allowed.laser = flight.has(model.variables.at(Quantity::lams_airspeed));
  if (!allowed.laser) return allowed;
  const VariableNaming& naming = naming_of(model, flight);
  for (const PressurePair& pair : naming.measured) {
    if (pair.static_pressure != avionics_static_pressure && is_other_pair(model, pair) &&
        has_values(flight, naming, pair))
      allowed.pairs.emplace_back(pair.static_pressure, pair.dynamic_pressure);
  }
  const auto in_flight = [&flight](const std::string& why) {
    return why.empty() ? why : fmt::format("{} in {}", why, flight.path().filename().string());
  };
  allowed.no_height = in_flight(why_no_height(flight, model));
  allowed.no_wind = in_flight(why_no_wind(flight, model));
  return allowed;
}

/// References that all flights allow; for others the reason of the first flight.
Allowed allowed_by_all(const std::vector<Allowed>& flights) {
  Allowed all = flights.front();
  for (const Allowed& flight : flights) {
    all.laser = all.laser && flight.laser;
    all.pairs.erase(std::remove_if(all.pairs.begin(), all.pairs.end(),
                                   [&](const auto& pair) {
                                     return std::find(flight.pairs.begin(), flight.pairs.end(), pair) ==
                                            flight.pairs.end();
                                   }),
                    all.pairs.end());
    if (all.no_height.empty()) all.no_height = flight.no_height;
    if (all.no_wind.empty()) all.no_wind = flight.no_wind;
  }
  return all;
}

/// @throws Error that names the laser of a flight, if the model does not name it
void require_laser(const ModelDefinition& model, const FlightSet& flights) {
  if (model.variables.count(Quantity::lams_airspeed) != 0 || flights.empty() || flights.path(0).empty())
    return;
  const auto lasers = flights.partition().all_gather_flights<std::string>([&](std::size_t number) {
    const Flight& flight = flights[number];
    return first_with_values(flight, naming_of(model, flight), info_of(Quantity::lams_airspeed).name);
  });
  const auto laser =
      std::find_if(lasers.begin(), lasers.end(), [](const std::string& name) { return !name.empty(); });
  if (laser == lasers.end()) return;
  throw Error(
      Error::Code::model,
      fmt::format(
          "{}: the model does not name the laser; add lams_airspeed = \"{}\" and the attack to [variables] "
          "of a copy of it, or give --reference static:OTHER.toml, pressure:VARIABLE, wind or height",
          flights.name(static_cast<std::size_t>(laser - lasers.begin())), *laser));
}

}  // namespace

std::vector<std::string> in_order(std::vector<std::string> texts) {
  const std::vector<std::string> all = reference_beginnings();
  const auto position_of = [&all](const std::string& text) {
    return std::find_if(all.begin(), all.end(),
                        [&text](const std::string& each) { return text.rfind(each, 0) == 0; }) -
           all.begin();
  };
  std::sort(texts.begin(), texts.end(), [&position_of](const std::string& a, const std::string& b) {
    return std::make_pair(position_of(a), a) < std::make_pair(position_of(b), b);
  });
  return texts;
}

ChosenReferences read_references(const std::vector<std::string>& texts, const ModelDefinition& model,
                                 const FlightSet& flights) {
  ChosenReferences chosen;
  const auto use = [&](const std::string& text) {
    if (text == "lams") require_laser(model, flights);
    chosen.used.push_back(read_reference(text, model));
  };
  for (const std::string& text : texts) use(text);
  if (!texts.empty()) return chosen;
  use("lams");
  if (flights.empty()) return chosen;
  const Allowed allowed = allowed_by_all(flights.partition().all_gather_flights<Allowed>(
      [&](std::size_t number) { return allowed_by(flights[number], model); }));
  if (!allowed.laser) return chosen;
  if (allowed.pairs.empty()) {
    chosen.not_used.emplace_back("total: no second pressure pair with a standard name was found");
  } else {
    use("total:" + allowed.pairs.front().first + "+" + allowed.pairs.front().second);
  }
  const auto use_unless = [&](const std::string& text, const std::string& why_not) {
    if (why_not.empty()) {
      use(text);
    } else {
      chosen.not_used.push_back(fmt::format("{}: {}", text, why_not));
    }
  };
  use_unless("height", allowed.no_height);
  use_unless("wind", allowed.no_wind);
  return chosen;
}

}  // namespace pcor

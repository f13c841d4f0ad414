#include <fmt/format.h>

#include <algorithm>
#include <functional>

#include <pcor/flight/flight.hpp>
#include <pcor/residuals/reference.hpp>
#include <pcor/words/error.hpp>
#include "residuals/ground_velocity.hpp"
#include "roles/recorded_series.hpp"

namespace pcor {

using namespace internal;

namespace {

/// Why some flight does not allow a reference; empty where all do.
using WhyNot = std::function<std::string(const Flight& flight)>;

bool names_temperature(const ModelFile& model) {
  return model.variables.count(Quantity::recovery_temperature) != 0 ||
         model.variables.count(Quantity::ambient_temperature) != 0;
}

std::string why_no_laser(const Flight& flight, const ModelFile& model) {
  const std::string& laser = model.variables.at(Quantity::lams_airspeed);
  return flight.has(laser) ? "" : "there is no " + laser;
}

/// Whether a flight has a pair of pressures of which none is of the model itself.
bool has_other_pair(const Flight& flight, const ModelFile& model, const PressurePair& pair) {
  return pair.static_pressure != model.variables.at(Quantity::static_pressure) &&
         pair.dynamic_pressure != model.variables.at(Quantity::dynamic_pressure) &&
         has_values(flight, pair.static_pressure, "hPa") && has_values(flight, pair.dynamic_pressure, "hPa");
}

std::string why_no_height(const Flight& flight, const ModelFile& model) {
  if (!names_temperature(model)) return "the model names no temperature";
  if (read_role(flight, model, Quantity::altitude).values.empty()) return "there is no height of GPS";
  if (read_role(flight, model, Quantity::latitude).values.empty()) return "there is no latitude";
  return "";
}

std::string why_no_wind(const Flight& flight, const ModelFile& model) {
  if (!names_temperature(model)) return "the model names no temperature";
  if (read_role(flight, model, Quantity::heading).values.empty()) return "there is no true heading";
  if (read_ground_velocity(flight, model).speed.values.empty()) return "there is no velocity over the ground";
  return "";
}

/// The choice where the user names none.
class Choice {
 public:
  Choice(const ModelFile& model, const std::vector<std::filesystem::path>& paths) : model_(model) {
    for (const std::filesystem::path& path : paths) flights_.emplace_back(path);
  }

  /// Takes the reference of that text if all flights allow it, else notes why not.
  bool take(const std::string& text, const WhyNot& why_not) {
    for (const Flight& flight : flights_) {
      const std::string why = why_not(flight);
      if (why.empty()) continue;
      chosen_.not_used.push_back(fmt::format("{}: {} in {}", text, why, flight.path().filename().string()));
      return false;
    }
    chosen_.used.push_back(read_reference(text, model_));
    return true;
  }

  /// Of the first known pair that all flights have; that of the avionics, PS_A, is filtered and late.
  void take_total_pressure() {
    for (const PressurePair& pair : family_of(model_, flights_.front()).measured) {
      const bool all_have = std::all_of(flights_.begin(), flights_.end(), [&](const Flight& flight) {
        return has_other_pair(flight, model_, pair);
      });
      if (!all_have || pair.static_pressure == "PS_A") continue;
      chosen_.used.push_back(
          read_reference("total:" + pair.static_pressure + "+" + pair.dynamic_pressure, model_));
      return;
    }
    chosen_.not_used.emplace_back("total: there is no second pair of pressures of a usual name");
  }

  ChosenReferences finish() { return std::move(chosen_); }

 private:
  const ModelFile& model_;
  std::vector<Flight> flights_;
  ChosenReferences chosen_;
};

}  // namespace

ChosenReferences read_references(const std::vector<std::string>& texts, const ModelFile& model,
                                 const std::vector<std::filesystem::path>& flights) {
  ChosenReferences named;
  for (const std::string& text : texts) named.used.push_back(read_reference(text, model));
  if (!texts.empty()) return named;
  named.used.push_back(read_reference("lams", model));
  Choice choice(model, flights);
  if (!choice.take("lams", [&](const Flight& flight) { return why_no_laser(flight, model); })) return named;
  choice.take_total_pressure();
  choice.take("height", [&](const Flight& flight) { return why_no_height(flight, model); });
  choice.take("wind", [&](const Flight& flight) { return why_no_wind(flight, model); });
  return choice.finish();
}

}  // namespace pcor

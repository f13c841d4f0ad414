#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <optional>
#include <string_view>

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

/// A reference that may stand beside LAMS, and why not: the first flight that does not allow it.
struct Candidate {
  std::string text;
  std::function<std::string(const Flight& flight)> why_not;
  std::string reason{};

  void look_at(const Flight& flight) {
    if (!reason.empty()) return;
    const std::string why = why_not(flight);
    if (!why.empty()) reason = fmt::format("{}: {} in {}", text, why, flight.path().filename().string());
  }
};

/// The choice where the user names none: LAMS, and what else all flights allow. They are looked at one after
/// the other, however many there are.
class Choice {
 public:
  explicit Choice(const ModelFile& model) : model_(model) { use("lams"); }

  void look_at(const Flight& flight) {
    has_laser_ = has_laser_ && flight.has(model_.variables.at(Quantity::lams_airspeed));
    if (!pairs_) pairs_ = family_of(model_, flight).measured;
    const auto unfit = [&](const PressurePair& pair) {
      return pair.static_pressure == filtered_and_late || !has_other_pair(flight, model_, pair);
    };
    pairs_->erase(std::remove_if(pairs_->begin(), pairs_->end(), unfit), pairs_->end());
    for (Candidate* const each : {&height_, &wind_}) each->look_at(flight);
  }

  ChosenReferences finish() {
    if (!has_laser_ || !pairs_) return std::move(chosen_);
    if (pairs_->empty()) {
      chosen_.not_used.emplace_back("total: there is no second pair of pressures of a usual name");
    } else {
      use("total:" + pairs_->front().static_pressure + "+" + pairs_->front().dynamic_pressure);
    }
    for (const Candidate* const each : {&height_, &wind_}) {
      if (each->reason.empty()) {
        use(each->text);
      } else {
        chosen_.not_used.push_back(each->reason);
      }
    }
    return std::move(chosen_);
  }

 private:
  static constexpr std::string_view filtered_and_late = "PS_A";  // of the avionics

  void use(const std::string& text) { chosen_.used.push_back(read_reference(text, model_)); }

  const ModelFile& model_;
  ChosenReferences chosen_;
  bool has_laser_ = true;
  std::optional<std::vector<PressurePair>> pairs_;  // that all flights have
  Candidate height_{"height", [this](const Flight& flight) { return why_no_height(flight, model_); }};
  Candidate wind_{"wind", [this](const Flight& flight) { return why_no_wind(flight, model_); }};
};

}  // namespace

ChosenReferences read_references(const std::vector<std::string>& texts, const ModelFile& model,
                                 const std::vector<std::filesystem::path>& flights) {
  ChosenReferences named;
  for (const std::string& text : texts) named.used.push_back(read_reference(text, model));
  if (!texts.empty()) return named;
  Choice choice(model);
  for (const std::filesystem::path& flight : flights) choice.look_at(Flight(flight));
  return choice.finish();
}

}  // namespace pcor

#include "diagnose/manoeuvres/atmosphere.hpp"

#include <algorithm>
#include <cmath>

#include <pcor/physics/moist_air.hpp>
#include <pcor/physics/standard_atmosphere.hpp>

namespace pcor::internal::manoeuvres {
namespace {

/// m for a unit of ln p and a kelvin.
constexpr double scale = constants::gas_constant_dry_air / constants::standard_gravity;

std::vector<double> altitudes_of(const Flown& flown) {
  std::vector<double> altitudes = flown.gathered(
      [](const FlightSamples& flight) -> const std::vector<double>& { return flight.motion.altitude; });
  const std::vector<double> column = flown.column(Quantity::altitude);
  for (std::size_t i = 0; i < altitudes.size(); ++i) {
    if (std::isnan(altitudes[i])) altitudes[i] = column[i];
  }
  return altitudes;
}

}  // namespace

Atmosphere::Atmosphere(const Flown& flown)
    : temperature_(flown.pressure, flown.temperature, standard_layers.front().temperature),
      humidity_(flown.pressure, flown.humidity, 0.0) {
  double height = pressure_altitude(temperature_.pressures().front());
  for (const double pressure : temperature_.pressures()) {
    const double warmth = temperature_.at(pressure) * moist_air(humidity_.at(pressure)).gas_constant /
                          constants::gas_constant_dry_air;
    const double place = std::log(pressure);
    if (!nodes_.empty()) {
      Node& below = nodes_.back();
      below.gradient = (warmth - below.virtual_temperature) / (place - below.log_pressure);
      height += scale * 0.5 * (warmth + below.virtual_temperature) * (below.log_pressure - place);
    }
    nodes_.push_back({place, warmth, 0.0, height});
  }
  std::vector<double> rise = altitudes_of(flown);
  for (std::size_t i = 0; i < rise.size(); ++i) rise[i] -= height_of(flown.pressure[i]);
  const double usual_rise = median(std::move(rise));
  has_altitude_ = std::isfinite(usual_rise);
  if (!has_altitude_) return;
  for (Node& node : nodes_) node.height += usual_rise;
}

AirAt Atmosphere::at(double height) const {
  const auto above = std::upper_bound(nodes_.begin(), nodes_.end(), height,
                                      [](double h, const Node& node) { return h < node.height; });
  const bool below_all = above == nodes_.begin();
  const Node& node = below_all ? nodes_.front() : *(above - 1);
  const double gradient = below_all ? 0.0 : node.gradient;
  const double fall = (node.height - height) / scale;  // the integral of T_v d ln p
  const double root = std::sqrt(node.virtual_temperature * node.virtual_temperature + 2.0 * gradient * fall);
  const double pressure = std::exp(node.log_pressure + 2.0 * fall / (node.virtual_temperature + root));
  return {pressure, temperature_.at(pressure), humidity_.at(pressure)};
}

double Atmosphere::height_of(double pressure) const {
  const double place = std::log(pressure);
  const auto above = std::upper_bound(nodes_.begin(), nodes_.end(), place,
                                      [](double x, const Node& node) { return x > node.log_pressure; });
  const bool below_all = above == nodes_.begin();
  const Node& node = below_all ? nodes_.front() : *(above - 1);
  const double gradient = below_all ? 0.0 : node.gradient;
  const double up = place - node.log_pressure;
  return node.height - scale * up * (node.virtual_temperature + 0.5 * gradient * up);
}

}  // namespace pcor::internal::manoeuvres

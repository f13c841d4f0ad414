#include "diagnose/manoeuvres/aircraft.hpp"
#include "numerics/missing.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include <pcor/physics/air_data.hpp>
#include <pcor/physics/lift.hpp>
#include <pcor/physics/moist_air.hpp>

namespace pcor::internal::manoeuvres {
namespace {

using Series = std::vector<double>;

// The radome of the C-130 (NCAR processing algorithms sec. 4.5).
constexpr Line usual_attack_ratio{-5.776 / 15.031, 1.0 / 15.031};
constexpr Line usual_sideslip_ratio{0.0, 1.0 / 12.2115};

// deg hPa: weight over wing area and slope of the lift; of the C-130 at 58 t 388, of the GV at 36 t 393.
constexpr double usual_attack_slope = 390.0;
constexpr double usual_attack_offset = -4.3;  // deg
constexpr double usual_flaps_attack = -0.06;  // deg for a percent, estimate
constexpr std::size_t enough_samples = 30;

double median_or(Series values, double otherwise) {
  const double value = median(std::move(values));
  return std::isnan(value) ? otherwise : value;
}

Series ratio_of(const Flown& flown, const Series& numerator, const Series& denominator) {
  constexpr double least = 1.0;  // hPa
  Series ratio(flown.pressure.size(), nan);
  for (std::size_t i = 0; i < ratio.size(); ++i) {
    if (denominator[i] > least) ratio[i] = numerator[i] / denominator[i];
  }
  return ratio;
}

/// An angle of every sample: recorded for the model, else with the motion, else from the ratio of pressures.
Series angle_of(const Flown& flown, Quantity quantity, std::vector<double> FlightMotion::*motion,
                const Series& ratio, const Line& usual_ratio) {
  Series angle = flown.column(quantity);
  const Series other = flown.gathered(
      [motion](const FlightSamples& flight) -> const Series& { return flight.motion.*motion; });
  for (std::size_t i = 0; i < angle.size(); ++i) {
    if (std::isnan(angle[i])) angle[i] = other[i];
    if (std::isnan(angle[i])) angle[i] = (ratio[i] - usual_ratio.offset) / usual_ratio.slope;
  }
  return angle;
}

/// The ratio against the angle where the flights have both and the angle moves the ratio, else the usual line
/// through what there is.
Line ratio_law(const Series& angle, const Series& ratio, const Line& usual) {
  constexpr double least_slope = 0.01;  // 1/deg, a sixth of usual
  const std::optional<Line> line = robust_line(angle, ratio);
  if (line && std::abs(line->slope) > least_slope) return *line;
  return line_of_slope(usual.slope, angle, ratio).value_or(usual);
}

Series lift_numbers(const Flown& flown) {
  Series numbers(flown.pressure.size());
  for (std::size_t i = 0; i < numbers.size(); ++i)
    numbers[i] = lift_number(flown.load[i], flown.mach[i], flown.dynamic[i]);
  return numbers;
}

/// The law of the attack, of a slope that an aircraft can have.
Line attack_law(const Series& lift, const Series& attack) {
  constexpr double tolerated = 3.0;
  const std::optional<Line> line = robust_line(lift, attack);
  const double to_usual = line ? line->slope / usual_attack_slope : 0.0;
  if (to_usual > 1.0 / tolerated && to_usual < tolerated) return *line;
  return line_of_slope(usual_attack_slope, lift, attack)
      .value_or(Line{usual_attack_offset, usual_attack_slope});
}

double recovery_factor_of(const Flown& flown) {
  const Series recovery = flown.column(Quantity::recovery_temperature);
  const Series ambient = flown.column(Quantity::ambient_temperature);
  Series factor(recovery.size());
  for (std::size_t i = 0; i < factor.size(); ++i) {
    const double heating = 0.2 * flown.mach[i] * flown.mach[i];
    factor[i] = (recovery[i] / ambient[i] - 1.0) / heating;
  }
  return std::clamp(median_or(std::move(factor), 1.0), 0.5, 1.1);
}

}  // namespace

Aircraft::Aircraft(const Flown& flown, const Flown& with_flaps) {
  const auto attack_of = [](const Flown& some) {
    const Series ratio = ratio_of(some, some.column(Quantity::attack_differential_pressure),
                                  some.column(Quantity::radome_dynamic_pressure));
    return std::pair{angle_of(some, Quantity::attack, &FlightMotion::attack, ratio, usual_attack_ratio),
                     ratio};
  };
  const auto [angles, ratios] = attack_of(flown);
  attack = attack_law(lift_numbers(flown), angles);
  attack_ratio = ratio_law(angles, ratios, usual_attack_ratio);

  flaps_attack = usual_flaps_attack;
  if (with_flaps.pressure.size() >= enough_samples) {
    const Series lift = lift_numbers(with_flaps);
    Series effect = attack_of(with_flaps).first;
    for (std::size_t i = 0; i < effect.size(); ++i)
      effect[i] = (effect[i] - attack.at(lift[i])) / with_flaps.flaps[i];
    flaps_attack = median_or(std::move(effect), flaps_attack);
  }

  const Series qcr = flown.column(Quantity::radome_dynamic_pressure);
  radome_gain = median_or(ratio_of(flown, qcr, flown.dynamic), radome_gain);
  const Series ratio = ratio_of(flown, flown.column(Quantity::sideslip_differential_pressure), qcr);
  sideslip_ratio =
      ratio_law(angle_of(flown, Quantity::sideslip, &FlightMotion::sideslip, ratio, usual_sideslip_ratio),
                ratio, usual_sideslip_ratio);
  recovery_factor = recovery_factor_of(flown);
  level_acceleration = median_or(flown.column(Quantity::normal_acceleration), level_acceleration);
}

Envelope::Envelope(const Flown& flown, double step)
    : flown_(flown),
      slowest_(quantile(flown.airspeed, 0.01)),
      fastest_(quantile(flown.airspeed, 0.99)),
      least_dynamic_(quantile(flown.dynamic, 0.01)),
      greatest_dynamic_(quantile(flown.dynamic, 0.99)),
      greatest_mach_(quantile(flown.mach, 0.99)) {
  constexpr double width = 25.0;        // hPa
  constexpr double shortest = 60.0;     // s in all at a level, and
  constexpr double least_share = 0.03;  // of the time in the air
  constexpr double least_apart = 0.9;   // of the pressures of two levels
  std::map<int, Series> bins;
  for (const double p : flown.pressure) bins[static_cast<int>(p / width)].push_back(p);
  const double enough = std::max(shortest / step, least_share * static_cast<double>(flown.pressure.size()));
  const auto most = std::max_element(bins.begin(), bins.end(), [](const auto& a, const auto& b) {
    return a.second.size() < b.second.size();
  });
  const double usual = median(flown.pressure);
  double bottom = median(most->second);
  double top = bottom;
  double centre = bottom;
  for (const auto& [place, pressures] : bins) {
    if (static_cast<double>(pressures.size()) < enough) continue;
    const double p = median(pressures);
    bottom = std::max(bottom, p);
    top = std::min(top, p);
    if (std::abs(p - usual) < std::abs(centre - usual)) centre = p;
  }
  if (top > least_apart * bottom) bottom = top = centre = median(most->second);
  low = level_at(bottom);
  middle = level_at(centre);
  high = level_at(top);
  least_pressure = quantile(flown.pressure, 0.05);
  greatest_pressure = quantile(flown.pressure, 0.95);
  greatest_lift_number = quantile(lift_numbers(flown), 0.99);

  Series where = flown.pressure;
  for (std::size_t i = 0; i < where.size(); ++i) {
    if (flown.mach[i] < greatest_mach_) where[i] = nan;
  }
  fast = level_at(median(std::move(where)));
}

Level Envelope::level_at(double pressure) const {
  constexpr double near = 0.1;     // of the pressure
  constexpr double further = 1.1;  // speeds beyond those flown
  Series speeds = flown_.airspeed;
  Series temperatures = flown_.temperature;
  for (std::size_t i = 0; i < speeds.size(); ++i) {
    if (std::abs(flown_.pressure[i] / pressure - 1.0) > near) speeds[i] = temperatures[i] = nan;
  }
  const double temperature = median_or(std::move(temperatures), median(flown_.temperature));
  const auto airspeed_of = [&](double mach) { return true_airspeed(mach, temperature, dry_air<double>()); };
  const auto airspeed_at = [&](double dynamic) {
    return airspeed_of(mach_number(pressure, dynamic, dry_air<double>()));
  };
  Level level;
  level.pressure = pressure;
  level.usual = median_or(std::move(speeds), median(flown_.airspeed));
  level.slow = std::max(further * slowest_, airspeed_at(further * further * least_dynamic_));
  level.fast = std::min(
      {further * fastest_, airspeed_at(further * further * greatest_dynamic_), airspeed_of(greatest_mach_)});
  level.slow = std::min(level.slow, level.usual);
  level.fast = std::max(level.fast, level.usual);
  return level;
}

}  // namespace pcor::internal::manoeuvres

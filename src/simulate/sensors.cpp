#include "simulate/sensors.hpp"

#include <algorithm>
#include <cmath>
#include <pcor/physics/constants.hpp>

#include "numerics/missing.hpp"
#include "simulate/air.hpp"
#include "simulate/random.hpp"

namespace pcor::internal::simulate {
namespace {

/// Inputs of a port's law at one moment.
struct PortState {
  double pressure;      ///< static pressure of the air, hPa
  double total;         ///< total pressure at the pitot, hPa
  double attack_ratio;  ///< ADIFR/QCR as calibrated
  double sideslip_ratio;
  double attack;    ///< deg
  double sideslip;  ///< deg
  double mach;      ///< Mach number for the law; NaN: Mach number of the pair in dry air
  double extra;     ///< hPa
};

double at(const Series& series, std::size_t i) { return series.empty() ? 0.0 : series[i]; }

/// Fading factor of a law at a dynamic pressure, hPa: no defect without flow.
double fading_at(double dynamic_pressure) {
  constexpr double fades_below = 20.0;  // hPa
  const double part = std::clamp(dynamic_pressure / fades_below, 0.0, 1.0);
  return part * part;
}

double law_value(const Scenario::Law& law, const PortState& s, double pressure) {
  const double q = s.total - pressure;
  if (!(q > 0.0)) return 0.0;
  const double x = q / pressure;
  const bool needs_mach = law.m1 != 0.0 || law.m2 != 0.0 || law.m3 != 0.0;
  const double mach = !needs_mach ? 0.0 : std::isnan(s.mach) ? dry_mach(pressure, q) : s.mach;
  const double sum = law.a0 + law.a1 * s.attack_ratio + law.a2 * x + law.a3 * s.attack +
                     law.a4 * x * s.attack * s.attack + mach * (law.m1 + mach * (law.m2 + mach * law.m3)) +
                     law.b1 * s.sideslip_ratio + law.b2 * s.sideslip * s.sideslip;
  return pressure * sum * fading_at(q);
}

/// Inputs of a port's law at a step of the flight, without errors.
PortState port_state(const Scenario::System& system, const Truth& truth, const AircraftInfo& aircraft,
                     std::size_t i) {
  const double mach = truth.mach[i];
  return {truth.pressure[i],
          truth.total_pressure[i],
          aircraft.attack.ratio(truth.attack[i], mach),
          aircraft.sideslip.ratio(truth.sideslip[i], mach),
          truth.attack[i],
          truth.sideslip[i],
          system.independent_mach ? mach : nan,
          0.0};
}

/// Root of `miss` by the secant method, from two values, of which the first misses by `miss_last`.
template <class Miss>
double root_of(const Miss& miss, double last, double miss_last, double now, double tolerance) {
  constexpr int max_steps = 30;
  for (int step = 0; step < max_steps && std::abs(now - last) > tolerance; ++step) {
    const double miss_now = miss(now);
    if (miss_now == miss_last) break;
    const double next = now - miss_now * (now - last) / (miss_now - miss_last);
    last = now;
    miss_last = miss_now;
    now = next;
  }
  return now;
}

/// The static defect at one moment: the d for which
///
///     d = p_m law(q_m/p_m, ...) + extra,   p_m = p - d,   q_m = total - p_m
///
/// because the published laws use measured quantities. Solved by the secant method to 1e-11 hPa. Below q_m =
/// 20 hPa the law fades as (q_m/20)^2: without flow there is no defect.
double static_defect(const Scenario::Law& law, const PortState& state) {
  constexpr double tolerance = 1e-11;  // hPa
  const auto miss = [&](double d) { return law_value(law, state, state.pressure - d) + state.extra - d; };
  const double first_miss = miss(state.extra);
  return root_of(miss, state.extra, first_miss, state.extra + first_miss, tolerance);
}

void add_noise(const Scenario& scenario, const std::string& variable, Series& series) {
  const auto found = scenario.noise.find(variable);
  if (found == scenario.noise.end() || !scenario.noise_on) return;
  const Scenario::Noise& noise = found->second;
  const double kept = noise.memory > 0.0 ? std::exp(-time_step / noise.memory) : 0.0;
  const double deviation = noise.rms / std::sqrt(variance_of_mean(kept, internal_rate));
  Drift drift(scenario.seed, "noise " + variable);
  for (double& value : series) {
    value += noise.bias + deviation * drift.next(kept);
    if (noise.resolution > 0.0) value = noise.resolution * std::round(value / noise.resolution);
  }
}

void add_outliers(const Scenario& scenario, const std::string& variable, std::vector<double>& values) {
  std::string stream = "outliers " + variable;
  for (const Scenario::Outliers& outliers : scenario.outliers) {
    if (outliers.variable != variable) continue;
    Random random(scenario.seed, stream);
    stream += " further";  // each table has its own
    for (double& value : values) {
      if (random.uniform() < outliers.fraction) value += outliers.size * random.normal();
    }
  }
}

void remove_gaps(const Scenario& scenario, const std::string& variable, std::vector<double>& values,
                 int rate) {
  for (const Scenario::Gap& gap : scenario.gaps) {
    if (gap.variable != variable) continue;
    for (std::size_t i = 0; i < values.size(); ++i) {
      const double time = static_cast<double>(i) / rate;
      if (time >= gap.start && time < gap.start + gap.duration) values[i] = nan;
    }
  }
}

}  // namespace

Series mach_of_law(const Scenario& scenario, const Truth& truth, const AircraftInfo& aircraft) {
  constexpr double tolerance = 1e-12;
  const Scenario::System& system = scenario.systems.front();
  Series mach = truth.mach;
  for (std::size_t i = 0; i < mach.size(); ++i) {
    PortState state = port_state(system, truth, aircraft, i);
    const double defect = static_defect(system.law, state);
    const double port = state.pressure - defect;
    const double fading = fading_at(state.total - port);
    if (fading == 0.0) continue;
    const auto miss = [&](double m) {
      state.mach = m;
      return law_value(scenario.avionics.law, state, port) - defect;
    };
    const double of_law = root_of(miss, mach[i], miss(mach[i]), mach[i] + 1e-4, tolerance);
    mach[i] += fading * (of_law - mach[i]);
  }
  return mach;
}

PairReading read_pair(const Scenario::System& system, const SystemFaults& faults, const Truth& truth,
                      const AircraftInfo& aircraft) {
  const std::size_t steps = truth.size();
  PairReading reading{Series(steps), Series(steps), Series(steps)};
  auto& [line, total, defect] = reading;  // pressures in the lines, then as measured
  for (std::size_t i = 0; i < steps; ++i) {
    PortState state = port_state(system, truth, aircraft, i);
    state.total -= at(faults.total_loss, i);
    state.extra = at(faults.static_defect, i);
    total[i] = state.total;
    defect[i] = static_defect(faults.law, state);
    const double port = truth.pressure[i] - defect[i];
    line[i] = port + faults.leak * (truth.cabin_pressure[i] - port) + at(faults.static_head, i);
  }
  line = with_response(std::move(line), faults.static_lag);
  total = with_response(std::move(total), faults.total_lag);
  for (std::size_t i = 0; i < steps; ++i) {
    total[i] = (total[i] - line[i]) * (1.0 + faults.dynamic_gain) + at(faults.dynamic_error, i);
    line[i] += at(faults.static_error, i);
  }
  return reading;
}

RadomeReading read_radome(const Faults& faults, const Truth& truth, const AircraftInfo& aircraft,
                          const Series& defect) {
  const std::size_t steps = truth.size();
  RadomeReading reading{Series(steps), Series(steps), Series(steps)};
  for (std::size_t i = 0; i < steps; ++i) {
    const double q = truth.total_pressure[i] - truth.pressure[i] + defect[i];
    const double mach = truth.mach[i];
    reading.dynamic_pressure[i] = q - at(faults.radome_loss, i);
    reading.attack[i] = q * (aircraft.attack.ratio(truth.attack[i], mach) * (1.0 + faults.attack_gain) +
                             at(faults.attack_ratio, i));
    reading.sideslip[i] = q * aircraft.sideslip.ratio(truth.sideslip[i], mach);
  }
  return reading;
}

Series read_lams(const Scenario& scenario, const Faults& faults, const Truth& truth,
                 const AircraftInfo& aircraft) {
  constexpr double dissipation_of_mismatch = 1e-4;  // m2/s3
  constexpr double dropout_memory = 3.0;            // s
  constexpr double clearing_depth = 500.0;          // m, over which the aerosol thins out
  const Scenario::Lams& lams = scenario.lams;
  const std::size_t steps = truth.size();
  const double clear = std::isnan(lams.clear_above) ? aircraft.clear_above : lams.clear_above;
  const double azimuth = constants::radians_per_degree * (lams.azimuth + faults.lams_azimuth);
  const double kept = lams.mismatch_memory > 0.0 ? std::exp(-time_step / lams.mismatch_memory) : 0.0;
  const double mismatch =
      scenario.noise_on ? lams.mismatch / std::sqrt(variance_of_mean(kept, internal_rate)) : 0.0;
  const double signal_kept = std::exp(-time_step / dropout_memory);
  Drift volume(scenario.seed, "lams volume");
  Drift signal(scenario.seed, "lams signal");
  Series speed(steps);
  for (std::size_t i = 0; i < steps; ++i) {
    const double elevation = constants::radians_per_degree * (lams.elevation + at(faults.lams_elevation, i));
    const double attack = constants::radians_per_degree * truth.attack[i];
    const double sideslip = constants::radians_per_degree * truth.sideslip[i];
    const double beam[3] = {std::cos(elevation) * std::cos(azimuth), std::cos(elevation) * std::sin(azimuth),
                            -std::sin(elevation)};
    const double motion[3] = {std::cos(attack) * std::cos(sideslip), std::sin(sideslip),
                              std::sin(attack) * std::cos(sideslip)};
    const double along = beam[0] * motion[0] + beam[1] * motion[1] + beam[2] * motion[2];
    const double flow =
        truth.airspeed[i] + at(faults.lams_speed, i) +
        mismatch * std::cbrt(truth.dissipation[i] / dissipation_of_mismatch) * volume.next(kept);
    speed[i] = flow * along * (1.0 + faults.lams_scale);

    const double thin = 1.0 / (1.0 + std::exp((clear - truth.altitude[i]) / clearing_depth));
    const double missing = lams.dropout + (1.0 - lams.dropout) * thin;
    const bool lost = 0.5 * std::erfc(-signal.next(signal_kept) / std::sqrt(2.0)) < missing;
    if (scenario.noise_on && lost) speed[i] = nan;
  }
  return speed;
}

Series read_thermometer(const Thermometer& thermometer, const Faults& faults, const Truth& truth) {
  constexpr double slowest = 0.05;  // Mach number; lower limit of the recovery-factor laws
  Series temperature(truth.size());
  for (std::size_t i = 0; i < truth.size(); ++i) {
    const double recovery = thermometer.recovery_factor(std::max(truth.mach[i], slowest)) + faults.recovery;
    const Air air{truth.pressure[i], truth.temperature[i], truth.vapor_pressure[i]};
    temperature[i] = recovery_temperature(air, truth.airspeed[i], recovery);
  }
  temperature = with_response(std::move(temperature), faults.temperature_lag);
  for (std::size_t i = 0; i < truth.size(); ++i) temperature[i] += at(faults.temperature_error, i);
  return temperature;
}

Series with_response(Series series, double tau) {
  if (!(tau > 0.0) || series.empty()) return series;
  const double part = time_step / tau;
  const double gained = -std::expm1(-part);
  const double ramp = 1.0 - gained / part;
  double last = series.front();
  double response = last;
  for (double& value : series) {
    response += gained * (last - response) + ramp * (value - last);
    last = value;
    value = response;
  }
  return series;
}

Series delayed(Series series, double seconds) {
  if (seconds == 0.0 || series.empty()) return series;
  Series late(series.size());
  const auto end = static_cast<double>(series.size() - 1);
  for (std::size_t i = 0; i < series.size(); ++i) {
    const double position = std::clamp(static_cast<double>(i) - seconds * internal_rate, 0.0, end);
    const auto before = static_cast<std::size_t>(position);
    const std::size_t after = std::min(before + 1, series.size() - 1);
    const double part = position - static_cast<double>(before);
    late[i] = part == 0.0 ? series[before] : series[before] + part * (series[after] - series[before]);
  }
  return late;
}

std::vector<double> means(const Series& series, int rate) {
  const auto steps = static_cast<std::size_t>(internal_rate / rate);
  std::vector<double> values(series.size() / steps);
  for (std::size_t i = 0; i < values.size(); ++i) {
    double sum = 0.0;
    std::size_t count = 0;
    for (std::size_t k = i * steps; k < (i + 1) * steps; ++k) {
      if (std::isnan(series[k])) continue;
      sum += series[k];
      ++count;
    }
    values[i] = 2 * count >= steps ? sum / static_cast<double>(count) : nan;
  }
  return values;
}

std::vector<double> recorded(const Scenario& scenario, const Faults& faults, const std::string& variable,
                             Series series, int rate) {
  const auto response = faults.response.find(variable);
  if (response != faults.response.end()) series = with_response(std::move(series), response->second);
  const auto clock = faults.clock.find(variable);
  if (clock != faults.clock.end()) series = delayed(std::move(series), clock->second);
  add_noise(scenario, variable, series);
  std::vector<double> values = means(series, rate);
  add_outliers(scenario, variable, values);
  remove_gaps(scenario, variable, values, rate);
  return values;
}

}  // namespace pcor::internal::simulate

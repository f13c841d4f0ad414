#include "campaign/gps_rows.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include <pcor/physics/constants.hpp>
#include <pcor/physics/moist_air.hpp>
#include <pcor/physics/standard_atmosphere.hpp>
#include "numerics/low_pass.hpp"
#include "numerics/missing.hpp"
#include "numerics/triangular_factor.hpp"
#include "regimes/series.hpp"
#include "residuals/model_on_samples.hpp"
#include "residuals/reference_on_samples.hpp"

namespace pcor::internal {
namespace {

using constants::radians_per_degree;
using Series = std::vector<double>;

// Nuisances in the order of their columns.
enum Column : Eigen::Index {
  thermometer,
  recovery,
  heading_offset,
  sideslip_offset,
  attack_offset,
  velocity_lag,
  height_lag,
  shear_east,
  shear_north,
  isobar_east,
  isobar_north
};
static_assert(isobar_north + 1 == gps_nuisance_count);

double value_or(const Series& series, std::size_t i, double otherwise) {
  return series.empty() || std::isnan(series[i]) ? otherwise : series[i];
}

// Rate of change at a sample from its two neighbours, NaN if one is missing.
double rate_at(const Series& values, const Series& time, std::size_t i) {
  if (i == 0 || i + 1 >= values.size()) return nan;
  return (values[i + 1] - values[i - 1]) / (time[i + 1] - time[i - 1]);
}

// Results of the model for every sample; NaN if undefined or without airflow.
struct Air {
  Series pressure, dynamic, temperature, airspeed, gas_constant;
};

constexpr double min_airspeed = 40.0;  // m/s

/// Samples without the humidity that is recorded in others. The model takes dry air there, an airspeed that
/// is wrong by up to 0.7 %; a step of that size would appear as an effect.
std::vector<bool> without_humidity(const ModelSamples& samples, const ModelOnSamples& law) {
  std::vector<bool> without(samples.find(Quantity::static_pressure)->size(), false);
  if (!law.chain().counts_vapor()) return without;
  for (const Quantity humidity : humidity_roles) {
    const Series* const values = samples.find(humidity);
    if (values == nullptr) continue;
    if (!has_value(*values)) break;
    std::transform(values->begin(), values->end(), without.begin(),
                   [](double value) { return std::isnan(value); });
    break;
  }
  return without;
}

Air air_of(const FlightSamples& samples, const ModelDefinition& file, const double* parameters) {
  const ModelOnSamples law(file, samples.model);
  const std::size_t size = samples.time.size();
  Air air{Series(size, nan), Series(size, nan), Series(size, nan), Series(size, nan), Series(size, nan)};
  const std::vector<bool> is_dry = without_humidity(samples.model, law);
  for (std::size_t i = 0; i < size; ++i) {
    if (is_dry[i]) continue;
    State<double> state;
    law.air(i, parameters, state);
    const double airspeed = state[Quantity::corrected_airspeed];
    if (!(airspeed > min_airspeed)) continue;
    air.pressure[i] = state[Quantity::corrected_static_pressure];
    air.dynamic[i] = state[Quantity::corrected_dynamic_pressure];
    air.temperature[i] = state[Quantity::ambient_temperature];
    air.airspeed[i] = airspeed;
    air.gas_constant[i] = moist_air(state[Quantity::humidity]).gas_constant;
  }
  return air;
}

/// Dynamic heating at an airspeed, in units of the temperature.
double heating_at(const Air& air, std::size_t i, double airspeed) {
  return airspeed * airspeed / (2.0 * 3.5 * air.gas_constant[i] * air.temperature[i]);
}

/// A steep low-pass: what a Gaussian of 1 s removes is filtered again, several times. 100 % of an oscillation
/// of 6 s remain, 87 % of one of 4 s; one Gaussian would leave 58 and 29 %, and a coefficient found in such
/// manoeuvres would be as much too large.
Series without_noise(const Series& values, double step) {
  constexpr double deviation = 1.0;  // s
  constexpr int rounds = 6;
  Series smooth(values.size(), 0.0);
  for (int round = 0; round < rounds; ++round) {
    Series residual = values;
    for (std::size_t i = 0; i < residual.size(); ++i) residual[i] -= smooth[i];
    residual = low_passed(residual, deviation / step);
    for (std::size_t i = 0; i < residual.size(); ++i) smooth[i] += residual[i];
  }
  return smooth;
}

/// Removes the sensor noise from the inputs of effects other than pressures and temperatures, above all flow
/// angles. The residual contains the same noise, multiplied by the coefficient, and a column that contained
/// it would make the coefficient too small: by 2 % for 0.03 hPa in ADIFR, several standard errors in an hour
/// of calm air.
void low_pass_angles(ModelSamples& samples, double step) {
  constexpr std::array others{Quantity::static_pressure,
                              Quantity::dynamic_pressure,
                              Quantity::recovery_temperature,
                              Quantity::ambient_temperature,
                              Quantity::heading,
                              Quantity::ground_track,
                              Quantity::time,
                              Quantity::date};
  for (auto& [quantity, values] : samples.columns) {
    if (std::find(others.begin(), others.end(), quantity) == others.end())
      values = without_noise(values, step);
  }
}

// Pressures that the model would have read at the airspeed without gusts, in the same static pressure and
// temperature.
ModelSamples without_gusts(const FlightSamples& samples, const ModelDefinition& file,
                           const double* parameters, const Air& air, const Series& airspeed) {
  ModelSamples calm = samples.model;
  Series& static_pressure = *calm.find(Quantity::static_pressure);
  Series& dynamic_pressure = *calm.find(Quantity::dynamic_pressure);
  low_pass_angles(calm, samples.step);
  const auto low_pass = [&](Quantity with_gusts) {
    if (Series* const values = calm.find(with_gusts)) *values = low_passed(*values, 45.0 / samples.step);
  };
  for (const Quantity with_gusts :
       {Quantity::mach, Quantity::true_airspeed, Quantity::airspeed_rate, Quantity::recovery_temperature})
    low_pass(with_gusts);
  for (const Rate& each : rates) low_pass(each.rate);
  for (std::size_t i = 0; i < airspeed.size(); ++i) {
    if (std::isnan(airspeed[i])) continue;
    const double heating = heating_at(air, i, airspeed[i]);
    dynamic_pressure[i] += air.pressure[i] * (std::pow(1.0 + heating, 3.5) - 1.0) - air.dynamic[i];
  }
  // The static defect depends on the dynamic pressure.
  const ModelOnSamples calm_law(file, calm);
  constexpr int rounds = 4;
  for (int round = 0; round < rounds; ++round) {
    for (std::size_t i = 0; i < airspeed.size(); ++i) {
      if (std::isnan(airspeed[i])) continue;
      State<double> state;
      const double p = calm_law.corrected_static_pressure(i, parameters, state);
      if (std::isnan(p)) continue;
      const double change = air.pressure[i] - p;
      static_pressure[i] += change;
      dynamic_pressure[i] -= change;
    }
  }
  return calm;
}

// Derivatives at a sample with respect to some parameters: a row for each result.
enum Result : Eigen::Index { of_airspeed, of_pressure, of_temperature, of_log_pressure };
using Derivatives = Eigen::Matrix<double, of_log_pressure + 1, Eigen::Dynamic, Eigen::RowMajor>;

class Differentiation {
 public:
  Differentiation(const ModelDefinition& file, const ModelSamples& inputs, const double* parameters,
                  const std::vector<std::size_t>& requested, const EffectAmounts& effects)
      : law_(file, inputs), parameters_(parameters), requested_(requested), at_location_(effects.at) {
    requested_.insert(requested_.end(), effects.amounts_of_model.begin(), effects.amounts_of_model.end());
    for (std::size_t& location : at_location_) location += requested.size();
    law_columns_ = as_index(requested.size());
    if (!at_location_.empty()) amounts_ = effects.amounts(inputs);
  }

  Eigen::Index count() const { return law_columns_ + as_index(at_location_.size()); }

  Derivatives operator()(std::size_t sample) const {
    Derivatives at;
    at.resize(Eigen::NoChange, as_index(requested_.size()));
    for (std::size_t first = 0; first < requested_.size(); first += jet_width) {
      const std::size_t width = std::min<std::size_t>(jet_width, requested_.size() - first);
      std::vector<Jet> dual(parameters_, parameters_ + law_.parameters().size());
      for (std::size_t k = 0; k < width; ++k) {
        // GPS is independent of the model of another system.
        if (requested_[first + k] < dual.size()) dual[requested_[first + k]].v[as_index(k)] = 1.0;
      }
      State<Jet> state;
      law_.air(sample, dual.data(), state);
      const Jet& pressure = state[Quantity::corrected_static_pressure];
      for (std::size_t k = 0; k < width; ++k) {
        const Eigen::Index d = as_index(k);
        at.col(as_index(first + k)) << state[Quantity::corrected_airspeed].v[d], pressure.v[d],
            state[Quantity::ambient_temperature].v[d], pressure.v[d] / pressure.a;
      }
    }
    Derivatives all(at.rows(), count());
    all.leftCols(law_columns_) = at.leftCols(law_columns_);
    for (Eigen::Index c = law_columns_; c < count(); ++c)
      all.col(c) = at.col(as_index(at_location_[static_cast<std::size_t>(c - law_columns_)])) *
                   amounts_(as_index(sample), c - law_columns_);
    return all;
  }

 private:
  const ModelOnSamples law_;
  const double* parameters_;
  std::vector<std::size_t> requested_;    // including the amounts at the locations of effects
  std::vector<std::size_t> at_location_;  // index of the location of each coefficient of the effects
  Eigen::Index law_columns_ = 0;
  Eigen::MatrixXd amounts_{};
};

// Angles of a sample, deg. If pitch or attack is unknown, the path of the aircraft follows from its climb.
struct Angles {
  double heading, pitch, roll, attack, sideslip;
  bool has_attack;

  /// East and north components of a unit vector along the airspeed.
  Eigen::Vector2d direction(double d_attack = 0.0, double d_sideslip = 0.0) const {
    const double down = std::tan((attack + d_attack) * radians_per_degree);
    const double side = std::tan((sideslip + d_sideslip) * radians_per_degree);
    const double length = std::sqrt(1.0 + side * side + down * down);
    const double cp = std::cos(pitch * radians_per_degree);
    const double sp = std::sin(pitch * radians_per_degree);
    const double cr = std::cos(roll * radians_per_degree);
    const double sr = std::sin(roll * radians_per_degree);
    const double ahead = cp + side * sr * sp + down * cr * sp;
    const double right = side * cr - down * sr;
    const double sh = std::sin(heading * radians_per_degree);
    const double ch = std::cos(heading * radians_per_degree);
    return {(ahead * sh + right * ch) / length, (ahead * ch - right * sh) / length};
  }
};

Angles angles_at(const FlightMotion& motion, const Series& heading, const Series& airspeed, std::size_t i) {
  Angles angles{heading[i],
                value_or(motion.pitch, i, nan),
                value_or(motion.roll, i, 0.0),
                value_or(motion.attack, i, nan),
                value_or(motion.sideslip, i, 0.0),
                true};
  if (std::isnan(angles.pitch) || std::isnan(angles.attack)) {
    const double climb = value_or(motion.vertical_speed, i, 0.0) / airspeed[i];
    angles.pitch = std::asin(std::clamp(climb, -1.0, 1.0)) / radians_per_degree;
    angles.attack = 0.0;
    angles.has_attack = false;
  }
  return angles;
}

// Height above some level, m: by GPS; if it is missing, the pressure altitude plus the D-value of the
// last height by GPS, before the first one that of the first.
Series heights(const FlightSamples& samples, const Air& air) {
  Series z = samples.motion.altitude;
  z.resize(air.pressure.size(), nan);
  Series d_values;
  for (std::size_t i = 0; i < z.size(); ++i) d_values.push_back(z[i] - pressure_altitude(air.pressure[i]));
  const auto first = std::find_if(d_values.begin(), d_values.end(), [](double d) { return !std::isnan(d); });
  double d_value = first != d_values.end() ? *first : 0.0;
  for (std::size_t i = 0; i < z.size(); ++i) {
    if (!std::isnan(d_values[i])) d_value = d_values[i];
    if (std::isnan(z[i])) z[i] = pressure_altitude(air.pressure[i]) + d_value;
  }
  return z;
}

// Variance of a gust of one second in a -5/3 cascade that matches the differences of the residual over 4 s
// within 150 s around each sample. The factor applies to processes of 2, 8 and 32 s.
Series gust_level(const Series& east, const Series& north, const Series& time, double step) {
  constexpr double over = 4.0;
  constexpr double within = 150.0;
  constexpr double factor = 8.26;
  constexpr double minimum = 1e-6;
  const auto lag = static_cast<std::size_t>(std::max(1.0, std::round(over / step)));
  const auto half_width = static_cast<std::size_t>(std::round(within / step));
  Series squares(east.size(), nan);
  for (std::size_t i = lag; i < squares.size(); ++i) {
    if (time[i] - time[i - lag] > 1.5 * over) continue;
    squares[i] = 0.5 * (std::pow(east[i] - east[i - lag], 2) + std::pow(north[i] - north[i - lag], 2));
  }
  Series level = running_mean(squares, 2 * half_width);
  const double whole = mean_of(squares);
  for (double& each : level) each = std::max(minimum, (std::isnan(each) ? whole : each) / factor);
  return level;
}

/// Height change by a change of the pressure, m/hPa.
Series thickness_of(const Air& air) {
  Series thickness(air.pressure.size(), 0.0);
  for (std::size_t i = 0; i < thickness.size(); ++i)
    thickness[i] = air.gas_constant[i] * air.temperature[i] / (constants::standard_gravity * air.pressure[i]);
  return thickness;
}

/// Velocity over the ground and wind, m/s, and the direction of the airspeed.
struct WindSeries {
  Series ground_east, ground_north;
  Series east, north;  // ground velocity minus airspeed; NaN if unknown
  Series course;       // direction of the airspeed, continuous, deg
  Series level_share;  // horizontal part of the airspeed, 1
};

WindSeries wind_of(const FlightSamples& samples, const Air& air) {
  const Series& heading = *samples.reference.find(Quantity::heading);
  const Series& speed = *samples.reference.find(Quantity::ground_speed);
  const Series& track = *samples.reference.find(Quantity::ground_track);
  const std::size_t size = samples.time.size();
  const Series unknown(size, nan);
  WindSeries wind{unknown, unknown, unknown, unknown, unknown, unknown};
  for (std::size_t i = 0; i < size; ++i) {
    wind.ground_east[i] = speed[i] * std::sin(track[i] * radians_per_degree);
    wind.ground_north[i] = speed[i] * std::cos(track[i] * radians_per_degree);
    if (std::isnan(air.airspeed[i])) continue;
    const Eigen::Vector2d u = angles_at(samples.motion, heading, air.airspeed, i).direction();
    wind.east[i] = wind.ground_east[i] - air.airspeed[i] * u[0];
    wind.north[i] = wind.ground_north[i] - air.airspeed[i] * u[1];
    wind.level_share[i] = std::hypot(u[0], u[1]);
    wind.course[i] = std::atan2(u[0], u[1]) / radians_per_degree;
  }
  wind.course = unwrapped(std::move(wind.course));
  for (const FrozenSpan& span : samples.reference.frozen) {
    for (std::size_t i = span.first; i < span.first + span.count; ++i) wind.east[i] = wind.north[i] = nan;
  }
  return wind;
}

GpsRows wind_rows(const FlightSamples& samples, const ModelDefinition& file,
                  const std::vector<std::size_t>& used, const double* parameters,
                  const std::vector<std::size_t>& requested, const EffectAmounts& effects) {
  const Air air = air_of(samples, file, parameters);
  const std::size_t size = samples.time.size();
  const Series& heading = *samples.reference.find(Quantity::heading);
  const Series z = heights(samples, air);
  const double mean_height = mean_of(z);
  const Series airspeed = low_passed(air.airspeed, 45.0 / samples.step);
  const WindSeries wind = wind_of(samples, air);
  const Series calm_course = low_passed(wind.course, 15.0 / samples.step);
  const Series calm_share = low_passed(wind.level_share, 15.0 / samples.step);
  const Series calm_ground_east = low_passed(wind.ground_east, 5.0 / samples.step);
  const Series calm_ground_north = low_passed(wind.ground_north, 5.0 / samples.step);

  GpsRows result;
  result.time = samples.time;
  result.level = gust_level(wind.east, wind.north, samples.time, samples.step);
  result.airspeed = result.east = result.north = Series(size, 0.0);
  double height_before = nan;
  for (const double height : z) {
    result.rise.push_back(std::isnan(height - height_before) ? 0.0 : height - height_before);
    if (!std::isnan(height)) height_before = height;
  }
  result.thickness = thickness_of(air);
  const ModelSamples calm = without_gusts(samples, file, parameters, air, airspeed);
  const Differentiation differentiate(file, calm, parameters, requested, effects);
  const Eigen::Index count = differentiate.count();
  const Eigen::Index law_columns = as_index(requested.size());
  const Eigen::Index records = as_index(size);
  result.rows = RowByRow::Constant(2 * records, count + gps_nuisance_count + 1, nan);
  result.defect = Eigen::MatrixXd::Zero(as_index(used.size()), law_columns);
  Eigen::Index number = 0;
  for (const std::size_t i : used) {
    if (std::isnan(wind.east[i] + wind.north[i])) continue;
    const Derivatives by = differentiate(i);
    if (!by.row(of_airspeed).allFinite()) continue;
    result.defect.row(number++) = by.row(of_pressure).head(law_columns);
    const double speed = airspeed[i];
    const double sine = std::sin(calm_course[i] * radians_per_degree);
    const double cosine = std::cos(calm_course[i] * radians_per_degree);
    const double share = calm_share[i];
    result.airspeed[i] = speed;
    result.east[i] = sine;
    result.north[i] = cosine;
    const double heating = heating_at(air, i, speed);
    const double by_temperature = 0.5 * speed / air.temperature[i];
    const double by_recovery = -0.5 * speed * heating / (1.0 + heating);
    // An angle offset moves the direction ahead and to the right.
    const Angles angles = angles_at(samples.motion, heading, air.airspeed, i);
    const Eigen::Vector2d raw = angles.direction();
    constexpr double small = 0.05;  // deg
    const Eigen::Vector2d by_attack = (angles.has_attack ? angles.direction(small) : raw) - raw;
    const Eigen::Vector2d by_sideslip = angles.direction(0.0, small) - raw;
    const double raw_length = std::hypot(raw[0], raw[1]);
    const auto ahead = [&](const Eigen::Vector2d& move) { return move.dot(raw) / raw_length / small; };
    const auto right = [&](const Eigen::Vector2d& move) {
      return (move[0] * raw[1] - move[1] * raw[0]) / raw_length / small;
    };
    const double above = (z[i] - mean_height) / 1000.0;
    const auto fill = [&](Eigen::Index row, double along, double across, Column shear,
                          const Series& calm_ground, double residual) {
      auto to = result.rows.row(row);
      to.head(count) = by.row(of_airspeed) * (share * along);
      to.segment(count, gps_nuisance_count).setZero();
      to[count + thermometer] = by_temperature * share * along;
      to[count + recovery] = by_recovery * share * along;
      to[count + heading_offset] = speed * share * across * radians_per_degree;
      to[count + sideslip_offset] = speed * (ahead(by_sideslip) * along + right(by_sideslip) * across);
      to[count + attack_offset] = speed * (ahead(by_attack) * along + right(by_attack) * across);
      const double acceleration = rate_at(calm_ground, samples.time, i);
      to[count + velocity_lag] = std::isnan(acceleration) ? 0.0 : acceleration;
      to[count + shear] = std::isnan(above) ? 0.0 : above;
      to[count + gps_nuisance_count] = residual;
    };
    fill(as_index(i), sine, cosine, shear_east, calm_ground_east, wind.east[i]);
    fill(records + as_index(i), cosine, -sine, shear_north, calm_ground_north, wind.north[i]);
  }
  result.defect.conservativeResize(number, law_columns);
  return result;
}

GpsRows height_rows(const FlightSamples& samples, const ModelDefinition& file,
                    const std::vector<std::size_t>& used, const double* parameters,
                    const std::vector<std::size_t>& requested, const EffectAmounts& effects, double warmer) {
  const Air air = air_of(samples, file, parameters);
  const std::size_t size = samples.time.size();
  const Series& altitude = *samples.reference.find(Quantity::altitude);
  Series logarithm(size, nan);
  for (std::size_t i = 0; i < size; ++i) logarithm[i] = std::log(air.pressure[i]);
  const Series calm_logarithm = low_passed(logarithm, 15.0 / samples.step);
  const Series calm_altitude = low_passed(altitude, 5.0 / samples.step);
  const double latitude = mean_of(samples.latitude);
  const double longitude = mean_of(samples.longitude);

  GpsRows result;
  result.kind = GpsKind::height;
  result.time = samples.time;
  result.warmth = result.rise = Series(size, 0.0);
  result.thickness = thickness_of(air);
  result.is_break.resize(size, false);
  ModelSamples calm = samples.model;
  low_pass_angles(calm, samples.step);
  // Even little noise of the pressures biases columns like that of an offset of the transducer.
  for (const Quantity input :
       {Quantity::static_pressure, Quantity::dynamic_pressure, Quantity::recovery_temperature}) {
    if (Series* const values = calm.find(input)) *values = low_passed(*values, 5.0 / samples.step);
  }
  const Differentiation differentiate(file, calm, parameters, requested, effects);
  const Eigen::Index count = differentiate.count();
  const Eigen::Index law_columns = as_index(requested.size());
  const Eigen::Index columns = count + gps_nuisance_count;
  result.rows = RowByRow::Constant(as_index(size), columns + 1, nan);
  result.defect = Eigen::MatrixXd::Zero(as_index(used.size()), law_columns);
  std::vector<bool> takes_part(size, false);
  for (const std::size_t i : used) takes_part[i] = true;

  Derivatives before;
  Eigen::RowVectorXd height = Eigen::RowVectorXd::Zero(columns + 1);  // height followed by its derivatives
  double recovery_before = 0.0;
  std::size_t last = size;
  Eigen::Index number = 0;
  for (std::size_t i = 0; i < size; ++i) {
    if (std::isnan(air.pressure[i] + air.temperature[i])) continue;
    const Derivatives by = differentiate(i);
    if (!by.row(of_log_pressure).allFinite() || !by.row(of_temperature).allFinite()) continue;
    const double temperature = air.temperature[i];
    const double heating = heating_at(air, i, air.airspeed[i]);
    const double by_recovery = -temperature * heating / (1.0 + heating);
    result.warmth[i] = 1.0 / temperature;
    const bool is_continuous = last < size && samples.time[i] - samples.time[last] < 3.5 * samples.step;
    result.is_break[i] = !is_continuous;
    if (is_continuous) {
      const double fall = air.gas_constant[i] / constants::standard_gravity;
      const double step = -fall * (logarithm[i] - logarithm[last]);
      const double calm_step = -fall * (calm_logarithm[i] - calm_logarithm[last]);
      const double mean = 0.5 * (air.temperature[last] + temperature);
      height.head(count) += 0.5 * calm_step * (by.row(of_temperature) + before.row(of_temperature)) -
                            fall * mean * (by.row(of_log_pressure) - before.row(of_log_pressure));
      height[count + thermometer] += calm_step;
      height[count + recovery] += 0.5 * calm_step * (by_recovery + recovery_before);
      height[columns] += mean * step + warmer * (step - calm_step);
      result.rise[i] = mean * calm_step;
    }
    before = by;
    recovery_before = by_recovery;
    last = i;
    if (!takes_part[i] || std::isnan(altitude[i])) continue;
    auto row = result.rows.row(as_index(i));
    row = height;
    row[columns] = altitude[i] - height[columns];
    const double climb = rate_at(calm_altitude, samples.time, i);
    row[count + height_lag] = std::isnan(climb) ? 0.0 : climb;
    if (!samples.latitude.empty() && !samples.longitude.empty()) {
      constexpr double per_degree = 1.112;  // 100 km per degree of latitude
      const double along = per_degree * std::cos(latitude * radians_per_degree);
      const double to_east = along * (samples.longitude[i] - longitude);
      const double to_north = per_degree * (samples.latitude[i] - latitude);
      if (!std::isnan(to_east + to_north)) {
        row[count + isobar_east] = to_east;
        row[count + isobar_north] = to_north;
      }
    }
    result.defect.row(number++) = by.row(of_pressure).head(law_columns);
  }
  result.defect.conservativeResize(number, law_columns);
  return result;
}

}  // namespace

std::optional<GpsKind> gps_kind(const Reference& reference) {
  const std::string name = reference.name();
  if (name == "wind") return GpsKind::wind;
  if (name == "height") return GpsKind::height;
  return std::nullopt;
}

Eigen::VectorXd gps_nuisance_deviations() {
  return Eigen::VectorXd::NullaryExpr(gps_nuisance_count, [](Eigen::Index n) {
    return gps_nuisances[static_cast<std::size_t>(n)].deviation;
  });
}

GpsRows gps_rows(GpsKind kind, const FlightSamples& samples, const ModelDefinition& model,
                 const std::vector<std::size_t>& used, const double* parameters,
                 const std::vector<std::size_t>& requested, const EffectAmounts& effects, double warmer) {
  return kind == GpsKind::wind ? wind_rows(samples, model, used, parameters, requested, effects)
                               : height_rows(samples, model, used, parameters, requested, effects, warmer);
}

}  // namespace pcor::internal

#include "checks/climb_layers.hpp"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <map>
#include <tuple>

#include <pcor/numerics/noise.hpp>
#include <pcor/physics/hydrostatic.hpp>
#include "numerics/decompositions.hpp"

namespace pcor::internal {
namespace {

constexpr double usual_height_noise = 1.0;    // m: GPS of 2004, without differential corrections
constexpr double min_height_noise = 0.15;     // m: differential GPS of today
constexpr double usual_gradient = 5.0;        // m per 100 km
constexpr double metres_per_gradient = 1e-5;  // height per metre of distance for 1 m per 100 km
constexpr double share_of_flight = 0.8;       // fraction of the variance of the gradient that is common to a
                                              // flight; the rest varies between climbs
constexpr double rate_time = 15.0;            // s before and after a sample
constexpr double min_step = 2.0;              // m between the GPS height and the pressure, in one sample
constexpr double max_level_rate = 0.5;        // m/s
constexpr double piece_time = 300.0;          // s, typical duration of a layer
constexpr double band = 500.0;                // m: delta-p may have another error in the next band
constexpr double min_swing = 2.0;             // m/s of the climb rate, required to estimate a lag
constexpr double lag_that_matters = 0.5;      // s: 2.5 m in a climb of 5 m/s
constexpr double min_range = 5.0;             // K of temperature for a line

/// Heights of the samples in flight with known pressure, height, temperature and humidity.
std::vector<double> usable_heights(const FlightAir& air) {
  std::vector<double> heights(air.size(), nan);
  for (std::size_t i = 0; i < air.size(); ++i) {
    const bool known = air.flying[i] && air.pressure[i] > 0.0 && air.temperature[i] > 0.0 &&
                       !std::isnan(air.gas_constant[i]);
    if (known) heights[i] = air.geopotential_height[i];
  }
  return heights;
}

/// Geopotential height difference between successive samples, m, from pressure and temperature.
double predicted_step(const FlightAir& air, std::size_t i) {
  return hydrostatic_step(air.pressure[i - 1], air.pressure[i],
                          0.5 * (air.gas_constant[i - 1] + air.gas_constant[i])) *
         0.5 * (air.temperature[i - 1] + air.temperature[i]);
}

/// Stretches without gaps, missing values and steps of the GPS height.
std::vector<Segment> steady_segments(const FlightAir& air, const std::vector<double>& heights) {
  const std::vector<Segment> segments = contiguous_segments(heights, air.time(), air.step());
  std::vector<double> departures(air.size(), nan);
  for (const Segment& segment : segments) {
    for (std::size_t i = segment.first + 1; i < segment.first + segment.count; ++i)
      departures[i] = heights[i] - heights[i - 1] - predicted_step(air, i);
  }
  const double limit = std::max(min_step * air.step(), 8.0 * robust_standard_deviation(departures));
  std::vector<Segment> steady;
  for (const Segment& segment : segments) {
    std::size_t first = segment.first;
    const std::size_t end = segment.first + segment.count;
    for (std::size_t i = first + 1; i <= end; ++i) {
      if (i < end && !(std::abs(departures[i]) > limit)) continue;
      steady.push_back({first, i - first});
      first = i;
    }
  }
  return steady;
}

/// Vertical speed over half a minute, m/s.
std::vector<double> climb_rates(const FlightAir& air, const std::vector<double>& heights,
                                const std::vector<Segment>& segments) {
  std::vector<double> rates(air.size(), nan);
  const auto half_width = static_cast<std::size_t>(std::max(1.0, std::round(rate_time / air.step())));
  for (const Segment& segment : segments) {
    if (segment.count < 2) continue;
    const std::size_t last = segment.first + segment.count - 1;
    for (std::size_t i = segment.first; i <= last; ++i) {
      const std::size_t before = std::max(segment.first + half_width, i) - half_width;
      const std::size_t after = std::min(last, i + half_width);
      rates[i] = (heights[after] - heights[before]) / (air.time()[after] - air.time()[before]);
    }
  }
  return rates;
}

/// Parts of the stretches in which `within` is true for every sample.
template <class Condition>
std::vector<Segment> parts_where(const std::vector<Segment>& segments, const Condition& within) {
  std::vector<Segment> parts;
  for (const Segment& segment : segments) {
    std::size_t first = segment.first;
    const std::size_t end = segment.first + segment.count;
    for (std::size_t i = first; i <= end; ++i) {
      if (i < end && within(i)) continue;
      if (i > first) parts.push_back({first, i - first});
      first = i + 1;
    }
  }
  return parts;
}

double speed_at(const std::vector<double>& speed, std::size_t i) {
  return speed.empty() || std::isnan(speed[i]) ? 0.0 : speed[i];
}

/// Deviation of the GPS height from the height implied by pressure and temperature, within five minutes.
struct Piece {
  double squares = 0.0;  ///< sum of squares after the fit of a line in time and one in height, m2
  double degrees_of_freedom = 0.0;
  double gradient = 0.0;   ///< slope of the line in time, m per 100 km of distance
  Estimate lag{nan, nan};  ///< lag of the pressure relative to the height, s; NaN if the climb rate hardly
                           ///< changes
};

/// The line in time is the slope of the pressure surfaces, the line in height an error of the thermometer,
/// and the term proportional to the climb rate a lag. The remainder is the error of height and pressure, and
/// variation of the air within five minutes.
Piece look_at_piece(const FlightAir& air, const std::vector<double>& heights,
                    const std::vector<double>& climb_rate, std::size_t first, std::size_t samples) {
  Eigen::MatrixXd columns(samples, 4);
  Eigen::VectorXd departures(samples);
  double way = 0.0;
  double predicted = 0.0;
  for (std::size_t k = 0; k < samples; ++k) {
    const auto row = static_cast<Eigen::Index>(k);
    if (k > 0) predicted += predicted_step(air, first + k);
    columns(row, 0) = 1.0;
    columns(row, 1) = (air.time()[first + k] - air.time()[first]) / piece_time - 0.5;
    columns(row, 2) = predicted;
    columns(row, 3) = climb_rate[first + k];
    departures(row) = heights[first + k] - heights[first] - predicted;
    way += air.airspeed[first + k] * air.step();
  }
  for (const Eigen::Index column : {2, 3}) columns.col(column).array() -= columns.col(column).mean();
  const Eigen::VectorXd fit = least_norm_solution(columns, departures);
  Piece piece;
  piece.squares = (departures - columns * fit).squaredNorm();
  piece.degrees_of_freedom = static_cast<double>(samples) - 4.0;
  piece.gradient = fit(1) / way / metres_per_gradient;
  const double swing = columns.col(3).maxCoeff() - columns.col(3).minCoeff();
  if (swing < min_swing) return piece;
  const double variance =
      piece.squares / piece.degrees_of_freedom * inverse_of(columns.transpose() * columns)(3, 3);
  piece.lag = {fit(3), std::sqrt(variance)};
  return piece;
}

std::vector<Piece> look_at_pieces(const FlightAir& air, const std::vector<double>& heights,
                                  const std::vector<double>& climb_rate,
                                  const std::vector<Segment>& segments) {
  std::vector<Piece> pieces;
  const auto samples = static_cast<std::size_t>(piece_time / air.step());
  for (const Segment& segment : segments) {
    for (std::size_t first = segment.first; first + samples <= segment.first + segment.count;
         first += samples)
      pieces.push_back(look_at_piece(air, heights, climb_rate, first, samples));
  }
  return pieces;
}

/// Reports a lag of the pressure relative to the height: layers in which a climb begins or ends then have
/// errors of several kelvins, with opposite signs.
void note_lag(const std::vector<Piece>& pieces, Notes& notes) {
  constexpr double significant = 4.0;  // standard errors
  std::vector<Estimate> lags;
  for (const Piece& piece : pieces) lags.push_back(piece.lag);
  const Estimate lag = combined(lags);
  if (!(std::abs(lag.value) > std::max(lag_that_matters, significant * lag.error))) return;
  notes.push_back(
      fmt::format("the static pressure is {:.1f} +- {:.1f} s {} the GPS height during changes of the climb "
                  "rate: a lag of the static line or of a clock; layers at the ends of climbs are wrong",
                  std::abs(lag.value), lag.error, lag.value > 0.0 ? "behind" : "ahead of"));
}

/// Estimates the missing numbers of the uncertainty.
/// @param all pieces of the flight; @param level pieces in level flight
void estimate_uncertainty(LayerOptions& uncertainty, const std::vector<Piece>& all,
                          const std::vector<Piece>& level, Notes& notes) {
  double squares = 0.0;
  double degrees_of_freedom = 0.0;
  for (const Piece& piece : all) {
    squares += piece.squares;
    degrees_of_freedom += piece.degrees_of_freedom;
  }
  if (std::isnan(uncertainty.height_noise) && all.empty()) {
    uncertainty.height_noise = usual_height_noise;
    notes.push_back(fmt::format(
        "no segment of {:.0f} s is available to estimate the error of the GPS height; {} m is assumed",
        piece_time, usual_height_noise));
  } else if (std::isnan(uncertainty.height_noise)) {
    uncertainty.height_noise = std::max(min_height_noise, std::sqrt(squares / degrees_of_freedom));
    notes.push_back(
        fmt::format("the error of the GPS height is estimated as {:.2f} m: rms deviation from the pressure "
                    "height within {} segments of {:.0f} s",
                    uncertainty.height_noise, all.size(), piece_time));
  }
  note_lag(all, notes);
  if (!std::isnan(uncertainty.gradient)) return;
  uncertainty.gradient = usual_gradient;
  double slopes = 0.0;
  for (const Piece& piece : level) slopes += piece.gradient * piece.gradient;
  const double gradient = std::sqrt(slopes / static_cast<double>(level.size()));
  if (gradient > usual_gradient) {
    uncertainty.gradient = gradient;
    notes.push_back(
        fmt::format("along level legs the pressure surfaces slope by {:.1f} m per 100 km (rms); the same "
                    "slope is assumed for climbs",
                    gradient));
  }
}

Layer make_layer(const FlightAir& air, const std::vector<double>& heights, std::size_t first,
                 std::size_t last) {
  Layer layer;
  layer.first = first;
  layer.last = last;
  layer.begin = air.time()[first];
  layer.end = air.time()[last];
  layer.height_begin = heights[first];
  layer.height_end = heights[last];
  layer.pressure_begin = air.pressure[first];
  layer.pressure_end = air.pressure[last];
  for (std::size_t i = first + 1; i <= last; ++i) {
    const double step = heights[i] - heights[i - 1];
    const double passed = air.time()[i] - air.time()[i - 1];
    layer.s1 -= hydrostatic_step(air.pressure[i - 1], air.pressure[i],
                                 0.5 * (air.gas_constant[i - 1] + air.gas_constant[i]));
    layer.s2 += step;
    layer.s3 += step * 0.5 * (1.0 / air.temperature[i - 1] + 1.0 / air.temperature[i]);
    if (air.east_speed.empty()) {
      // Without a ground velocity, distance and direction are computed from airspeed and heading.
      const double angle = speed_at(air.samples->motion.heading, i) * constants::radians_per_degree;
      const double way = passed * speed_at(air.airspeed, i);
      layer.east += way * std::sin(angle);
      layer.north += way * std::cos(angle);
    } else {
      layer.east += passed * speed_at(air.east_speed, i);
      layer.north += passed * speed_at(air.north_speed, i);
    }
  }
  return layer;
}

/// dT_p for an error of 1 m in S2, K/m.
double per_metre(const Layer& layer) { return layer.hydrostatic_temperature() / layer.s2; }

/// dT_p for an error of 1 hPa in the pressure at the end, K/hPa; the sign is reversed at the beginning.
double per_pressure(const Layer& layer, double pressure) {
  return -layer.hydrostatic_temperature() / std::log(layer.pressure_end / layer.pressure_begin) / pressure;
}

LayerErrors errors_of(const Layer& layer, const LayerOptions& uncertainty) {
  LayerErrors errors;
  const double at_end = per_pressure(layer, layer.pressure_end);
  const double at_begin = per_pressure(layer, layer.pressure_begin);
  errors.height_noise = std::abs(per_metre(layer)) * std::sqrt(2.0) * uncertainty.height_noise;
  errors.pressure_noise = std::hypot(at_end, at_begin) * uncertainty.pressure_noise;
  errors.static_bias = std::abs(at_end - at_begin) * uncertainty.static_bias;
  errors.static_change = std::hypot(at_end, at_begin) * uncertainty.static_change;
  errors.gradient = std::abs(per_metre(layer)) * std::hypot(layer.east, layer.north) * metres_per_gradient *
                    uncertainty.gradient;
  return errors;
}

Eigen::MatrixXd covariance_of(const std::vector<FlightLayers>& flights, Eigen::Index count) {
  enum class Kind { height, pressure, bias, change, east, north, climb_east, climb_north };
  // Sources of layer errors, one unknown with unit variance each: the error of each layer by each source.
  std::map<std::tuple<Kind, std::size_t, long>, Eigen::VectorXd> causes;
  Eigen::Index number = 0;  // index of the layer to which `add` adds
  const auto add = [&](Kind kind, std::size_t flight, long position, double error) {
    causes.try_emplace({kind, flight, position}, Eigen::VectorXd::Zero(count)).first->second(number) += error;
  };
  for (std::size_t flight = 0; flight < flights.size(); ++flight) {
    const LayerOptions& uncertainty = flights[flight].uncertainty;
    const double slope = metres_per_gradient * uncertainty.gradient;
    const double of_flight = slope * std::sqrt(share_of_flight);
    const double of_climb = slope * std::sqrt(1.0 - share_of_flight);
    for (const Layer& layer : flights[flight].layers) {
      const double metre = per_metre(layer);
      const auto end_point = [&](std::size_t record, double height, double pressure, double sign) {
        const auto position = static_cast<long>(record);
        add(Kind::height, flight, position, sign * metre * uncertainty.height_noise);
        const double hectopascal = sign * per_pressure(layer, pressure);
        add(Kind::pressure, flight, position, hectopascal * uncertainty.pressure_noise);
        add(Kind::bias, 0, 0, hectopascal * uncertainty.static_bias);
        add(Kind::change, 0, std::lround(height / band), hectopascal * uncertainty.static_change);
      };
      end_point(layer.first, layer.height_begin, layer.pressure_begin, -1.0);
      end_point(layer.last, layer.height_end, layer.pressure_end, 1.0);
      const auto climb = static_cast<long>(layer.climb);
      add(Kind::east, flight, 0, metre * layer.east * of_flight);
      add(Kind::north, flight, 0, metre * layer.north * of_flight);
      add(Kind::climb_east, flight, climb, metre * layer.east * of_climb);
      add(Kind::climb_north, flight, climb, metre * layer.north * of_climb);
      ++number;
    }
  }
  Eigen::MatrixXd covariance = Eigen::MatrixXd::Zero(count, count);
  for (const auto& [cause, errors] : causes) covariance += errors * errors.transpose();
  return covariance;
}

}  // namespace

FlightLayers find_layers(const FlightAir& air, const LayerOptions& options) {
  FlightLayers found;
  const std::vector<double> heights = usable_heights(air);
  const std::vector<Segment> segments = steady_segments(air, heights);
  const std::vector<double> climb_rate = climb_rates(air, heights, segments);
  const std::vector<Segment> level =
      parts_where(segments, [&](std::size_t i) { return std::abs(climb_rate[i]) < max_level_rate; });
  found.uncertainty = options;
  estimate_uncertainty(found.uncertainty, look_at_pieces(air, heights, climb_rate, segments),
                       look_at_pieces(air, heights, climb_rate, level), found.notes);
  std::vector<Segment> climbs;
  for (const double sign : {1.0, -1.0}) {
    const std::vector<Segment> parts =
        parts_where(segments, [&](std::size_t i) { return sign * climb_rate[i] > options.min_climb_rate; });
    climbs.insert(climbs.end(), parts.begin(), parts.end());
  }
  std::sort(climbs.begin(), climbs.end(),
            [](const Segment& a, const Segment& b) { return a.first < b.first; });
  std::size_t impossible = 0;
  std::size_t number = 0;
  for (const Segment& climb : climbs) {
    const std::size_t last = climb.first + climb.count - 1;
    const double thickness = heights[last] - heights[climb.first];
    if (std::abs(thickness) < options.min_thickness) continue;
    const double parts = std::max(1.0, std::round(std::abs(thickness) / options.thickness));
    std::size_t first = climb.first;
    for (double part = 1.0; part <= parts; part += 1.0) {
      std::size_t end = first;
      const double requested = std::abs(thickness) * part / parts;
      while (end < last && std::abs(heights[end] - heights[climb.first]) < requested) ++end;
      if (part == parts) end = last;
      if (end == first) continue;
      Layer layer = make_layer(air, heights, first, end);
      first = end;
      if (!(layer.hydrostatic_temperature() > 0.0)) {
        ++impossible;
        continue;
      }
      layer.climb = number;
      layer.errors = errors_of(layer, found.uncertainty);
      found.layers.push_back(layer);
    }
    ++number;
  }
  if (impossible > 0)
    found.notes.push_back(
        fmt::format("{} layers were not used, because their pressure rises with height", impossible));
  return found;
}

LayerFit fit_layers(const std::vector<FlightLayers>& flights) {
  LayerFit fit;
  for (const FlightLayers& flight : flights) fit.layers += flight.layers.size();
  if (fit.layers == 0) return fit;
  const auto count = static_cast<Eigen::Index>(fit.layers);
  Eigen::VectorXd differences(count);
  Eigen::VectorXd temperatures(count);
  Eigen::Index row = 0;
  for (const FlightLayers& flight : flights) {
    for (const Layer& layer : flight.layers) {
      differences(row) = layer.difference();
      temperatures(row++) = layer.measured_temperature();
    }
  }
  const Eigen::MatrixXd covariance = covariance_of(flights, count);
  // Whitened by the covariance, the line is ordinary least squares.
  const Cholesky root(covariance);
  const Eigen::VectorXd y = root.whiten(differences);
  const Eigen::VectorXd ones = root.whiten(Eigen::VectorXd(Eigen::VectorXd::Ones(count)));
  const double weight = ones.squaredNorm();
  const double mean = ones.dot(y) / weight;
  Eigen::VectorXd rest = y - mean * ones;
  fit.offset = {mean, 1.0 / std::sqrt(weight)};
  std::size_t degrees_of_freedom = fit.layers - 1;
  if (fit.layers >= 3 && temperatures.maxCoeff() - temperatures.minCoeff() >= min_range) {
    fit.centre = ones.dot(root.whiten(temperatures)) / weight;
    const Eigen::VectorXd tilted = root.whiten(Eigen::VectorXd(temperatures.array() - fit.centre));
    fit.c0 = fit.offset;
    fit.c1 = {tilted.dot(y) / tilted.squaredNorm(), 1.0 / tilted.norm()};
    fit.offset = fit.correction_at(temperatures.mean());
    rest -= fit.c1.value * tilted;
    degrees_of_freedom = fit.layers - 2;
  }
  if (degrees_of_freedom > 0)
    fit.error_scale = std::max(1.0, std::sqrt(rest.squaredNorm() / static_cast<double>(degrees_of_freedom)));
  for (Estimate* const each : {&fit.offset, &fit.c0, &fit.c1}) each->error *= fit.error_scale;
  return fit;
}

}  // namespace pcor::internal

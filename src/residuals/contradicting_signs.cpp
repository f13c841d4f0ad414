#include <fmt/format.h>

#include <cmath>
#include <cstddef>
#include <string_view>

#include <pcor/base/note.hpp>
#include <pcor/numerics/line_fit.hpp>
#include <pcor/physics/constants.hpp>
#include "numerics/missing.hpp"
#include "residuals/samples.hpp"

namespace pcor::internal {
namespace {

using Series = std::vector<double>;

constexpr double window = 10.0;          // s: longer than a gust, shorter than a manoeuvre
constexpr double min_time = 600.0;       // s: sixty windows, which chance does not reach
constexpr double min_correlation = 0.5;  // the minimum of recorded pairs, sideslip and drift, is 0.55

/// Two series that increase and decrease together, with their names in a sentence.
struct SignPair {
  std::string_view first_name;
  Series first;
  std::string_view second_name;
  Series second;
  double min_rms;         ///< minimum rms of the second; below it the aircraft did not move
  std::string_view turn;  ///< setting in the [units] of a model that inverts one of them
};

/// Sum of two series of one length, the second times `sign`; empty if one was not recorded.
Series sum(Series first, const Series& second, double sign) {
  if (first.size() != second.size()) return {};
  for (std::size_t i = 0; i < first.size(); ++i) first[i] += sign * second[i];
  return first;
}

std::vector<SignPair> pairs_of(const FlightSamples& samples) {
  const FlightMotion& motion = samples.motion;
  const auto half = static_cast<std::size_t>(std::lround(window / 2.0 / samples.step));
  // Increase of a series around each sample in `window`, NaN across gaps; for an angle on the circle.
  const auto rise = [&](const Series& values, bool is_angle = false) {
    Series changes(values.size(), nan);
    for (std::size_t i = half; i + half < values.size(); ++i) {
      if (samples.time[i + half] - samples.time[i - half] > 1.5 * window) continue;
      const double change = values[i + half] - values[i - half];
      changes[i] = is_angle ? std::remainder(change, 360.0) : change;
    }
    return changes;
  };
  const Series altitude = rise(motion.altitude);
  const Series heading = rise(motion.heading, true);
  Series fall = rise(*samples.model.find(Quantity::static_pressure));
  for (double& each : fall) each = -each;
  Series climb = motion.vertical_speed;  // angle, deg
  for (std::size_t i = 0; i < climb.size(); ++i)
    climb[i] = std::atan2(climb[i], motion.airspeed[i]) / constants::radians_per_degree;
  // If the nose points to port, the wind comes from starboard.
  const Series drift = sum(motion.ground_track, motion.heading, -1.0);
  return {{"the vertical speed", motion.vertical_speed, "the change of altitude", altitude, 5.0,
           R"(vertical_speed = "-1 m s-1" or altitude = "-1 m")"},
          {"the decrease of the static pressure", fall, "the change of altitude", altitude, 5.0,
           R"(altitude = "-1 m")"},
          {"the roll", motion.roll, "the rate of the heading", heading, 2.0,
           R"(roll = "-1 degree" or heading = "-1 degree")"},
          {"the rate of the ground track", rise(motion.ground_track, true), "the rate of the heading",
           heading, 2.0, R"(ground_track = "-1 degree" or heading = "-1 degree")"},
          {"the angle of attack", rise(motion.attack), "the pitch minus the climb angle",
           rise(sum(motion.pitch, climb, -1.0)), 0.3, R"(attack = "-1 degree" or pitch = "-1 degree")"},
          {"the pitch", rise(motion.pitch), "the angle of attack plus the climb angle",
           rise(sum(motion.attack, climb, 1.0)), 0.3, R"(pitch = "-1 degree" or attack = "-1 degree")"},
          {"the sideslip", rise(motion.sideslip), "the drift angle", rise(drift, true), 0.3,
           R"(sideslip = "-1 degree" or ground_track = "-1 degree")"}};
}

/// Correlation between -1 and 1; NaN if too little moved, or one was not recorded.
double correlation_of(const SignPair& pair, const FlightSamples& samples, double min_airspeed) {
  if (pair.first.size() != pair.second.size()) return nan;
  PairMoments pairs;
  for (std::size_t i = 0; i < pair.first.size(); ++i) {
    if (std::isfinite(pair.first[i] + pair.second[i]) && samples.motion.airspeed[i] >= min_airspeed)
      pairs.add(pair.first[i], pair.second[i]);
  }
  const auto count = static_cast<double>(pairs.samples);
  const double squares = pairs.yy + count * pairs.mean_y * pairs.mean_y;
  if (count * samples.step < min_time || squares < count * pair.min_rms * pair.min_rms) return nan;
  return pairs.correlation();
}

}  // namespace

Notes contradicting_signs(const FlightSamples& samples, double min_airspeed) {
  Notes contradictions;
  for (const SignPair& pair : pairs_of(samples)) {
    const double correlation = correlation_of(pair, samples, min_airspeed);
    if (!(correlation < -min_correlation)) continue;
    contradictions.push_back(warning_note(
        fmt::format("a sign is wrong: set {} in [units] of the model; {} and {} have opposite signs "
                    "(correlation {:.2f})",
                    pair.turn, pair.first_name, pair.second_name, correlation)));
  }
  return contradictions;
}

}  // namespace pcor::internal

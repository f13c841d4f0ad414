#include "residuals/contradicting_signs.hpp"

#include <fmt/format.h>

#include <cmath>
#include <cstddef>
#include <string_view>

#include <pcor/base/note.hpp>
#include <pcor/physics/constants.hpp>
#include "numerics/missing.hpp"

namespace pcor::internal {
namespace {

using Series = std::vector<double>;

constexpr double window = 10.0;          // s: longer than a gust, shorter than a manoeuvre
constexpr double min_time = 600.0;       // s: sixty windows, which chance does not reach
constexpr double min_correlation = 0.5;  // the minimum of recorded pairs, sideslip and drift, is 0.55

/// Increase of a series around each sample in `window`, NaN across gaps; for an angle on the circle.
Series rise_of(const Series& values, const Series& time, double step, bool is_angle = false) {
  Series rise(values.size(), nan);
  const auto half = static_cast<std::size_t>(std::lround(window / 2.0 / step));
  for (std::size_t i = half; i + half < values.size(); ++i) {
    if (time[i + half] - time[i - half] > 1.5 * window) continue;
    const double change = values[i + half] - values[i - half];
    rise[i] = is_angle ? std::remainder(change, 360.0) : change;
  }
  return rise;
}

/// Two series that increase and decrease together, with their names in a sentence.
struct SignPair {
  std::string_view first_name;
  Series first;
  std::string_view second_name;
  Series second;
  double min_rms;         ///< minimum rms of the second; below it the aircraft did not move
  std::string_view turn;  ///< setting in the [units] of a model that inverts one of them
};

class SignAgreement {
 public:
  SignAgreement(const FlightSamples& samples, double min_airspeed)
      : samples_(samples), motion_(samples.motion), min_airspeed_(min_airspeed) {}

  std::vector<SignPair> pairs() const {
    const Series altitude = rise(motion_.altitude);
    const Series heading = rise(motion_.heading, true);
    std::vector<SignPair> all;
    all.push_back({"the vertical speed", motion_.vertical_speed, "the change of altitude", altitude, 5.0,
                   R"(vertical_speed = "-1 m s-1" or altitude = "-1 m")"});
    if (const Series* const pressure = samples_.model.find(Quantity::static_pressure))
      all.push_back({"the fall of the static pressure", negative(rise(*pressure)), "the change of altitude",
                     altitude, 5.0, R"(altitude = "-1 m")"});
    all.push_back({"the roll", motion_.roll, "the turning of the heading", heading, 2.0,
                   R"(roll = "-1 degree" or heading = "-1 degree")"});
    all.push_back({"the turning of the ground track", rise(motion_.ground_track, true),
                   "the turning of the heading", heading, 2.0,
                   R"(ground_track = "-1 degree" or heading = "-1 degree")"});
    all.push_back({"the angle of attack", rise(motion_.attack), "the pitch above the path",
                   rise(pitch_above_path()), 0.3, R"(attack = "-1 degree" or pitch = "-1 degree")"});
    all.push_back({"the pitch", rise(motion_.pitch), "the angle of attack and of climb together",
                   rise(attack_and_climb()), 0.3, R"(pitch = "-1 degree" or attack = "-1 degree")"});
    all.push_back({"the sideslip", rise(motion_.sideslip), "the drift", rise(drift(), true), 0.3,
                   R"(sideslip = "-1 degree" or ground_track = "-1 degree")"});
    return all;
  }

  /// Correlation between -1 and 1; NaN if too little moved, or one was not recorded.
  double correlation(const SignPair& pair) const {
    if (pair.first.size() != pair.second.size()) return nan;
    double count = 0.0;
    double a = 0.0;
    double b = 0.0;
    double aa = 0.0;
    double bb = 0.0;
    double ab = 0.0;
    for (std::size_t i = 0; i < pair.first.size(); ++i) {
      const double x = pair.first[i];
      const double y = pair.second[i];
      if (!std::isfinite(x + y) || !(motion_.airspeed[i] >= min_airspeed_)) continue;
      count += 1.0;
      a += x;
      b += y;
      aa += x * x;
      bb += y * y;
      ab += x * y;
    }
    if (count * samples_.step < min_time || bb < count * pair.min_rms * pair.min_rms) return nan;
    return (ab - a * b / count) / std::sqrt((aa - a * a / count) * (bb - b * b / count));
  }

 private:
  Series rise(const Series& values, bool is_angle = false) const {
    return rise_of(values, samples_.time, samples_.step, is_angle);
  }

  static Series negative(Series values) {
    for (double& value : values) value = -value;
    return values;
  }

  /// Angle of climb, deg; empty without a vertical speed.
  Series climb() const {
    Series angle = motion_.vertical_speed;
    for (std::size_t i = 0; i < angle.size(); ++i)
      angle[i] = std::atan2(angle[i], motion_.airspeed[i]) / constants::radians_per_degree;
    return angle;
  }

  /// Sum of two series of one length, the second times `sign`; empty if one was not recorded.
  static Series sum(Series first, const Series& second, double sign) {
    if (first.size() != second.size()) return {};
    for (std::size_t i = 0; i < first.size(); ++i) first[i] += sign * second[i];
    return first;
  }

  /// Angle of attack without wind.
  Series pitch_above_path() const { return sum(motion_.pitch, climb(), -1.0); }

  /// Pitch without wind.
  Series attack_and_climb() const { return sum(motion_.attack, climb(), 1.0); }

  /// Ground track minus heading, deg: if the nose points to port, the wind comes from starboard.
  Series drift() const { return sum(motion_.ground_track, motion_.heading, -1.0); }

  const FlightSamples& samples_;
  const FlightMotion& motion_;
  double min_airspeed_;
};

}  // namespace

Notes contradicting_signs(const FlightSamples& samples, double min_airspeed) {
  Notes contradictions;
  if (samples.motion.airspeed.empty()) return contradictions;
  const SignAgreement signs(samples, min_airspeed);
  for (const SignPair& pair : signs.pairs()) {
    const double correlation = signs.correlation(pair);
    if (!(correlation < -min_correlation)) continue;
    contradictions.push_back(warning_note(
        fmt::format("{} and {} have opposite signs (correlation {:.2f}); invert the wrong one in the [units] "
                    "of the model, {}",
                    pair.first_name, pair.second_name, correlation, pair.turn)));
  }
  return contradictions;
}

}  // namespace pcor::internal

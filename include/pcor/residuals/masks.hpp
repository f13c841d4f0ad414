#pragma once

#include <pcor/regimes/regimes.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace pcor {

/// Why a sample takes no part in a comparison. The first reason that holds counts.
enum class Mask : std::uint8_t {
  none,            ///< it takes part
  excluded,        ///< the user excluded its time
  missing,         ///< a variable that the model reads has no value
  ground,          ///< the aircraft stands, taxis or rolls
  low_speed,       ///< airspeed below the limit
  regime,          ///< the user excluded the regime
  frozen,          ///< a sensor that the model or the reference reads stands still
  reference,       ///< a variable of the reference has no value; the laser is off
  laser_unlocked,  ///< the laser airspeed is far from what the pressures let expect
  burst,           ///< a pressure is disturbed for some seconds
  impossible,      ///< the values are there, but no delta-p follows from them
  flaps,           ///< flaps are out, and nothing else speaks against the sample
  count
};

inline constexpr std::size_t mask_count = static_cast<std::size_t>(Mask::count);

struct MaskInfo {
  std::string_view name;     ///< as in JSON, for example "low_speed"
  std::string_view meaning;  ///< in words that follow a number of samples
};

extern const std::array<MaskInfo, mask_count> mask_info;

/// For messages: the reasons why samples are not used, the largest first: "1203 on the ground, 17 laser ...".
std::string mask_text(const std::array<std::size_t, mask_count>& counts);

/// Flaps up to here are in, percent.
inline constexpr double flaps_in = 5.0;

/// Which samples take part in a comparison.
struct MaskOptions {
  double min_airspeed = 60.0;  ///< m/s; an aircraft flies above it
  /// Percent, where the flight records flaps. Not given it is `flaps_in`, but for a model of which an effect
  /// reads the flaps: that describes all samples, and all take part.
  std::optional<double> max_flaps{};
  /// Robust standard deviations of the flight, beside 3 % of the airspeed, between the laser airspeed and
  /// what the pressures let expect; beyond them the laser has lost its lock.
  double max_laser_departure = 6.0;
  std::vector<Regime> exclude{};  ///< regimes that take no part, besides the ground
  std::optional<UserIntervals> intervals{};
};

}  // namespace pcor

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
  flaps,           ///< flaps are out
  regime,          ///< the user excluded the regime
  reference,       ///< a variable of the reference has no value; the laser is off
  laser_unlocked,  ///< the laser airspeed is far from that of the pressures
  impossible,      ///< the values are there, but no delta-p follows from them
  count
};

inline constexpr std::size_t mask_count = static_cast<std::size_t>(Mask::count);

struct MaskFacts {
  std::string_view name;     ///< as in JSON, for example "low_speed"
  std::string_view meaning;  ///< in words that follow a number of samples
};

extern const std::array<MaskFacts, mask_count> mask_facts;

/// For messages: the reasons why samples are not used, the largest first: "1203 on the ground, 17 laser ...".
std::string mask_text(const std::array<std::size_t, mask_count>& counts);

/// Which samples take part in a comparison.
struct MaskOptions {
  double least_airspeed = 60.0;       ///< m/s; an aircraft flies above it
  double most_flaps = 5.0;            ///< percent, where the flight records flaps
  double most_laser_departure = 8.0;  ///< m/s between the laser airspeed and that of the pressures
  std::vector<Regime> exclude{};      ///< regimes that take no part, besides the ground
  std::optional<UserIntervals> intervals{};
};

}  // namespace pcor

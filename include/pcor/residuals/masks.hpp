#pragma once

#include <pcor/model/quantity.hpp>
#include <pcor/regimes/regimes.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace pcor {

/// Reason why a sample is not used in a comparison. If several apply, the first one counts.
enum class Mask : std::uint8_t {
  none,       ///< the sample is used
  excluded,   ///< time excluded by the user
  missing,    ///< a variable of the model has no value
  ground,     ///< the aircraft is parked, taxies or rolls
  low_speed,  ///< airspeed below the limit
  regime,     ///< regime excluded by the user
  frozen,     ///< a sensor of the model or the reference is frozen
  reference,  ///< a variable of the reference has no value; the laser is off
  /// Laser airspeed differs from the airspeed by the pressures by more than six robust standard deviations of
  /// the flight plus 3 % of the airspeed, or by 15 %, or most samples around it do.
  laser_unlocked,
  burst,       ///< a pressure is disturbed for a few seconds
  impossible,  ///< values are present, but delta-p cannot be computed from them
  flaps,       ///< flaps are extended, and no other reason applies
  count
};

inline constexpr std::size_t mask_count = static_cast<std::size_t>(Mask::count);

struct MaskInfo {
  std::string_view name;     ///< key in JSON, for example "low_speed"
  std::string_view meaning;  ///< clause after a number of samples
};

extern const std::array<MaskInfo, mask_count> mask_info;

/// Reasons for unused samples, by decreasing count, for messages: "1203 on the ground, 17 laser ...".
std::string mask_text(const std::array<std::size_t, mask_count>& counts);

/// Selection of samples for a comparison.
struct MaskOptions {
  double min_airspeed = 60.0;  ///< m/s; minimum airspeed in flight
  /// Percent; flaps that are inferred from the lift are 0 or 100. Default: `flaps_in`; no limit if an effect
  /// of the model reads the flaps.
  std::optional<double> max_flaps{};
  std::vector<Regime> exclude{};  ///< excluded regimes, in addition to the ground
  std::optional<UserIntervals> intervals{};
  /// Excluded in all flights, also if `intervals` is for one of them; s since 1970 UTC, never times of the
  /// day.
  std::vector<Exclusion> excluded_times{};
};

}  // namespace pcor

#pragma once

#include <optional>
#include <vector>

#include <pcor/residuals/samples.hpp>

namespace pcor::internal {

/// Samples with flaps out, inferred from the lift of a flight that does not record the flaps.
struct FlapsByLift {
  std::vector<bool> out{};  ///< state of every sample
  double deficit = 0.0;     ///< median relative deficit of the angle of attack with flaps out
  double deviation = 0.0;   ///< standard deviation of the deficit with flaps in
};

/// The angle of attack above the zero-lift angle is proportional to load factor over dynamic pressure, n/q;
/// with flaps out it is smaller. The relation of the clean wing is fitted to the flight, with a weight that
/// decreases with time, and with the compressibility of the flight: first to samples above the maximum speed
/// with flaps, then to all samples that are likely clean. Its error consists of the error of the fit, with
/// correlated residuals, and 5 % of the lever in n/q.
///
/// A two-state model covers pieces of 20 s: in, for an hour on average, and out, for ten minutes. In the
/// state out the angle is too small by 12 to 80 %, uniformly distributed; in the state in it follows the
/// relation, except for its error and one piece in a thousand with any value. The likelihood ratio of a piece
/// is limited to a factor of 20, since neighbours share their errors, and above the speed limit of the flaps
/// the state out becomes less probable with speed. Flaps are out if the probability is at least 90 %.
///
/// Nullopt if fewer than 15 pieces are above that speed, or the angle does not increase with n/q.
///
/// @param angle of attack, deg, or ADIFR/QCR, which is linear in it; of every sample
/// @param min_airspeed m/s; slower samples are not used
std::optional<FlapsByLift> find_flaps_by_lift(const FlightSamples& samples, const std::vector<double>& angle,
                                              double min_airspeed);

}  // namespace pcor::internal

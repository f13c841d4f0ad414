#pragma once

#include <optional>
#include <string>
#include <vector>

#include <pcor/residuals/samples.hpp>

namespace pcor::internal {

/// Where flaps are out, as the lift tells of a flight that does not record them.
struct FlapsByLift {
  std::vector<bool> out{};  ///< of every sample
  double deficit = 0.0;     ///< by how much the angle of attack is too small where they are, a part; a median
  double deviation = 0.0;   ///< of the same where they are in
};

/// The angle of attack above that without lift goes with load factor over dynamic pressure, n/q; flaps need a
/// part less of it. The law of the clean wing is fitted to the flight itself, with a weight that falls with
/// time and the flight's own compressibility: first to what is faster than flaps may be flown, then to all
/// that is likely clean. Its error is that of the fit, of correlated residuals, and 5 % of the lever in n/q.
///
/// Over pieces of 20 s, two states follow each other: in, for an hour on average, and out, for ten minutes.
/// Out the angle is too small by 12 to 80 %, each as likely; in it is as the law says, but for its error and
/// one piece in a thousand that is anywhere. A piece counts for no more than a factor of 20, since neighbours
/// share their errors, and above the speed of flaps the state out becomes the less likely the faster. Out is
/// what is so with 90 %.
///
/// Absent where fewer than 15 pieces are faster than that, or the angle does not rise with n/q.
///
/// @param angle of attack, deg, or ADIFR/QCR, which is linear in it; of every sample
/// @param min_airspeed m/s; slower samples do not count
std::optional<FlapsByLift> find_flaps_by_lift(const FlightSamples& samples, const std::vector<double>& angle,
                                              double min_airspeed);

/// "from 2004-02-18 15:04:42 to 15:13:02 UTC (500 samples)", and so on.
std::string times_of(const FlapsByLift& flaps, const std::vector<double>& time);

}  // namespace pcor::internal

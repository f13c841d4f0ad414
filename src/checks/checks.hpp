#pragma once

#include <array>
#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include <pcor/checks/check.hpp>
#include "campaign/flight_air.hpp"

namespace pcor::internal {

/// Pair of measured pressures, hPa, one value for each record.
struct MeasuredPair {
  std::string name{};  ///< label, for example "PSFRD/QCFR"
  std::vector<double> static_pressure{};
  std::vector<double> dynamic_pressure{};

  template <class Archive>
  void serialize(Archive& archive) {
    archive(name, static_pressure, dynamic_pressure);
  }
};

/// Inputs of the checks from one flight.
struct CheckedFlight {
  FlightAir air;
  std::optional<FlightAir> second{};  ///< second static system, if available
  std::string second_name{};          ///< name of the second system, for example "PSFRD/QCFR"
  bool second_corrected = false;      ///< corrected by its model; otherwise uncorrected
  /// Measured pairs of the two systems: if the flight's processing corrected the pressures of the first
  /// system, its first measured pair. Fewer if they are not recorded.
  std::vector<MeasuredPair> measured{};

  template <class Archive>
  void serialize(Archive& archive) {
    archive(air, second, second_name, second_corrected, measured);
  }
};

using CheckedFlights = std::vector<CheckedFlight>;

/// Whether a flight has this record interval, s, within 1 %: times are rounded, and may jitter.
inline bool has_step(const CheckedFlight& flight, double step) {
  return std::abs(flight.air.step() - step) < 0.01 * step;
}

/// Each check receives all flights, one or more, and returns a result without its name, whether it was run or
/// not.
CheckResult check_total_pressure(const CheckedFlights& flights);
CheckResult check_static_pressure(const CheckedFlights& flights);
CheckResult check_reverse_heading(const CheckedFlights& flights);
CheckResult check_circles(const CheckedFlights& flights);
CheckResult check_speed_run(const CheckedFlights& flights);
CheckResult check_pitch(const CheckedFlights& flights);
CheckResult check_yaw(const CheckedFlights& flights);
CheckResult check_layers(const CheckedFlights& flights);
CheckResult check_lams_temperature(const CheckedFlights& flights);
CheckResult check_spectrum(const CheckedFlights& flights);

struct NamedCheck {
  const char* name;
  CheckResult (*run)(const CheckedFlights& flights);
  bool expects_zero = true;  ///< false: the number of the check is a size, positive without any error
};

/// All checks, in the order of the memo. Declare and list new checks here.
inline constexpr std::array all_checks{
    NamedCheck{"total-pressure", check_total_pressure},
    NamedCheck{"static-pressure", check_static_pressure},
    NamedCheck{"reverse-heading", check_reverse_heading},
    NamedCheck{"circles", check_circles},
    NamedCheck{"speed-run", check_speed_run},
    NamedCheck{"pitch", check_pitch},
    NamedCheck{"yaw", check_yaw},
    NamedCheck{"layers", check_layers},
    NamedCheck{"lams-temperature", check_lams_temperature},
    NamedCheck{"spectrum", check_spectrum, false},
};

}  // namespace pcor::internal

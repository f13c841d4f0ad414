#pragma once

#include <pcor/simulate/simulate.hpp>
#include <string>
#include <vector>

#include "simulate/aircraft.hpp"
#include "simulate/effects.hpp"
#include "simulate/truth.hpp"

namespace pcor::internal::simulate {

/// Reading of a pair of pressures without noise.
struct PairReading {
  Series static_pressure;   ///< hPa
  Series dynamic_pressure;  ///< hPa
  Series defect;            ///< defect at the static port, hPa: p_port = p - d
};

/// Reading of the radome without noise.
struct RadomeReading {
  Series dynamic_pressure;  ///< QCR, hPa
  Series attack;            ///< ADIFR, hPa
  Series sideslip;          ///< BDIFR, hPa
};

/// Mach number, 1, with which `law` gives the defect of the first system: see `Scenario::Avionics`. It
/// approaches the true one as the laws fade.
Series mach_of_law(const Scenario& scenario, const Truth& truth, const AircraftInfo& aircraft);

/// Air to ports, lines and transducers of one pair.
PairReading read_pair(const Scenario::System& system, const SystemFaults& faults, const Truth& truth,
                      const AircraftInfo& aircraft);

/// The radome's ports; QCR has the static line of the pair whose defect is given.
RadomeReading read_radome(const Faults& faults, const Truth& truth, const AircraftInfo& aircraft,
                          const Series& defect);

/// Airspeed along the laser beam, m/s: the product of the vectors of the beam and of the aircraft's motion
/// through the air, in body axes (x forward, y starboard, z down). NaN without a laser signal.
Series read_lams(const Scenario& scenario, const Faults& faults, const Truth& truth,
                 const AircraftInfo& aircraft);

/// Recovery temperature, K. Temperature errors affect every thermometer.
Series read_thermometer(const Thermometer& thermometer, const Faults& faults, const Truth& truth);

/// First-order response to a series: tau dx/dt = u - x, exact for linear u between steps. `tau` = 0 returns
/// it unchanged.
Series with_response(Series series, double tau);

/// Series delayed by `seconds` (advanced if negative); its ends are held.
Series delayed(Series series, double seconds);

/// Recorded values of a sensor from its input: applies response, clock, noise and resolution of `variable`,
/// averages over the intervals of `rate` samples per second, then adds outliers and gaps.
std::vector<double> recorded(const Scenario& scenario, const Faults& faults, const std::string& variable,
                             Series series, int rate);

/// Means over the intervals of `rate` samples per second; NaN if fewer than half of the steps have a value.
std::vector<double> means(const Series& series, int rate);

}  // namespace pcor::internal::simulate

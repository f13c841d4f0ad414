#pragma once

#include <map>
#include <pcor/simulate/simulate.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "simulate/truth.hpp"

namespace pcor::internal::simulate {

/// What is wrong with one pair of pressures, at the place where it acts.
struct SystemFaults {
  Scenario::Law law;        ///< of the scenario, with the terms that effects add
  Series static_defect;     ///< at the static port beyond the law, hPa, as delta-p: p_port = p - d
  Series total_loss;        ///< at the pitot, hPa: pt_port = pt - l
  double static_lag = 0.0;  ///< time constant of the line, s
  double total_lag = 0.0;   ///< s
  Series static_head;       ///< of the air in the static line, which the transducer feels more, hPa
  double leak = 0.0;        ///< the part of the cabin's excess pressure that reaches the static line
  Series static_error;      ///< of the reading, hPa
  Series dynamic_error;     ///< hPa
  double dynamic_gain = 0.0;
};

/// All that is wrong. Series that nothing acts on are empty.
struct Faults {
  std::vector<SystemFaults> systems;
  Series lams_elevation;  ///< added to that of the beam, deg
  double lams_azimuth = 0.0;
  Series lams_speed;  ///< added to the airspeed that the beam meets, m/s
  double lams_scale = 0.0;
  double recovery = 0.0;  ///< added to the recovery factor
  double temperature_lag = 0.0;
  Series temperature_error;                ///< K
  Series attack_ratio;                     ///< added to ADIFR/QCR
  double attack_gain = 0.0;                ///< of ADIFR
  Series radome_loss;                      ///< of QCR, hPa
  double humidity_gain = 0.0;              ///< of the vapour pressure
  double dew_point = 0.0;                  ///< error of the dew point, K
  std::map<std::string, double> clock;     ///< by variable: its samples are so many seconds late
  std::map<std::string, double> response;  ///< by variable: time constant of the sensor, s
};

/// What an effect may act on.
enum class Target { instrument, system, variable };

/// A parameter of an effect. Without a usual value it has to be given.
struct FaultParameter {
  std::string_view key;
  std::string_view unit;
  double usual = Scenario::by_default;
};

/// An effect that a scenario may have: an id of the catalogue, but physics of its own.
struct FaultInfo {
  std::string_view id;
  Target target;
  std::vector<FaultParameter> parameters;
  void (*act)(const Scenario::Effect& effect, const Truth& truth, SystemFaults* system, Faults& faults);
};

/// Every effect that a scenario may have.
const std::vector<FaultInfo>& fault_info();

/// The facts of an effect, or null.
const FaultInfo* find_fault(std::string_view id);

/// The series that a scenario calls `name`: by its recorded name, its name as truth, or "hidden"; or null.
const Series Truth::*find_series(std::string_view name);

/// What the scenario's effects do along a flight.
Faults faults_of(const Scenario& scenario, const Truth& truth);

}  // namespace pcor::internal::simulate

#pragma once

#include <map>
#include <pcor/simulate/simulate.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "simulate/truth.hpp"

namespace pcor::internal::simulate {

/// Errors of one pair of pressures, by location.
struct SystemFaults {
  Scenario::Law law;  ///< law of the scenario, with the terms added by effects
  /// Defect at the static port in addition to the law, hPa, as delta-p: p_port = p - d.
  Series static_defect;
  Series total_loss;        ///< loss at the pitot, hPa: pt_port = pt - l
  double static_lag = 0.0;  ///< time constant of the line, s
  double total_lag = 0.0;   ///< s
  Series static_head;       ///< weight of the air in the static line, added at the transducer, hPa
  double leak = 0.0;        ///< the part of the cabin's excess pressure that reaches the static line
  Series static_error;      ///< error of the reading, hPa
  Series dynamic_error;     ///< hPa
  double dynamic_gain = 0.0;
};

/// Errors of all instruments. Series without an effect are empty.
struct Faults {
  std::vector<SystemFaults> systems;
  Series lams_elevation;  ///< added to that of the beam, deg
  double lams_azimuth = 0.0;
  Series lams_speed;  ///< airspeed added along the beam, m/s
  double lams_scale = 0.0;
  double recovery = 0.0;  ///< added to the recovery factor
  double temperature_lag = 0.0;
  Series temperature_error;                ///< K
  Series attack_ratio;                     ///< added to ADIFR/QCR
  double attack_gain = 0.0;                ///< relative error of ADIFR
  Series radome_loss;                      ///< loss of QCR, hPa
  double humidity_gain = 0.0;              ///< relative error of the vapour pressure
  double dew_point = 0.0;                  ///< error of the dew point, K
  std::map<std::string, double> clock;     ///< delay of the samples by variable, s
  std::map<std::string, double> response;  ///< time constant of the sensor by variable, s
};

/// Possible target of an effect.
enum class Target { instrument, system, variable };

/// A parameter of an effect. Without a usual value it has to be given.
struct FaultParameter {
  std::string_view key;
  std::string_view unit;
  double usual = Scenario::by_default;
};

/// Effect that a scenario may have: an id of the catalogue, with independent physics.
struct FaultInfo {
  std::string_view id;
  Target target;
  std::vector<FaultParameter> parameters;
  void (*act)(const Scenario::Effect& effect, const Truth& truth, SystemFaults* system, Faults& faults);
  double Scenario::Law::*term = nullptr;  ///< the term of a law that the effect adds to, if any
};

/// Every effect that a scenario may have.
const std::vector<FaultInfo>& fault_info();

/// The facts of an effect, or null.
const FaultInfo* find_fault(std::string_view id);

/// The series that a scenario calls `name`: by its recorded name, its name as truth, or "hidden"; or null.
const Series Truth::*find_series(std::string_view name);

/// Errors along a flight due to the scenario's effects.
Faults faults_of(const Scenario& scenario, const Truth& truth);

}  // namespace pcor::internal::simulate

#pragma once

#include <array>
#include <pcor/simulate/simulate.hpp>
#include <string_view>
#include <vector>

#include "simulate/aircraft.hpp"
#include "simulate/truth.hpp"

namespace pcor::internal::simulate {

/// Kind of leg: its name in scenarios and the numbers it uses.
struct LegInfo {
  Scenario::Leg::Kind kind;
  std::string_view name;
  std::string_view keys;  ///< separated by spaces
};

inline constexpr std::array<LegInfo, 12> leg_info{{
    {Scenario::Leg::Kind::ground, "ground", "duration"},
    {Scenario::Leg::Kind::take_off, "take-off", "altitude speed rate flaps"},
    {Scenario::Leg::Kind::climb, "climb", "altitude speed rate"},
    {Scenario::Leg::Kind::descent, "descent", "altitude speed rate"},
    {Scenario::Leg::Kind::level, "level", "duration speed flaps"},
    {Scenario::Leg::Kind::pitch, "pitch", "period cycles amplitude speed"},
    {Scenario::Leg::Kind::yaw, "yaw", "period cycles amplitude speed"},
    {Scenario::Leg::Kind::speed_run, "speed-run", "low high rate"},
    {Scenario::Leg::Kind::reverse_heading, "reverse-heading", "duration roll speed"},
    {Scenario::Leg::Kind::circle, "circle", "roll angle speed"},
    {Scenario::Leg::Kind::turn, "turn", "roll angle speed"},
    {Scenario::Leg::Kind::landing, "landing", "speed rate flaps"},
}};

/// Sets missing numbers of a leg to the usual ones of the aircraft. Sizes of manoeuvres: NCAR's calibration
/// flights (QAtools, memo).
void complete(Scenario::Leg& leg, const AircraftInfo& aircraft);

/// Steps of one simulated leg: [first, last).
struct LegSteps {
  Scenario::Leg::Kind kind;
  std::size_t first;
  std::size_t last;
};

/// The whole flight, step by step, and the legs in it.
struct SimulatedPlan {
  Truth truth;
  std::vector<LegSteps> legs;
};

/// Flies the legs of a scenario one after another. @throws Error if one cannot be flown.
SimulatedPlan fly(const Scenario& scenario);

}  // namespace pcor::internal::simulate

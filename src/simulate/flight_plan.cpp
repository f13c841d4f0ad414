#include "simulate/flight_plan.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <pcor/physics/geodesy.hpp>

#include "simulate/pilot.hpp"

namespace pcor::internal::simulate {
namespace {

using Leg = Scenario::Leg;
using Kind = Scenario::Leg::Kind;

constexpr double two_pi = 6.283185307179586;
constexpr double usual_acceleration = 0.5;  // m/s2, between legs
constexpr double hold_rate = 3.0;           // m/s, for the return to a height

/// Flies legs with a pilot; remembers the height and speed to hold.
class Plan {
 public:
  explicit Plan(const Scenario& scenario)
      : pilot_(scenario), commanded_height_(scenario.atmosphere.ground_height) {
    for (const Leg& leg : scenario.legs) {
      const std::size_t steps = pilot_.truth().size();
      fly(leg);
      legs_.push_back({leg.kind, steps, pilot_.truth().size()});
    }
  }

  SimulatedPlan result() && { return {std::move(pilot_.truth()), std::move(legs_)}; }

 private:
  void fly(const Leg& leg) {
    switch (leg.kind) {
      case Kind::ground:
        for (std::size_t i = 0; i < steps_of(leg.duration); ++i) pilot_.step({}, leg);
        return;
      case Kind::take_off:
        return take_off(leg);
      case Kind::climb:
      case Kind::descent:
        return change_height(leg);
      case Kind::level:
        settle(leg);
        return hold_for(leg, leg.duration);
      case Kind::pitch:
        return pitch(leg);
      case Kind::yaw:
        return yaw(leg);
      case Kind::speed_run:
        return speed_run(leg);
      case Kind::reverse_heading:
        settle(leg);
        hold_for(leg, leg.duration);
        turn(leg, 180.0);
        return hold_for(leg, leg.duration);
      case Kind::circle:
      case Kind::turn:
        settle(leg);
        return turn(leg, leg.angle);
      case Kind::landing:
        return land(leg);
    }
  }

  void take_off(const Leg& leg) {
    constexpr double runway_acceleration = 2.0;  // m/s2, estimate
    const double lift_off = pilot_.aircraft().lift_off_speed;
    while (pilot_.speed() < lift_off) pilot_.step({0.0, runway_acceleration, 0.0, 0.0, leg.flaps}, leg);
    pilot_.set_on_ground(false);
    commanded_height_ = leg.altitude;
    commanded_speed_ = leg.speed;
    do {
      Command command = hold(leg.rate);
      command.acceleration = pilot_.towards_speed(commanded_speed_, 1.0);
      command.flaps = pilot_.speed() < pilot_.aircraft().min_speed ? leg.flaps : 0.0;
      pilot_.step(command, leg);
    } while (!arrived());
  }

  void change_height(const Leg& leg) {
    take_speed(leg);
    commanded_height_ = leg.altitude;
    do {
      pilot_.step(hold(leg.rate), leg);
    } while (!arrived());
  }

  // The vertical speed is W sin(2 pi t/P), growing over the first and dying over the last half cycle, which
  // leaves the height swinging about where it began. The power levers are not moved, so the airspeed
  // swings too.
  void pitch(const Leg& leg) {
    settle(leg);
    const double duration = leg.period * leg.cycles;
    const double frequency = two_pi / leg.period;
    const double peak = leg.amplitude / frequency;
    const double ramp = 0.5 * leg.period;
    const auto vertical_speed = [&](double t) {
      const double envelope = std::clamp(std::min(t, duration - t) / ramp, 0.0, 1.0);
      return peak * envelope * std::sin(frequency * t);
    };
    const double initial_vertical_speed = pilot_.vertical_speed();  // removed after the first half cycle
    for (std::size_t i = 0; i < steps_of(duration); ++i) {
      const double t = time_step * static_cast<double>(i);
      Command command;
      command.vertical_acceleration = (vertical_speed(t + time_step) - vertical_speed(t)) / time_step;
      if (t < ramp) command.vertical_acceleration -= initial_vertical_speed / ramp;
      command.acceleration = -constants::standard_gravity * pilot_.vertical_speed() / pilot_.speed();
      pilot_.step(command, leg);
    }
  }

  void yaw(const Leg& leg) {
    settle(leg);
    const double duration = leg.period * leg.cycles;
    for (std::size_t i = 0; i < steps_of(duration); ++i) {
      const double t = time_step * static_cast<double>(i);
      Command command = hold(hold_rate);
      const double envelope = std::clamp(std::min(t, duration - t) / (0.5 * leg.period), 0.0, 1.0);
      command.sideslip = leg.amplitude * envelope * std::sin(two_pi * t / leg.period);
      pilot_.step(command, leg);
    }
  }

  // Slow, fast, slow again, then the speed that was before.
  void speed_run(const Leg& leg) {
    const double before = commanded_speed_;
    for (const double speed : {leg.low, leg.high, leg.low, before}) {
      commanded_speed_ = speed;
      do {
        pilot_.step(hold(hold_rate, leg.rate), leg);
      } while (!at_speed());
    }
  }

  // Turns at the bank of the leg; rolls out in proportion to the remaining angle.
  void turn(const Leg& leg, double angle) {
    constexpr double done = 0.3;      // deg
    constexpr double roll_out = 3.0;  // deg of bank per deg of remaining turn
    const double target = pilot_.direction() + angle;
    while (std::abs(target - pilot_.direction()) > done) {
      Command command = hold(hold_rate);
      command.roll = std::clamp(roll_out * (target - pilot_.direction()), -leg.roll, leg.roll);
      pilot_.step(command, leg);
    }
    while (std::abs(pilot_.roll()) > 1e-9) pilot_.step(hold(hold_rate), leg);
  }

  void land(const Leg& leg) {
    constexpr double brakes = 1.5;      // m/s2, estimate
    constexpr double touch_down = 0.5;  // m
    commanded_speed_ = leg.speed;
    commanded_height_ = pilot_.height_of_ground();
    while (pilot_.height() - commanded_height_ > touch_down) {
      Command command = hold(leg.rate);
      // Decelerates in level flight first, until flaps can be extended.
      if (pilot_.speed() < pilot_.aircraft().min_speed + 5.0) command.flaps = leg.flaps;
      pilot_.step(command, leg);
    }
    pilot_.set_on_ground(true);
    while (pilot_.speed() > 0.0) {
      Command command{pilot_.towards_height(commanded_height_, hold_rate), -brakes, 0.0, 0.0, leg.flaps};
      pilot_.step(command, leg);
    }
  }

  static std::size_t steps_of(double duration) {
    return static_cast<std::size_t>(std::lround(duration * internal_rate));
  }

  Command hold(double rate, double acceleration = usual_acceleration) {
    Command command;
    command.vertical_acceleration = pilot_.towards_height(commanded_height_, rate);
    command.acceleration = pilot_.towards_speed(commanded_speed_, acceleration);
    command.flaps = commanded_flaps_;
    return command;
  }

  void hold_for(const Leg& leg, double duration) {
    for (std::size_t i = 0; i < steps_of(duration); ++i) pilot_.step(hold(hold_rate), leg);
  }

  void take_speed(const Leg& leg) {
    if (!std::isnan(leg.speed)) commanded_speed_ = leg.speed;
    commanded_flaps_ = std::isnan(leg.flaps) ? 0.0 : leg.flaps;
  }

  // Reaches the speed and flaps of a leg before it counts.
  void settle(const Leg& leg) {
    take_speed(leg);
    while (!at_speed() || !arrived() || std::abs(pilot_.flaps() - commanded_flaps_) > 0.5)
      pilot_.step(hold(hold_rate), leg);
  }

  bool at_speed() const { return std::abs(pilot_.speed() - commanded_speed_) < 0.2; }
  bool arrived() const {
    return std::abs(pilot_.height() - commanded_height_) < 2.0 && std::abs(pilot_.vertical_speed()) < 0.3;
  }

  Pilot pilot_;
  std::vector<LegSteps> legs_;
  double commanded_height_, commanded_speed_ = 0.0, commanded_flaps_ = 0.0;
};

}  // namespace

void complete(Leg& leg, const AircraftInfo& aircraft) {
  const struct {
    Kind kind;
    double Leg::*number;
    double value;
  } usual[] = {
      {Kind::ground, &Leg::duration, 120.0},
      {Kind::take_off, &Leg::altitude, 1000.0},
      {Kind::take_off, &Leg::speed, 1.25 * aircraft.min_speed},
      {Kind::take_off, &Leg::rate, aircraft.climb_rate},
      {Kind::take_off, &Leg::flaps, 50.0},
      {Kind::climb, &Leg::rate, aircraft.climb_rate},
      {Kind::descent, &Leg::rate, aircraft.climb_rate},
      {Kind::level, &Leg::duration, 300.0},
      {Kind::level, &Leg::flaps, 0.0},
      {Kind::pitch, &Leg::period, 20.0},
      {Kind::pitch, &Leg::cycles, 8.0},
      {Kind::pitch, &Leg::amplitude, 4.0},
      {Kind::yaw, &Leg::period, 12.0},
      {Kind::yaw, &Leg::cycles, 12.0},
      {Kind::yaw, &Leg::amplitude, 4.0},
      {Kind::speed_run, &Leg::low, aircraft.speed_run_low},
      {Kind::speed_run, &Leg::high, aircraft.speed_run_high},
      {Kind::speed_run, &Leg::rate, aircraft.speed_run_rate},
      {Kind::reverse_heading, &Leg::duration, 240.0},
      {Kind::reverse_heading, &Leg::roll, 20.0},
      {Kind::circle, &Leg::angle, 360.0},
      {Kind::circle, &Leg::roll, 26.7},
      {Kind::turn, &Leg::angle, 90.0},
      {Kind::turn, &Leg::roll, 20.0},
      {Kind::landing, &Leg::speed, 1.1 * aircraft.lift_off_speed},
      {Kind::landing, &Leg::rate, 4.0},
      {Kind::landing, &Leg::flaps, 50.0},
  };
  for (const auto& [kind, number, value] : usual)
    if (kind == leg.kind && std::isnan(leg.*number)) leg.*number = value;
}

SimulatedPlan fly(const Scenario& scenario) { return Plan(scenario).result(); }

}  // namespace pcor::internal::simulate

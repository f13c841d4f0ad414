#pragma once

#include <optional>
#include <pcor/simulate/simulate.hpp>

#include "simulate/air.hpp"
#include "simulate/aircraft.hpp"
#include "simulate/random.hpp"
#include "simulate/truth.hpp"

namespace pcor::internal::simulate {

/// Command to the aircraft for one step.
struct Command {
  double vertical_acceleration = 0.0;  ///< m/s2
  double acceleration = 0.0;           ///< change of the airspeed, m/s2
  double roll = 0.0;                   ///< deg
  double sideslip = 0.0;               ///< deg
  double flaps = 0.0;                  ///< percent
};

/// Flies the aircraft through the air by steps of `time_step` and writes down what is true in each.
///
/// The angle of attack is the one at which the wing carries the weight, so it depends on airspeed, weight,
/// load factor and flaps. Gusts change airspeed and flow angles immediately; vertical and lateral ones slower
/// than 1.5 s carry the aircraft with them.
class Pilot {
 public:
  explicit Pilot(const Scenario& scenario);

  /// One step. `leg` is for messages. @throws Error beyond the stall or the Mach limit.
  void step(const Command& command, const Scenario::Leg& leg);

  /// The vertical acceleration, m/s2, that leads to a height (m, along the isobars) at a vertical speed of at
  /// most `rate` m/s.
  double towards_height(double height, double rate);

  /// The acceleration, m/s2, that leads to an airspeed (m/s), at most `limit`.
  double towards_speed(double speed, double limit) const;

  double height() const { return height_ - isobar_height(); }
  double vertical_speed() const { return vertical_speed_; }
  double speed() const { return speed_; }
  double direction() const { return direction_; }  ///< direction of motion through the air, deg
  double flaps() const { return flaps_; }
  double roll() const { return roll_; }
  double height_of_ground() const { return scenario_.atmosphere.ground_height; }
  const AircraftInfo& aircraft() const { return aircraft_; }
  void set_on_ground(bool on_ground) { on_ground_ = on_ground; }

  Truth& truth() { return truth_; }

 private:
  struct Cloud {
    const Scenario::Cloud* layer;
    double threshold;  // threshold of the drift for cloud
    Drift drift;
  };

  double isobar_height() const;
  /// The height in the column over the start that has this geopotential: isobars follow the geopotential, and
  /// gravity grows towards the poles.
  double column_height() const;
  double liquid_water();

  const Scenario& scenario_;
  const AircraftInfo& aircraft_;
  Column column_;
  Turbulence gust_along_, gust_across_, gust_up_;
  Drift drift_east_, drift_north_, trim_, hidden_;
  std::vector<Cloud> clouds_;
  Truth truth_;

  double east_ = 0.0, north_ = 0.0, height_;  // m
  double speed_ = 0.0, vertical_speed_ = 0.0;
  double direction_, roll_ = 0.0, flaps_ = 0.0;  // deg, deg, percent
  double weight_;
  double followed_up_ = 0.0, followed_across_ = 0.0;  // gusts that carry the aircraft with them, m/s
  double smooth_vertical_ = 0.0;                      // m/s2
  std::optional<double> cabin_, bay_;
  bool on_ground_ = true;
};

}  // namespace pcor::internal::simulate

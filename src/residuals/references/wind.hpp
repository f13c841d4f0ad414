#pragma once

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include <pcor/base/error.hpp>
#include <pcor/physics/constants.hpp>
#include "numerics/missing.hpp"
#include "residuals/ground_velocity.hpp"
#include "residuals/references/windowed.hpp"
#include "roles/recorded_series.hpp"

namespace pcor::internal {

/// Time over which the wind is assumed constant, s: long enough for a pair of reverse headings, or a few
/// circles.
inline constexpr double wind_window = 900.0;

/// Residual of sample i:
///
///     r_i = (d_i - w_i)/s_i,   d = V cos(beta) cos(gamma) - (ground velocity along the heading)
///
/// with the true airspeed V of the model, the sideslip beta, the angle of climb gamma, and w the part of d
/// due to a constant wind over the window, W_e sin(heading) + W_n cos(heading), by least squares together
/// with a constant, which remains in the residual. s is the decrease of the airspeed by 1 hPa of delta-p, m/s
/// per hPa, for a given temperature:
///
///     s = V/2 (2/7) (1 + q/p)^(-5/7) (p + q)/p^2 / ((1 + q/p)^(2/7) - 1)
///
/// Source: memo eq. 5-7, differentiated at constant total pressure. Samples with a frozen heading or ground
/// velocity are excluded from the wind fit.
class WindOnSamples final : public WindowedResidual<WindOnSamples, 1> {
 public:
  WindOnSamples(const FlightSamples& samples, const ModelOnSamples& model)
      : WindowedResidual(model, samples, wind_window),
        read_(samples.reference),
        heading_(*read_.find(Quantity::heading)),
        along_(ground_speed_along_heading()),
        motion_(samples.motion),
        static_pressure_(*samples.model.find(Quantity::static_pressure)),
        dynamic_pressure_(*samples.model.find(Quantity::dynamic_pressure)) {}

  /// The quantity d, m/s.
  template <class S>
  Parts<S> parts_of(std::size_t sample, const S* parameters) const {
    if (!is_flying(sample)) return {missing<S>()};
    State<S> state;
    law().air(sample, parameters, state);
    return {state[Quantity::corrected_airspeed] * S(along_heading(sample)) - S(along_[sample])};
  }

  std::vector<Batch::Input> columns() const override {
    std::vector<Batch::Input> inputs;
    for (const auto& [quantity, values] : read_.columns) inputs.push_back({quantity, values.data()});
    return inputs;
  }

  template <class S>
  void find(const IndexRange span, const std::vector<Parts<S>>& parts,
            const std::vector<std::size_t>& samples, S* out) const {
    std::vector<Sums<S>> sums(span.length() + 1);  // sums over all previous samples
    for (std::size_t k = 0; k < span.length(); ++k) {
      sums[k + 1] = sums[k];
      const S& difference = parts[k][0];
      if (is_finite(difference)) sums[k + 1].add(heading_[span.first + k], difference);
    }
    for (std::size_t i = 0; i < samples.size(); ++i) {
      out[i] = missing<S>();
      if (!is_flying(samples[i])) continue;
      const std::size_t k = samples[i] - span.first;
      const Sums<S>& before = sums[k - std::min(k, half_width())];
      const Sums<S>& after = sums[std::min(k + half_width() + 1, span.length())];
      const S residual = parts[k][0] - after.wind_along(heading_[samples[i]], before);
      out[i] = residual / S(speed_of_defect(samples[i]));
    }
  }

 private:
  /// Sums of least squares for the wind and a constant.
  template <class S>
  struct Sums {
    Eigen::Matrix3d moments = Eigen::Matrix3d::Zero();
    Eigen::Matrix<S, 3, 1> products = Eigen::Matrix<S, 3, 1>::Constant(S(0.0));

    void add(double heading, const S& difference) {
      const Eigen::Vector3d columns = columns_at(heading, 1.0);
      moments += columns * columns.transpose();
      products += columns.template cast<S>() * difference;
    }

    /// Component of the wind along a heading, m/s, from the samples since `before`.
    S wind_along(double heading, const Sums& before) const {
      // On one heading wind and constant are collinear: a wind is about 30 m/s, an error of the airspeed 1
      // m/s, and the mean of all samples is known to 1 m/s.
      const Eigen::Vector3d prior(1.0 / 900.0, 1.0 / 900.0, 1.0);
      Eigen::Matrix3d matrix = moments - before.moments;
      matrix.diagonal() += prior;
      const Eigen::Vector3d weights = matrix.llt().solve(columns_at(heading, 0.0));
      S along(0.0);
      for (Eigen::Index k = 0; k < 3; ++k) along = along + S(weights[k]) * (products[k] - before.products[k]);
      return along;
    }

    static Eigen::Vector3d columns_at(double heading, double constant) {
      const double angle = heading * constants::radians_per_degree;
      return {std::sin(angle), std::cos(angle), constant};
    }
  };

  /// NaN if a sensor is frozen.
  std::vector<double> ground_speed_along_heading() const {
    std::vector<double> along = *read_.find(Quantity::ground_speed);
    const std::vector<double>& track = *read_.find(Quantity::ground_track);
    for (std::size_t i = 0; i < along.size(); ++i)
      along[i] *= std::cos((track[i] - heading_[i]) * constants::radians_per_degree);
    for (const FrozenSpan& span : read_.frozen)
      std::fill_n(along.begin() + static_cast<std::ptrdiff_t>(span.first), span.count, nan);
    return along;
  }

  /// On the ground the wheels set the speed, and slow flow gives no airspeed.
  bool is_flying(std::size_t sample) const {
    constexpr double min_airspeed = 40.0;  // m/s
    return !motion_.airspeed.empty() && motion_.airspeed[sample] > min_airspeed;
  }

  /// Horizontal component of the airspeed along the heading.
  double along_heading(std::size_t sample) const {
    double part = 1.0;
    if (!motion_.sideslip.empty() && std::isfinite(motion_.sideslip[sample]))
      part = std::cos(motion_.sideslip[sample] * constants::radians_per_degree);
    if (motion_.vertical_speed.empty()) return part;
    const double climb = motion_.vertical_speed[sample] / motion_.airspeed[sample];
    return std::abs(climb) < 1.0 ? part * std::sqrt(1.0 - climb * climb) : part;
  }

  double speed_of_defect(std::size_t sample) const {
    const double p = static_pressure_[sample];
    const double q = dynamic_pressure_[sample];
    const double ratio = 1.0 + q / p;
    return motion_.airspeed[sample] / 7.0 * std::pow(ratio, -5.0 / 7.0) * (p + q) / (p * p) /
           (std::pow(ratio, 2.0 / 7.0) - 1.0);
  }

  const ModelSamples& read_;
  const std::vector<double>& heading_;  // deg
  std::vector<double> along_;           // ground velocity along the heading, m/s
  const FlightMotion& motion_;
  const std::vector<double>& static_pressure_;
  const std::vector<double>& dynamic_pressure_;
};

class WindReference final : public WindowedReference<WindOnSamples> {
 public:
  using WindowedReference::WindowedReference;

  std::string description() const override { return "airspeed against ground speed and a steady wind"; }
  std::string name() const override { return "wind"; }

  ModelSamples read(const Flight& flight, const std::vector<double>& time, Notes& notes) const override {
    RecordedSeries heading = read_role(flight, file(), Quantity::heading);
    GroundVelocity ground = read_ground_velocity(flight, file());
    if (heading.values.empty() || ground.speed.values.empty()) {
      throw Error(Error::Code::variable,
                  flight.path().string() +
                      ": no true heading and ground velocity with units (for example THDG, GGSPD, GGTRK), "
                      "which the reference wind requires; name them in the table [variables] of the model");
    }
    for (const Jump& jump : ground.jumps)
      notes.push_back(format_jump(ground.speed.variable, jump, time, "m/s") + ", which are excluded");
    for (const Jump& jump : ground.against_position)
      notes.push_back(format_jump(ground.speed.variable + " against the positions", jump, time, "m/s") +
                      ", which are excluded");
    ModelSamples samples;
    const auto add = [&samples](Quantity quantity, RecordedSeries& series) {
      samples.columns.emplace_back(quantity, std::move(series.values));
      samples.variables.emplace_back(quantity, std::move(series.variable));
    };
    add(Quantity::heading, heading);
    add(Quantity::ground_speed, ground.speed);
    add(Quantity::ground_track, ground.track);
    return samples;
  }
};

}  // namespace pcor::internal

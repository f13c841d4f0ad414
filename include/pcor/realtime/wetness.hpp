#pragma once

#include <cmath>

#include <pcor/effects/in_cloud.hpp>
#include <pcor/physics/scalar.hpp>

namespace pcor {

/// How wet a probe is, from 0, dry, to 1, sample by sample: in cloud it gets wet within seconds, after it
/// dries.
///
///     tau dw/dt = c - w     c = 1 in cloud, otherwise 0;   tau = 1 s in cloud, the time of drying outside
///
/// The result is the mean of w over the sample, exact if the whole sample is in or out of cloud, so that all
/// rates agree. The initial state is that of a probe that has long been in the conditions of the first
/// sample. A missing liquid water content gives NaN, while the probe dries.
class Wetness {
 public:
  static constexpr double wetting = 1.0;    ///< s, estimate
  static constexpr double longest = 600.0;  ///< s, of drying

  /// @param rate samples in a second, above zero @param drying time constant, s, 0 to `longest`
  Wetness(double rate, double drying)
      : step_(1.0 / rate), drying_(drying), wet_(step_, wetting), dry_(step_, drying) {}

  /// Clears all samples.
  void reset() noexcept { wetness_ = missing<double>(); }

  /// @param liquid_water g/m3
  /// @param step s since the previous sample; NaN: the last step, at first that of the rate
  double operator()(double liquid_water, double step = missing<double>()) noexcept {
    constexpr double tolerance = 1e-6;
    if (std::abs(step - step_) > tolerance * step_) {
      step_ = step;
      wet_ = Answer(step, wetting);
      dry_ = Answer(step, drying_);
    }
    const double cloud = effects::in_cloud(liquid_water);
    const double towards = cloud > 0.0 ? 1.0 : 0.0;
    const Answer& answer = cloud > 0.0 ? wet_ : dry_;
    if (is_missing(wetness_)) wetness_ = towards;
    const double away = wetness_ - towards;
    wetness_ = towards + away * answer.remaining;
    return is_missing(cloud) ? cloud : towards + away * answer.mean;
  }

 private:
  /// Remaining fraction of the distance from equilibrium, after a sample and averaged over it.
  struct Answer {
    Answer(double step, double tau)
        : remaining(tau > 0.0 ? std::exp(-step / tau) : 0.0), mean(tau / step * (1.0 - remaining)) {}
    double remaining;
    double mean;
  };

  double step_;  // s
  double drying_;
  Answer wet_;
  Answer dry_;
  double wetness_ = missing<double>();
};

}  // namespace pcor

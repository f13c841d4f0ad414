#pragma once

#include <Eigen/Dense>
#include <array>
#include <cmath>

#include <pcor/fit/loss.hpp>
#include "numerics/missing.hpp"
#include "numerics/robust_weights.hpp"

namespace pcor::internal {

/// The loss of residuals whose robust deviation is known; least squares where that is zero.
class ScaledLoss {
 public:
  ScaledLoss() = default;  // least squares
  ScaledLoss(Loss loss, double deviation) {
    if (loss == Loss::huber && deviation > 0.0) width_ = huber_width * deviation;
  }

  /// The loss of a residual, and its first and second derivative by the square of the residual.
  std::array<double, 3> operator()(double residual) const {
    const double square = residual * residual;
    if (!(square > width_ * width_)) return {square, 1.0, 0.0};
    const double size = std::sqrt(square);
    const double slope = width_ / size;
    return {2.0 * width_ * size - width_ * width_, slope, -slope / (2.0 * square)};
  }

  /// Weight of each residual: the first derivative.
  Eigen::VectorXd weights(const Eigen::VectorXd& residuals) const {
    return residuals.unaryExpr([this](double residual) { return (*this)(residual)[1]; });
  }

  bool is_least_squares() const { return std::isinf(width_); }

 private:
  double width_ = infinity;
};

}  // namespace pcor::internal

#pragma once

#include <ceres/loss_function.h>

#include <Eigen/Dense>
#include <array>
#include <memory>

#include <pcor/fit/loss.hpp>
#include "numerics/robust_weights.hpp"

namespace pcor::internal {

/// The loss of residuals whose robust deviation is known; least squares where that is zero.
class ScaledLoss {
 public:
  ScaledLoss() = default;  // least squares
  ScaledLoss(Loss loss, double deviation) {
    if (loss == Loss::huber && deviation > 0.0)
      function_ = std::make_shared<ceres::HuberLoss>(huber_width * deviation);
  }

  /// The loss of a residual, and its first and second derivative by the square of the residual.
  std::array<double, 3> operator()(double residual) const {
    std::array<double, 3> rho{residual * residual, 1.0, 0.0};
    if (function_) function_->Evaluate(rho[0], rho.data());
    return rho;
  }

  /// Weight of each residual: the first derivative.
  Eigen::VectorXd weights(const Eigen::VectorXd& residuals) const {
    return residuals.unaryExpr([this](double residual) { return (*this)(residual)[1]; });
  }

  bool is_least_squares() const { return function_ == nullptr; }

 private:
  std::shared_ptr<const ceres::LossFunction> function_;
};

}  // namespace pcor::internal

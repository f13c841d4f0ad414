#pragma once

#include <ceres/loss_function.h>

#include <memory>

#include <pcor/fit/loss.hpp>

namespace pcor::internal {

/// Beyond so many robust deviations Tukey's loss gives a sample no weight: 95 % efficiency on normal noise
/// (Holland and Welsch 1977, Communications in Statistics A6, 813).
inline constexpr double tukey_width = 4.685;

/// The loss of residuals whose robust deviation is `deviation`; null for least squares, and where there is no
/// deviation.
std::unique_ptr<ceres::LossFunction> loss_function(Loss loss, double deviation);

}  // namespace pcor::internal

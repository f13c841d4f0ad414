#pragma once

#include <ceres/loss_function.h>

#include <memory>

#include <pcor/fit/loss.hpp>
#include "numerics/robust_weights.hpp"

namespace pcor::internal {

/// The loss of residuals whose robust deviation is `deviation`; null for least squares, and where there is no
/// deviation.
std::unique_ptr<ceres::LossFunction> loss_function(Loss loss, double deviation);

}  // namespace pcor::internal

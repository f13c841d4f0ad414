#include "fit/robust_loss.hpp"

namespace pcor::internal {
namespace {

// 95 % efficiency on normal noise, in robust deviations (Huber and Ronchetti 2009, Robust Statistics; Holland
// and Welsch 1977).
constexpr double huber_width = 1.345;
constexpr double cauchy_width = 2.385;

}  // namespace

std::unique_ptr<ceres::LossFunction> loss_function(Loss loss, double deviation) {
  if (!(deviation > 0.0)) return nullptr;
  switch (loss) {
    case Loss::tukey:
      return std::make_unique<ceres::TukeyLoss>(tukey_width * deviation);
    case Loss::huber:
      return std::make_unique<ceres::HuberLoss>(huber_width * deviation);
    case Loss::soft_l1:
      return std::make_unique<ceres::SoftLOneLoss>(deviation);
    case Loss::cauchy:
      return std::make_unique<ceres::CauchyLoss>(cauchy_width * deviation);
    case Loss::none:
      break;
  }
  return nullptr;
}

}  // namespace pcor::internal

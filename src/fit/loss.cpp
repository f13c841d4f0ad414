#include <pcor/fit/loss.hpp>

#include "fit/loss_function.hpp"

namespace pcor {

std::string_view to_string(Loss loss) { return loss == Loss::huber ? "huber" : "none"; }

std::optional<Loss> loss_named(std::string_view name) {
  for (const Loss loss : {Loss::huber, Loss::none}) {
    if (name == to_string(loss)) return loss;
  }
  return std::nullopt;
}

namespace internal {

ScaledLoss::ScaledLoss(Loss loss, double deviation) {
  if (loss == Loss::huber && deviation > 0.0)
    function_ = std::make_shared<ceres::HuberLoss>(huber_width * deviation);
}

Eigen::VectorXd ScaledLoss::weights(const Eigen::VectorXd& residuals) const {
  return residuals.unaryExpr([this](double residual) { return (*this)(residual)[1]; });
}

}  // namespace internal

}  // namespace pcor

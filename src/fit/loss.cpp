#include <pcor/fit/loss.hpp>

#include <algorithm>
#include <array>

#include "fit/loss_function.hpp"

namespace pcor {
namespace {

using Function = std::unique_ptr<ceres::LossFunction>;

struct LossInfo {
  Loss loss;
  std::string_view name;
  Function (*function)(double deviation);
};

// The widths are in robust deviations. Tukey's and Cauchy's loss have 95 % efficiency on normal noise; for
// Huber's loss see `huber_width`.
constexpr std::array<LossInfo, 5> losses{
    {{Loss::tukey, "tukey",
      [](double d) -> Function { return std::make_unique<ceres::TukeyLoss>(internal::tukey_width * d); }},
     {Loss::huber, "huber",
      [](double d) -> Function { return std::make_unique<ceres::HuberLoss>(internal::huber_width * d); }},
     {Loss::soft_l1, "soft-l1",
      [](double d) -> Function { return std::make_unique<ceres::SoftLOneLoss>(d); }},
     {Loss::cauchy, "cauchy",
      [](double d) -> Function { return std::make_unique<ceres::CauchyLoss>(2.385 * d); }},
     {Loss::none, "none", [](double) -> Function { return nullptr; }}}};

const LossInfo& info_of(Loss loss) {
  return *std::find_if(losses.begin(), losses.end(), [loss](const LossInfo& f) { return f.loss == loss; });
}

}  // namespace

std::string_view to_string(Loss loss) { return info_of(loss).name; }

std::optional<Loss> loss_named(std::string_view name) {
  for (const LossInfo& info : losses) {
    if (info.name == name) return info.loss;
  }
  return std::nullopt;
}

namespace internal {

ScaledLoss::ScaledLoss(Loss loss, double deviation)
    : deviation_(deviation), function_(deviation > 0.0 ? info_of(loss).function(deviation) : nullptr) {}

Eigen::VectorXd ScaledLoss::weights(const Eigen::VectorXd& residuals) const {
  return residuals.unaryExpr([this](double residual) { return (*this)(residual)[1]; });
}

}  // namespace internal

}  // namespace pcor

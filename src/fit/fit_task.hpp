#pragma once

#include <Eigen/Dense>
#include <functional>
#include <vector>

#include "fit/fit_parameters.hpp"

namespace pcor::internal {

/// What all steps of a fit share.
struct FitTask {
  const ModelFile& model;
  const Reference& reference;
  const RefitOptions& options;
  std::vector<FitParameter> parameters;
  Eigen::VectorXd start;       ///< their values in the files
  std::function<void()> tell;  ///< to be called after every pass over the flights

  bool uses_prior() const { return options.use_prior || options.fit_reference; }
};

/// What a fit has found so far.
struct Solution {
  Eigen::VectorXd values{};      ///< of all parameters
  Eigen::VectorXd offsets{};     ///< of the intervals of a stage, of delta-p/p
  std::vector<bool> at_bound{};  ///< of all parameters
  double deviation = 1.0;        ///< robust, of the residuals over their noise
  /// The weight of a starting value that is off by its typical size: the deviation of the mean of so many
  /// samples as one independent one stands for. Zero without a prior.
  double prior_strength = 0.0;
};

/// The weights of the starting values of the wanted parameters, one over what a step of one costs; zero for
/// those without a typical size, and without a prior.
inline Eigen::VectorXd prior_weights(const FitTask& task, const Solution& solution,
                                     const std::vector<std::size_t>& wanted) {
  Eigen::VectorXd weights(static_cast<Eigen::Index>(wanted.size()));
  for (std::size_t k = 0; k < wanted.size(); ++k) {
    const double typical = task.parameters[wanted[k]].typical;
    weights[static_cast<Eigen::Index>(k)] = typical > 0.0 ? solution.prior_strength / typical : 0.0;
  }
  return weights;
}

}  // namespace pcor::internal

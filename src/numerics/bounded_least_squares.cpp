#include "numerics/bounded_least_squares.hpp"

#include <cmath>
#include <vector>

#include "numerics/decompositions.hpp"

namespace pcor::internal {

Eigen::VectorXd bounded_least_squares(const Eigen::MatrixXd& rows, const Eigen::VectorXd& right,
                                      const Eigen::VectorXd& lower, const Eigen::VectorXd& upper,
                                      const Eigen::VectorXd& start) {
  const Eigen::Index size = rows.cols();
  // Columns of length one, so that gradients can be compared.
  const Eigen::VectorXd length = rows.colwise().norm().transpose().cwiseMax(1e-300);
  const Eigen::MatrixXd scaled = rows * length.cwiseInverse().asDiagonal();
  Eigen::VectorXd x = start.cwiseProduct(length);
  const Eigen::VectorXd low = lower.cwiseProduct(length);
  const Eigen::VectorXd high = upper.cwiseProduct(length);
  std::vector<bool> held(static_cast<std::size_t>(size), false);
  const Eigen::Index max_rounds = 10 * (size + 1);
  for (Eigen::Index round = 0; round < max_rounds; ++round) {
    std::vector<Eigen::Index> free;
    for (Eigen::Index k = 0; k < size; ++k) {
      if (!held[static_cast<std::size_t>(k)]) free.push_back(k);
    }
    if (!free.empty()) {
      const Eigen::VectorXd step = least_norm_solution(scaled(Eigen::all, free), right - scaled * x);
      double share = 1.0;
      Eigen::Index stopped = -1;
      for (std::size_t i = 0; i < free.size(); ++i) {
        const Eigen::Index k = free[i];
        const double change = step[static_cast<Eigen::Index>(i)];
        const double bound = change > 0.0 ? high[k] : low[k];
        if (std::isfinite(bound) && std::abs(change) * share > std::abs(bound - x[k])) {
          share = std::abs(bound - x[k]) / std::abs(change);
          stopped = k;
        }
      }
      for (std::size_t i = 0; i < free.size(); ++i) x[free[i]] += share * step[static_cast<Eigen::Index>(i)];
      if (stopped >= 0) {
        x[stopped] = std::abs(x[stopped] - high[stopped]) < std::abs(x[stopped] - low[stopped])
                         ? high[stopped]
                         : low[stopped];
        held[static_cast<std::size_t>(stopped)] = true;
        continue;
      }
    }
    // All free ones are at their least squares: let go the bound that costs most, or be done.
    const Eigen::VectorXd residual = right - scaled * x;
    const Eigen::VectorXd descent = scaled.transpose() * residual;
    double largest = 1e-10 * (1.0 + residual.norm());
    Eigen::Index release = -1;
    for (Eigen::Index k = 0; k < size; ++k) {
      if (!held[static_cast<std::size_t>(k)]) continue;
      const double inwards = x[k] <= low[k] ? descent[k] : -descent[k];
      if (inwards > largest) {
        largest = inwards;
        release = k;
      }
    }
    if (release < 0) break;
    held[static_cast<std::size_t>(release)] = false;
  }
  Eigen::VectorXd result = x.cwiseQuotient(length).cwiseMax(lower).cwiseMin(upper);
  for (Eigen::Index k = 0; k < size; ++k) {
    if (held[static_cast<std::size_t>(k)]) result[k] = x[k] <= low[k] ? lower[k] : upper[k];
  }
  return result;
}

}  // namespace pcor::internal

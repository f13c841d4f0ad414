#include "numerics/variance_factor.hpp"

#include <algorithm>

#include "numerics/decompositions.hpp"

namespace pcor::internal {

InformationPart part_of_rows(const Eigen::MatrixXd& products, const Eigen::VectorXd& solution) {
  const Eigen::Index count = solution.size();
  const Eigen::MatrixXd information = products.topLeftCorner(count, count);
  return {information, products.col(count).head(count) - information * solution};
}

double variance_factor(const std::vector<InformationPart>& parts, const Eigen::MatrixXd& covariance,
                       Eigen::Index count, double before) {
  double chi2 = 4.0;
  double degrees_of_freedom = 4.0;
  const Eigen::MatrixXd to_changes = covariance.topRows(count);
  const Eigen::MatrixXd weight = information_inverse(covariance.topLeftCorner(count, count));
  for (const auto& [information, score] : parts) {
    const Eigen::VectorXd change = to_changes * score;
    const Eigen::MatrixXd expected =
        weight * to_changes * (information - information * covariance * information) * to_changes.transpose();
    // The sum of squares is that of chi2 with these moments (Satterthwaite).
    const double mean = expected.trace();
    const double squares = (expected * expected).trace();  // half of the variance
    if (!(mean > 0.0) || !(squares > 0.0)) continue;
    chi2 += before * change.dot(weight * change) * mean / squares;
    degrees_of_freedom += mean * mean / squares;
  }
  return std::max(1.0, chi2 / degrees_of_freedom);
}

}  // namespace pcor::internal

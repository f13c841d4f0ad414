#include "campaign/maximum_score.hpp"

#include <boost/random/normal_distribution.hpp>

#include <algorithm>
#include <random>

#include "numerics/chi_squared.hpp"
#include "numerics/decompositions.hpp"
#include "numerics/triangular_factor.hpp"

namespace pcor::internal {
namespace {

/// `chi2_one_dof` from a table, because draws call it thousands of times.
class EquivalentTable {
 public:
  explicit EquivalentTable(Eigen::Index degrees_of_freedom)
      : degrees_of_freedom_(static_cast<double>(degrees_of_freedom)) {
    for (std::size_t i = 0; i <= steps; ++i)
      values_.push_back(chi2_one_dof(static_cast<double>(i) * width, degrees_of_freedom_));
  }
  double operator()(double chi2) const {
    const double position = chi2 / width;
    const auto before = static_cast<std::size_t>(position);
    if (before >= steps) return chi2_one_dof(chi2, degrees_of_freedom_);
    const double part = position - static_cast<double>(before);
    return values_[before] + part * (values_[before + 1] - values_[before]);
  }

 private:
  static constexpr std::size_t steps = 400;
  static constexpr double width = 0.1;
  double degrees_of_freedom_;
  std::vector<double> values_;
};

/// Greatest equivalent score among groups for each column of `scores` (a draw); the rows are the directions
/// of all groups in order.
std::vector<double> maxima_of(const Eigen::MatrixXd& scores, const std::vector<Directions>& directions) {
  std::vector<EquivalentTable> tables;
  Eigen::Index max_degrees_of_freedom = 0;
  for (const Directions& each : directions)
    max_degrees_of_freedom = std::max(max_degrees_of_freedom, each.degrees_of_freedom);
  for (Eigen::Index k = 0; k <= max_degrees_of_freedom; ++k) tables.emplace_back(k);
  std::vector<double> result(static_cast<std::size_t>(scores.cols()), 0.0);
  for (Eigen::Index draw = 0; draw < scores.cols(); ++draw) {
    Eigen::Index row = 0;
    double& maximum = result[static_cast<std::size_t>(draw)];
    for (const auto& [count, degrees_of_freedom] : directions) {
      const double chi2 = scores.col(draw).segment(row, count).squaredNorm();
      row += count;
      if (degrees_of_freedom == 0 || chi2 <= maximum) continue;  // the equivalent never exceeds chi2
      maximum = std::max(maximum, degrees_of_freedom == 1
                                      ? chi2
                                      : tables[static_cast<std::size_t>(degrees_of_freedom)](chi2));
    }
  }
  return result;
}

}  // namespace

double quantile_of_maximum(const Eigen::MatrixXd& covariance, const std::vector<Directions>& directions,
                           double probability, std::size_t draws, std::uint64_t seed) {
  std::mt19937_64 engine(seed);
  boost::random::normal_distribution<double> normal;  // the same on every machine
  const Eigen::MatrixXd independent = Eigen::MatrixXd::NullaryExpr(
      covariance.cols(), as_index(draws), [&](Eigen::Index, Eigen::Index) { return normal(engine); });
  std::vector<double> maxima = maxima_of(covariance_root(covariance) * independent, directions);
  const auto position = static_cast<std::ptrdiff_t>(probability * static_cast<double>(maxima.size() - 1));
  std::nth_element(maxima.begin(), maxima.begin() + position, maxima.end());
  return maxima[static_cast<std::size_t>(position)];
}

}  // namespace pcor::internal

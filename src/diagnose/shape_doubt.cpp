#include "diagnose/shape_doubt.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <map>

#include "numerics/triangular_factor.hpp"

namespace pcor::internal {
namespace {

/// Coefficients of all columns in a fit of base and groups.
Eigen::VectorXd coefficients_of(const Analysis& analysis, const std::vector<std::size_t>& groups) {
  Eigen::VectorXd all = Eigen::VectorXd::Zero(analysis.scores().columns());
  all(indices_of(groups, analysis.groups(), analysis.base())) = analysis.search().fit(groups).estimate;
  return all;
}

std::vector<std::size_t> with(std::vector<std::size_t> groups, std::size_t group) {
  groups.push_back(group);
  return groups;
}

}  // namespace

double chi2_where_they_differ(const Analysis& analysis, const std::vector<std::size_t>& others,
                              std::size_t effect, std::size_t rival) {
  const double whole = analysis.search().score(effect, others).chi2;
  const Eigen::VectorXd fitted = coefficients_of(analysis, with(others, effect));
  const Eigen::VectorXd difference = fitted - coefficients_of(analysis, with(others, rival));
  const std::vector<Eigen::Index> own = indices_of(analysis.groups()[effect], analysis.base());
  using Squares = std::array<double, 2>;  // squares of the contribution and of the difference
  const auto of_flights = analysis.whole_share().of_each_flight<Squares>([&](std::size_t f) {
    const auto columns = analysis.scores().rows[f].leftCols(analysis.scores().columns());
    return Squares{(columns(Eigen::all, own) * fitted(own)).squaredNorm(),
                   (columns * difference).squaredNorm()};
  });
  std::map<std::size_t, Squares> against;  // keyed by reference
  double differences = 0.0;
  for (std::size_t f = 0; f < of_flights.size(); ++f) {
    Squares& sums = against[analysis.flight(f).reference];
    for (const std::size_t k : {0U, 1U}) sums[k] += of_flights[f][k];
    differences += of_flights[f][1];
  }
  if (!(differences > 0.0)) return whole;
  double chi2 = 0.0;
  for (const auto& [reference, sums] : against) chi2 += sums[0] * sums[1] / differences;
  return std::min(chi2, whole);
}

}  // namespace pcor::internal

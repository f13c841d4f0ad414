#include "numerics/least_squares.hpp"

#include <Eigen/Dense>
#include <algorithm>

#include "numerics/binned_residual.hpp"
#include "numerics/decompositions.hpp"
#include "numerics/missing.hpp"
#include "numerics/triangular_factor.hpp"

namespace pcor::internal {
namespace {

bool takes_part(const std::vector<std::vector<double>>& columns, const std::vector<double>& y,
                std::size_t i) {
  return std::isfinite(y[i]) &&
         std::all_of(columns.begin(), columns.end(), [i](const auto& c) { return std::isfinite(c[i]); });
}

/// The flights in a series of consecutive flights: a new flight begins if the time decreases, or increases by
/// more than an hour.
std::vector<Segment> flights_of(const std::vector<double>& time) {
  constexpr double max_gap = 3600.0;  // s
  std::vector<Segment> flights;
  for (std::size_t i = 0; i < time.size(); ++i) {
    const bool is_continuous = i > 0 && time[i] > time[i - 1] && time[i] < time[i - 1] + max_gap;
    if (!is_continuous) flights.push_back({i, 0});
    ++flights.back().count;
  }
  return flights;
}

std::vector<double> part_of(const std::vector<double>& values, const Segment& part) {
  return {values.data() + part.first, values.data() + part.first + part.count};
}

/// The covariance matrix of the sums (column . noise) over the samples that have a residual, which is what
/// the columns leave.
Eigen::MatrixXd covariance_of_sums(const std::vector<std::vector<double>>& columns,
                                   const std::vector<double>& residual, const std::vector<double>& time,
                                   double step) {
  const std::vector<Segment> parts = flights_of(time);
  std::vector<BinnedResidual> flights;
  std::vector<Binning> bins;
  std::vector<Eigen::MatrixXd> columns_of_flights;
  std::vector<Eigen::VectorXd> means;
  for (const Segment& part : parts) {
    const BinnedResidual& flight = flights.emplace_back(part_of(residual, part), part_of(time, part), step);
    bins.push_back(flight.bins());
    means.push_back(flight.means());
    Eigen::MatrixXd& binned = columns_of_flights.emplace_back(means.back().size(), columns.size());
    for (std::size_t c = 0; c < columns.size(); ++c)
      binned.col(as_index(c)) = flight.bins().means(part_of(columns[c], part));
  }
  const NoiseModel noise = expected_noise(bins, columns_of_flights, means, 1);
  Eigen::MatrixXd covariance = Eigen::MatrixXd::Zero(as_index(columns.size()), as_index(columns.size()));
  for (std::size_t f = 0; f < flights.size(); ++f) {
    std::vector<const double*> here;
    for (const std::vector<double>& column : columns) here.push_back(column.data() + parts[f].first);
    covariance += flights[f].covariance_of_sums(here, noise, f);
  }
  return covariance;
}

}  // namespace

LeastSquares least_squares(const std::vector<std::vector<double>>& columns, const std::vector<double>& y,
                           const std::vector<double>& time, double step) {
  const std::size_t width = columns.size();
  LeastSquares fit;
  fit.coefficients.assign(width, {nan, nan});
  fit.residuals.assign(y.size(), nan);
  fit.rms = nan;
  std::vector<Eigen::Index> indices;
  for (std::size_t i = 0; i < y.size(); ++i) {
    if (takes_part(columns, y, i)) indices.push_back(as_index(i));
  }
  fit.samples = indices.size();
  if (fit.samples < width + 3) return fit;

  using Values = Eigen::Map<const Eigen::VectorXd>;
  Eigen::MatrixXd x(as_index(fit.samples), as_index(width));
  for (std::size_t c = 0; c < width; ++c)
    x.col(as_index(c)) = Values(columns[c].data(), as_index(y.size()))(indices);
  const Eigen::VectorXd right = Values(y.data(), as_index(y.size()))(indices);
  const Eigen::ColPivHouseholderQR<Eigen::MatrixXd> decomposition(x);
  if (decomposition.rank() < x.cols()) return fit;
  const Eigen::VectorXd solution = decomposition.solve(right);
  const Eigen::VectorXd residual = right - x * solution;
  Eigen::Map<Eigen::VectorXd>(fit.residuals.data(), as_index(y.size()))(indices) = residual;
  fit.rms = std::sqrt(residual.squaredNorm() / static_cast<double>(fit.samples));

  const Eigen::MatrixXd inverse = inverse_of(x.transpose() * x);
  const Eigen::MatrixXd covariance =
      inverse * covariance_of_sums(columns, fit.residuals, time, step) * inverse;
  for (std::size_t c = 0; c < width; ++c) {
    const Eigen::Index k = as_index(c);
    fit.coefficients[c] = {solution(k), std::sqrt(std::max(covariance(k, k), 0.0))};
  }
  return fit;
}

LeastSquares mean_of(const std::vector<double>& values, const std::vector<double>& time, double step) {
  return least_squares({std::vector<double>(values.size(), 1.0)}, values, time, step);
}

Estimate combined(const std::vector<Estimate>& estimates) {
  std::vector<Estimate> known;
  std::copy_if(estimates.begin(), estimates.end(), std::back_inserter(known),
               [](const Estimate& e) { return std::isfinite(e.value) && std::isfinite(e.error); });
  if (known.empty()) return {nan, nan};
  // An error of zero, of a series without any noise, would take all the weight.
  double smallest = 1e-100;
  for (const Estimate& each : known) smallest = std::max(smallest, 1e-9 * std::abs(each.value));
  double weights = 0.0;
  double sum = 0.0;
  for (const Estimate& each : known) {
    const double weight = 1.0 / std::pow(std::max(each.error, smallest), 2);
    weights += weight;
    sum += weight * each.value;
  }
  const double mean = sum / weights;
  double chi2 = 0.0;
  for (const Estimate& each : known)
    chi2 += std::pow((each.value - mean) / std::max(each.error, smallest), 2);
  const double excess = known.size() > 1 ? chi2 / static_cast<double>(known.size() - 1) : 1.0;
  return {mean, std::sqrt(std::max(excess, 1.0) / weights)};
}

}  // namespace pcor::internal

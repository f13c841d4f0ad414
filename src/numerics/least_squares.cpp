#include "numerics/least_squares.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include <pcor/numerics/noise.hpp>
#include "numerics/missing.hpp"

#include "numerics/decompositions.hpp"

namespace pcor::internal {
namespace {

bool takes_part(const std::vector<std::vector<double>>& columns, const std::vector<double>& y,
                std::size_t i) {
  return std::isfinite(y[i]) &&
         std::all_of(columns.begin(), columns.end(), [i](const auto& c) { return std::isfinite(c[i]); });
}

/// The parts of a series without a gap in time.
std::vector<Stretch> segments_of(const std::vector<double>& time, double step) {
  return stretches_of(std::vector<double>(time.size(), 0.0), time, step);
}

}  // namespace

LeastSquares least_squares(const std::vector<std::vector<double>>& columns, const std::vector<double>& y,
                           const std::vector<double>& time, double step) {
  const std::size_t width = columns.size();
  LeastSquares fit;
  fit.coefficients.assign(width, {nan, nan});
  fit.residuals.assign(y.size(), nan);
  fit.rms = nan;
  std::vector<std::size_t> places;
  for (std::size_t i = 0; i < y.size(); ++i) {
    if (takes_part(columns, y, i)) places.push_back(i);
  }
  fit.samples = places.size();
  if (fit.samples < width + 3) return fit;

  const auto rows = static_cast<Eigen::Index>(fit.samples);
  const auto across = static_cast<Eigen::Index>(width);
  Eigen::MatrixXd x(rows, across);
  Eigen::VectorXd right(rows);
  for (Eigen::Index r = 0; r < rows; ++r) {
    const std::size_t place = places[static_cast<std::size_t>(r)];
    for (Eigen::Index c = 0; c < across; ++c) x(r, c) = columns[static_cast<std::size_t>(c)][place];
    right(r) = y[place];
  }
  const Eigen::ColPivHouseholderQR<Eigen::MatrixXd> decomposition(x);
  if (decomposition.rank() < across) return fit;
  const Eigen::VectorXd solution = decomposition.solve(right);
  const Eigen::VectorXd left = right - x * solution;
  for (Eigen::Index r = 0; r < rows; ++r) fit.residuals[places[static_cast<std::size_t>(r)]] = left(r);
  fit.rms = std::sqrt(left.squaredNorm() / static_cast<double>(rows));

  const Autoregression noise = autoregression(fit.residuals, stretches_of(fit.residuals, time, step));
  std::vector<std::vector<double>> known(width, std::vector<double>(y.size(), 0.0));
  std::vector<const double*> pointers;
  for (std::size_t c = 0; c < width; ++c) {
    for (const std::size_t place : places) known[c][place] = columns[c][place];
    pointers.push_back(known[c].data());
  }
  const std::vector<double> sums = covariance_of_sums(noise, pointers, segments_of(time, step));
  const Eigen::Map<const Eigen::MatrixXd> middle(sums.data(), across, across);
  const Eigen::MatrixXd inverse = inverse_of(x.transpose() * x);
  const Eigen::MatrixXd covariance = inverse * middle * inverse;
  const double memory = noise.samples_per_independent(fit.rms);
  fit.samples_per_independent = std::isfinite(memory) ? std::max(memory, 1.0) : 1.0;
  const auto unknowns = static_cast<double>(width);
  const double independent =
      std::max(static_cast<double>(fit.samples) / fit.samples_per_independent, unknowns + 1.0);
  const double taken_up = independent / (independent - unknowns);
  for (std::size_t c = 0; c < width; ++c) {
    const auto place = static_cast<Eigen::Index>(c);
    fit.coefficients[c] = {solution(place), std::sqrt(std::max(covariance(place, place), 0.0) * taken_up)};
  }
  return fit;
}

LeastSquares mean_of(const std::vector<double>& values, const std::vector<double>& time, double step) {
  return least_squares({std::vector<double>(values.size(), 1.0)}, values, time, step);
}

Estimated combined(const std::vector<Estimated>& estimates) {
  std::vector<Estimated> known;
  std::copy_if(estimates.begin(), estimates.end(), std::back_inserter(known),
               [](const Estimated& e) { return std::isfinite(e.value) && std::isfinite(e.error); });
  if (known.empty()) return {nan, nan};
  // An error of zero, of a series without any noise, would take all the weight.
  double smallest = 1e-100;
  for (const Estimated& each : known) smallest = std::max(smallest, 1e-9 * std::abs(each.value));
  double weights = 0.0;
  double sum = 0.0;
  for (const Estimated& each : known) {
    const double weight = 1.0 / std::pow(std::max(each.error, smallest), 2);
    weights += weight;
    sum += weight * each.value;
  }
  const double mean = sum / weights;
  double chi2 = 0.0;
  for (const Estimated& each : known)
    chi2 += std::pow((each.value - mean) / std::max(each.error, smallest), 2);
  const double excess = known.size() > 1 ? chi2 / static_cast<double>(known.size() - 1) : 1.0;
  return {mean, std::sqrt(std::max(excess, 1.0) / weights)};
}

}  // namespace pcor::internal

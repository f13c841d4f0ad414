#include "diagnose/flight_steps.hpp"

#include <algorithm>
#include <cmath>

#include "numerics/chi_squared.hpp"
#include "numerics/decompositions.hpp"
#include "numerics/triangular_factor.hpp"

namespace pcor::internal {
namespace {

constexpr double min_eigenvalue = 1e-9;

/// Flight means after elimination of a model, and their covariances. The means contain no part that the model
/// explains, whether common to all flights or a step between them.
struct Means {
  Eigen::VectorXd value{};
  Eigen::VectorXd variance{};     // one per flight
  Eigen::VectorXd covariances{};  // covariance of each mean with the sum of all means
};

/// The constants of the flights and the model are the unknowns of one set of normal equations. With the model
/// eliminated, and in units of each flight's own information, the matrix of the constants is one less a
/// product B'B of as many rows as the model has columns: its inverse needs the eigenvalues of BB' alone,
/// for any number of flights.
/// @param sums of each flight: products of its whitened columns, a constant, and its residual
Means find_means(const std::vector<Eigen::MatrixXd>& sums, double rows) {
  const Eigen::Index model = sums.front().cols() - 2;
  const Eigen::Index flights = as_index(sums.size());
  Eigen::MatrixXd of_model = Eigen::MatrixXd::Zero(model, model);
  Eigen::VectorXd right_of_model = Eigen::VectorXd::Zero(model);
  Eigen::MatrixXd together(model, flights);
  Eigen::VectorXd right(flights);
  Eigen::VectorXd unit(flights);
  double squares = 0.0;
  for (Eigen::Index f = 0; f < flights; ++f) {
    const Eigen::MatrixXd& sum = sums[static_cast<std::size_t>(f)];
    of_model += sum.topLeftCorner(model, model);
    right_of_model += sum.col(model + 1).head(model);
    squares += sum(model + 1, model + 1);
    unit[f] = 1.0 / std::sqrt(sum(model, model));
    together.col(f) = unit[f] * sum.col(model).head(model);
    right[f] = unit[f] * sum(model, model + 1);
  }
  const Eigen::VectorXd scale = of_model.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
  const SymmetricEigen eigen(scale.asDiagonal() * of_model * scale.asDiagonal());
  Eigen::VectorXd root = Eigen::VectorXd::Zero(model);  // square root of the inverse
  for (Eigen::Index k = 0; k < model; ++k) {
    if (eigen.eigenvalues()[k] > min_eigenvalue) root[k] = 1.0 / std::sqrt(eigen.eigenvalues()[k]);
  }
  const Eigen::MatrixXd half = root.asDiagonal() * eigen.eigenvectors().transpose() * scale.asDiagonal();
  const Eigen::VectorXd by_model = half * right_of_model;
  const SymmetricEigen shared((half * together) * (half * together).transpose());
  const Eigen::MatrixXd rows_of_model = shared.eigenvectors().transpose() * (half * together);
  // Difference between the inverse and the identity, for constants outside and inside the model.
  const Eigen::VectorXd beyond = shared.eigenvalues().unaryExpr(
      [](double part) { return 1.0 - part > min_eigenvalue ? 1.0 / (1.0 - part) : -1.0 / part; });
  const Eigen::VectorXd right_after = right - (half * together).transpose() * by_model;
  const Eigen::VectorXd solution =
      right_after + rows_of_model.transpose() * (beyond.asDiagonal() * (rows_of_model * right_after));
  const double degrees_of_freedom = std::max(1.0, rows - static_cast<double>(model + flights));
  const double variance = (squares - by_model.squaredNorm() - right_after.dot(solution)) / degrees_of_freedom;
  const Eigen::VectorXd diagonal = 1.0 + (rows_of_model.cwiseAbs2().transpose() * beyond).array();
  const Eigen::VectorXd with_sum =
      unit + rows_of_model.transpose() * (beyond.asDiagonal() * (rows_of_model * unit));
  return {unit.cwiseProduct(solution), variance * unit.cwiseAbs2().cwiseProduct(diagonal),
          variance * unit.cwiseProduct(with_sum)};
}

/// Square of a normal variable with the same tail probability as a Student variable with these degrees of
/// freedom (Wallace 1959, Annals of Mathematical Statistics 30, 1121).
double normal_square(double student_square, double degrees_of_freedom) {
  const double scale = (8.0 * degrees_of_freedom + 1.0) / (8.0 * degrees_of_freedom + 3.0);
  return scale * scale * degrees_of_freedom * std::log1p(student_square / degrees_of_freedom);
}

/// The step of one flight against the others.
FlightOffset step_of(Eigen::Index one, const Means& all) {
  const Eigen::VectorXd& value = all.value;
  const auto count = static_cast<double>(value.size() - 1);  // number of other flights
  const double mean = (value.sum() - value[one]) / count;    // mean of the others
  const double with_others = all.covariances[one] - all.variance[one];
  const double variance = (all.covariances.sum() - all.covariances[one] - with_others) / (count * count);
  const double shared = with_others / count;  // covariance with that mean
  const double known = all.variance[one] - 2.0 * shared + variance;
  if (!(known > 0.0)) return {};
  double scatter = 0.0;  // scatter of the other means beyond the effect of drift
  if (count > 1.0) {
    const double squares = (value.array() - mean).square().sum() - std::pow(value[one] - mean, 2);
    const double by_drift = all.variance.sum() - all.variance[one] - count * variance;
    scatter = std::max(0.0, squares - by_drift) / (count - 1.0) * (1.0 + 1.0 / count);
  }
  FlightOffset step;
  step.size = value[one] - mean;
  step.standard_error = std::sqrt(known + scatter);
  double square = step.size * step.size / (known + scatter);
  if (scatter > 0.0) {
    const double whole = known + scatter;
    square = normal_square(square, whole * whole * (count - 1.0) / (scatter * scatter));
  }
  step.p_value = std::min(1.0, (count + 1.0) * chi_squared_tail(square, 1.0));
  return step;
}

}  // namespace

std::vector<FlightOffset> find_mean_offsets(const FlightPartition& partition, const BinnedFlights& binned,
                                            const NoiseModel& noise) {
  const std::vector<Binning>& bins = binned.bins;
  std::vector<FlightOffset> steps(bins.size());
  const auto rows = partition.all_reduce_flights<std::size_t>([&](std::size_t f) { return bins[f].size(); });
  // Products of whitened columns, a constant and the residual; empty for a flight without bins.
  auto found = partition.all_gather_flights<Eigen::MatrixXd>([&](std::size_t f) -> Eigen::MatrixXd {
    if (bins[f].size() == 0) return {};
    // A model without a column is one with a column of zeros.
    const Eigen::Index model = std::max<Eigen::Index>(binned.columns[f].cols(), 1);
    Eigen::MatrixXd all = Eigen::MatrixXd::Zero(binned.columns[f].rows(), model + 2);
    all.leftCols(binned.columns[f].cols()) = binned.columns[f];
    all.col(model).setOnes();
    all.col(model + 1) = binned.residuals[f];
    const Eigen::MatrixXd white = whitened(all, bins[f], noise, f);
    return white.transpose() * white;
  });
  std::vector<std::size_t> flights;
  std::vector<Eigen::MatrixXd> sums;
  for (std::size_t f = 0; f < found.size(); ++f) {
    if (found[f].size() == 0) continue;
    flights.push_back(f);
    sums.push_back(std::move(found[f]));
  }
  if (flights.size() < 2) return steps;
  const Means means = find_means(sums, static_cast<double>(rows));
  // With two flights, the first differs as much as the second.
  for (std::size_t k = flights.size() == 2 ? 1 : 0; k < flights.size(); ++k)
    steps[flights[k]] = step_of(as_index(k), means);
  return steps;
}

}  // namespace pcor::internal

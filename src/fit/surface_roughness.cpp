#include "fit/surface_roughness.hpp"

#include <algorithm>
#include <cmath>

#include "fit/fit_flights.hpp"
#include "fit/prior.hpp"
#include "numerics/decompositions.hpp"
#include "numerics/missing.hpp"
#include "numerics/noise_covariance.hpp"

namespace pcor::internal {
namespace {

// Parts of the dynamic pressure: a hundred-thousandth is negligible, a tenth is more than any law has.
constexpr double min_size = 1e-5;
constexpr double max_size = 0.1;
constexpr double next_size = 1.7782794100389228;  // a quarter of a decade

/// Information of the flights on one surface, all other coefficients fitted.
struct Determined {
  Eigen::MatrixXd information{};
  Eigen::MatrixXd noise{};  ///< covariance of `right`
  Eigen::VectorXd right{};
};

/// @param all products of (derivatives, residual) with each other, weighted as least squares weighs them
/// @param noise covariance of the products of the derivatives with the noise
Determined determined(const Eigen::MatrixXd& all, const Eigen::MatrixXd& noise, const PriorRows& prior,
                      double unit, const std::vector<Eigen::Index>& columns) {
  const Eigen::Index count = noise.cols();
  std::vector<Eigen::Index> others;
  for (Eigen::Index k = 0; k < count; ++k) {
    if (std::find(columns.begin(), columns.end(), k) == columns.end()) others.push_back(k);
  }
  const Eigen::VectorXd y = all.col(count).head(count);
  Determined found{all(columns, columns), noise(columns, columns), y(columns)};
  if (others.empty()) return found;
  Eigen::MatrixXd of_others = all(others, others);
  const Eigen::MatrixXd drawn = prior.rows(Eigen::all, others);
  of_others += unit * drawn.transpose() * drawn;
  const Eigen::MatrixXd across = all(others, columns);
  const Eigen::MatrixXd taken = information_inverse(of_others) * across;  // rows of the others
  found.information -= across.transpose() * taken;
  found.right -= taken.transpose() * y(others);
  const Eigen::MatrixXd shared = noise(columns, others) * taken;
  found.noise += taken.transpose() * noise(others, others) * taken - shared - shared.transpose();
  return found;
}

}  // namespace

Eigen::MatrixXd SurfaceRoughness::rows() const {
  Eigen::MatrixXd rows(differences.rows() + differences.cols(), differences.cols());
  rows << differences / size, Eigen::MatrixXd::Identity(differences.cols(), differences.cols()) / coefficient;
  return rows;
}

Eigen::MatrixXd second_differences(const Surface& surface) {
  const auto rows = as_index(surface.axes[0].count);
  const auto columns = as_index(surface.axes[1].count);
  const Eigen::Index along_x = (rows - 2) * columns;
  const Eigen::Index along_y = rows * (columns - 2);
  Eigen::MatrixXd penalty = Eigen::MatrixXd::Zero(along_x + along_y, rows * columns);
  Eigen::Index at = 0;
  const auto add = [&](Eigen::Index middle, Eigen::Index step) {
    penalty(at, middle - step) = penalty(at, middle + step) = 1.0;
    penalty(at++, middle) = -2.0;
  };
  for (Eigen::Index i = 0; i < rows; ++i) {
    for (Eigen::Index j = 0; j < columns; ++j) {
      if (i > 0 && i + 1 < rows) add(i * columns + j, columns);
      if (j > 0 && j + 1 < columns) add(i * columns + j, 1);
    }
  }
  return penalty;
}

bool find_roughness(FitFlights& flights, const Solution& solution, std::vector<SurfaceRoughness>& surfaces,
                    bool has_new_noise) {
  const std::vector<std::size_t>& requested = flights.setup().requested;
  if (has_new_noise) flights.measure_noise(solution.values);
  const double unit = solution.deviation * solution.deviation;
  const Eigen::Index count = as_index(requested.size());
  const auto all = flights.partition().all_reduce_flights<Eigen::MatrixXd>([&](std::size_t flight) {
    const FitRows rows = flights.rows(flight, solution.values, {});
    const Eigen::MatrixXd with_innovations = side_by_side(rows.columns.leftCols(count), rows.innovations);
    return Eigen::MatrixXd(with_innovations.transpose() * with_innovations);
  });
  const auto noise = flights.partition().all_reduce_flights<Eigen::MatrixXd>([&](std::size_t flight) {
    const Eigen::MatrixXd weighted =
        flights.weighted(flight, flights.rows(flight, solution.values, {}).columns.leftCols(count));
    return noise_covariance(weighted, flights.bins(flight), flights.noise(flight), 0);
  });
  bool changed = false;
  for (SurfaceRoughness& surface : surfaces) {
    std::vector<Eigen::Index> columns;
    std::vector<Eigen::Index> coefficients;
    for (std::size_t k = 0; k < requested.size(); ++k) {
      if (!surface.has(requested[k])) continue;
      columns.push_back(as_index(k));
      coefficients.push_back(as_index(requested[k] - surface.first));
    }
    if (columns.empty() || !all.allFinite()) continue;
    Determined found = determined(all, noise, prior_rows(flights.task(), requested), unit, columns);
    // About zero, not about the solution.
    found.right -= found.information * solution.values(requested)(columns);
    const auto precision = [&](const Eigen::MatrixXd& rows) -> Eigen::MatrixXd {
      return rows(Eigen::all, coefficients).transpose() * rows(Eigen::all, coefficients);
    };
    const Cholesky now(found.information + unit * surface.inflation * precision(surface.rows()));
    const double inflation =
        std::max(1.0, now.solve(found.noise).trace() / (unit * now.solve(found.information).trace()));
    changed = changed || std::abs(std::log(inflation / surface.inflation)) > 0.2;
    // New noise is that of the residuals of the previous round: half steps make both converge.
    surface.inflation = has_new_noise ? std::sqrt(inflation * surface.inflation) : inflation;
    const double weight = 1.0 / (surface.inflation * unit);
    const SurfaceRoughness before = surface;
    const Eigen::MatrixXd of_differences = precision(surface.differences);
    const auto identity = Eigen::MatrixXd::Identity(of_differences.rows(), of_differences.cols());
    double best = -infinity;
    for (double size = min_size; size < 1.1 * max_size; size *= next_size) {
      for (double coefficient = min_size; coefficient < 1.1 * max_size; coefficient *= next_size) {
        const Eigen::MatrixXd prior = of_differences / (size * size) + identity / (coefficient * coefficient);
        const Cholesky alone(prior);
        const Cholesky factor(weight * found.information + prior);
        const double gain = 0.5 * weight * weight * found.right.dot(factor.solve(found.right)) +
                            0.5 * (alone.log_determinant() - factor.log_determinant());
        if (!(gain > best)) continue;
        best = gain;
        surface.size = size;
        surface.coefficient = coefficient;
        surface.degrees_of_freedom = weight * factor.solve(found.information).trace();
      }
    }
    const auto differ = [](double a, double b) { return std::abs(std::log(a / b)) > 0.6; };  // one step
    changed = changed || differ(surface.size, before.size) || differ(surface.coefficient, before.coefficient);
  }
  return changed;
}

}  // namespace pcor::internal

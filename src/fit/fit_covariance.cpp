#include "fit/fit_covariance.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include <pcor/numerics/noise.hpp>
#include "fit/loss_function.hpp"
#include "numerics/decompositions.hpp"
#include "numerics/missing.hpp"

namespace pcor::internal {

FitCovariance fit_covariance(FitFlights& flights, const Solution& solution, const Eigen::MatrixXd& earlier) {
  const FitTask& task = flights.task();
  const std::unique_ptr<ceres::LossFunction> loss = loss_function(task.options.loss, solution.deviation);
  const FitSetup& setup = flights.setup();
  const auto earlier_count = static_cast<std::size_t>(earlier.rows());
  const Eigen::Index size = as_index(setup.wanted.size() + flights.offsets());
  std::vector<Eigen::MatrixXd> curvatures(flights.count(), Eigen::MatrixXd::Zero(size, size));
  std::vector<Eigen::MatrixXd> scores(flights.count(), Eigen::MatrixXd::Zero(size, size));
  std::vector<double> memories(flights.count(), 0.0);
  flights.visit([&](std::size_t number, std::size_t first_offset, FitFlight& fit) {
    const std::size_t kept = fit.kept().size();
    if (kept == 0) return;
    const FlightSamples& samples = fit.residuals().samples();
    const std::size_t length = samples.time.size();
    std::vector<std::vector<double>> columns(static_cast<std::size_t>(size),
                                             std::vector<double>(length, 0.0));
    std::vector<double> influence(length, nan);
    FitFlight::Rows rows;
    double slope = 0.0;
    double squares = 0.0;
    for (std::size_t first = 0; first < kept; first += samples_per_chunk) {
      const std::size_t count = std::min(samples_per_chunk, kept - first);
      fit.evaluate(first, count, solution.values, solution.offsets, first_offset, rows);
      for (std::size_t i = 0; i < count; ++i) {
        const std::size_t place = fit.kept()[first + i];
        const double weight = 1.0 / fit.noise(first + i);
        const double normal = weight * rows.residual()[i];
        std::array<double, 3> rho{normal * normal, 1.0, 0.0};
        if (loss != nullptr) loss->Evaluate(rho[0], rho.data());
        influence[place] = rho[1] * normal;
        squares += influence[place] * influence[place];
        slope += rho[1] + 2.0 * normal * normal * rho[2];
        for (std::size_t k = 0; k < columns.size(); ++k) columns[k][place] = weight * rows.columns[k][i];
      }
    }
    slope /= static_cast<double>(kept);
    const Autoregression noise =
        autoregression(influence, stretches_of(influence, samples.time, samples.step), infinity);
    memories[number] = noise.samples_per_independent(std::sqrt(squares / static_cast<double>(kept))) *
                       static_cast<double>(kept);
    const std::vector<double> present(length, 0.0);
    std::vector<const double*> pointers;
    for (const std::vector<double>& column : columns) pointers.push_back(column.data());
    const std::vector<double> sums =
        covariance_of_sums(noise, pointers, stretches_of(present, samples.time, samples.step));
    scores[number] = Eigen::Map<const Eigen::MatrixXd>(sums.data(), size, size);
    for (Eigen::Index a = 0; a < size; ++a) {
      const Eigen::Map<const Eigen::VectorXd> left(columns[static_cast<std::size_t>(a)].data(),
                                                   as_index(length));
      for (Eigen::Index b = 0; b <= a; ++b) {
        const Eigen::Map<const Eigen::VectorXd> right(columns[static_cast<std::size_t>(b)].data(),
                                                      as_index(length));
        curvatures[number](a, b) = curvatures[number](b, a) = slope * left.dot(right);
      }
    }
  });
  Eigen::MatrixXd curvature = Eigen::MatrixXd::Zero(size, size);
  Eigen::MatrixXd score = Eigen::MatrixXd::Zero(size, size);
  double memory = 0.0;
  for (std::size_t i = 0; i < flights.count(); ++i) {
    curvature += curvatures[i];
    score += scores[i];
    memory += memories[i];
  }
  FitCovariance found;
  found.samples_per_independent = std::max(memory / static_cast<double>(flights.samples()), 1.0);
  const Eigen::Index early = as_index(earlier_count);
  const Eigen::Index wanted = as_index(setup.wanted.size());
  const Eigen::VectorXd weights = prior_weights(task, solution, setup.wanted).cwiseAbs2();
  curvature.diagonal().head(wanted) += weights;
  score.diagonal().head(wanted) += solution.prior_strength * solution.prior_strength * weights;
  // What is at a bound does not vary.
  std::vector<Eigen::Index> varying;
  for (Eigen::Index k = early; k < size; ++k) {
    if (k >= wanted || !solution.at_bound[setup.wanted[static_cast<std::size_t>(k)]]) varying.push_back(k);
  }
  Eigen::MatrixXd result = Eigen::MatrixXd::Zero(size, size);
  result.topLeftCorner(early, early) = earlier;
  if (varying.empty()) {
    found.matrix = result.topLeftCorner(wanted, wanted);
    return found;
  }
  const Eigen::MatrixXd inner = curvature(varying, varying);
  const Eigen::VectorXd lengths = inner.diagonal().cwiseSqrt().cwiseInverse();
  const Eigen::MatrixXd inverse = lengths.asDiagonal() *
                                  pseudo_inverse(lengths.asDiagonal() * inner * lengths.asDiagonal()) *
                                  lengths.asDiagonal();
  Eigen::MatrixXd own = inverse * score(varying, varying) * inverse.transpose();
  if (early > 0) {
    std::vector<Eigen::Index> before(earlier_count);
    std::iota(before.begin(), before.end(), 0);
    const Eigen::MatrixXd carried = -inverse * curvature(varying, before);
    own += carried * earlier * carried.transpose();
    const Eigen::MatrixXd across = carried * earlier;
    for (std::size_t a = 0; a < varying.size(); ++a) {
      for (Eigen::Index b = 0; b < early; ++b)
        result(varying[a], b) = result(b, varying[a]) = across(as_index(a), b);
    }
  }
  for (std::size_t a = 0; a < varying.size(); ++a) {
    for (std::size_t b = 0; b < varying.size(); ++b)
      result(varying[a], varying[b]) = own(as_index(a), as_index(b));
  }
  const Eigen::MatrixXd corner = result.topLeftCorner(wanted, wanted);
  found.matrix = 0.5 * (corner + corner.transpose());
  return found;
}

}  // namespace pcor::internal

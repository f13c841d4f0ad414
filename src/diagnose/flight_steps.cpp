#include "diagnose/flight_steps.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "numerics/chi_squared.hpp"
#include "numerics/decompositions.hpp"
#include "numerics/triangular_factor.hpp"

namespace pcor::internal {
namespace {

constexpr double least_eigenvalue = 1e-9;

/// What a flight has of the sums over all.
struct FlightSums {
  std::size_t rows = 0;
  Eigen::MatrixXd sums{};  // products of whitened columns, a constant and the residual

  template <class Archive>
  void serialize(Archive& archive) {
    archive(rows, sums);
  }
};

/// Means of the flights beside a model, and their covariance. Of what the model explains, be it common to all
/// or a step between them, the means have nothing.
struct Means {
  Eigen::VectorXd value;
  Eigen::MatrixXd covariance;
};

/// @param sums of each flight: products of its whitened columns, a constant, and its residual
Means find_means(const std::vector<Eigen::MatrixXd>& sums, double rows) {
  const Eigen::Index model = sums.front().cols() - 2;
  const Eigen::Index flights = as_index(sums.size());
  const Eigen::Index width = model + flights;
  Eigen::MatrixXd information = Eigen::MatrixXd::Zero(width + 1, width + 1);
  for (Eigen::Index f = 0; f < flights; ++f) {
    const Eigen::MatrixXd& sum = sums[static_cast<std::size_t>(f)];
    std::vector<Eigen::Index> places(static_cast<std::size_t>(model));
    std::iota(places.begin(), places.end(), Eigen::Index{0});
    places.insert(places.end(), {model + f, width});
    information(places, places) += sum;
  }
  const Eigen::VectorXd scale =
      information.diagonal().head(width).cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
  const Eigen::MatrixXd scaled =
      scale.asDiagonal() * information.topLeftCorner(width, width) * scale.asDiagonal();
  const Eigen::VectorXd right = scale.asDiagonal() * information.col(width).head(width);
  const Eigen::MatrixXd of_model = pseudo_inverse(scaled.topLeftCorner(model, model), least_eigenvalue);
  const Eigen::MatrixXd by_model = of_model * scaled.topRightCorner(model, flights);
  const Eigen::VectorXd left = right.tail(flights) - by_model.transpose() * right.head(model);
  const Eigen::MatrixXd inverse = pseudo_inverse(
      scaled.bottomRightCorner(flights, flights) - scaled.bottomLeftCorner(flights, model) * by_model,
      least_eigenvalue);
  const double squares = information(width, width) - right.head(model).dot(of_model * right.head(model)) -
                         left.dot(inverse * left);
  const double variance = squares / std::max(1.0, rows - static_cast<double>(width));
  const Eigen::VectorXd unit = scale.tail(flights);
  return {unit.cwiseProduct(inverse * left), variance * (unit.asDiagonal() * inverse * unit.asDiagonal())};
}

/// The square of a normal variable that is exceeded as rarely as one of Student with so many degrees of
/// freedom (Wallace 1959, Annals of Mathematical Statistics 30, 1121).
double normal_square(double student_square, double freedom) {
  const double scale = (8.0 * freedom + 1.0) / (8.0 * freedom + 3.0);
  return scale * scale * freedom * std::log1p(student_square / freedom);
}

/// Means of the flights, and sums over all of them.
struct SummedMeans {
  Means means;
  double sum = means.value.sum();
  Eigen::VectorXd covariances = means.covariance.rowwise().sum();  // of each with the sum
  double variance = covariances.sum();                             // of the sum
};

MeanStep step_of(std::size_t one, const std::vector<std::size_t>& flights, const SummedMeans& all) {
  const Eigen::VectorXd& value = all.means.value;
  const Eigen::MatrixXd& covariance = all.means.covariance;
  const Eigen::Index own = as_index(one);
  const auto count = static_cast<double>(flights.size() - 1);  // of the others
  const double mean = (all.sum - value[own]) / count;          // of them
  const double variance =
      (all.variance - 2.0 * all.covariances[own] + covariance(own, own)) / (count * count);
  const double shared = (all.covariances[own] - covariance(own, own)) / count;  // with that mean
  const double known = covariance(own, own) - 2.0 * shared + variance;
  if (!(known > 0.0)) return {};
  double scatter = 0.0;  // of the others' means, beyond what drift makes of it
  for (const std::size_t flight : flights) {
    if (flight == one || count < 2.0) continue;
    const Eigen::Index other = as_index(flight);
    const double size = value[other] - mean;
    const double by_drift =
        covariance(other, other) - 2.0 * (all.covariances[other] - covariance(other, own)) / count + variance;
    scatter += (size * size - by_drift) / (count - 1.0);
  }
  scatter = std::max(0.0, scatter) * (1.0 + 1.0 / count);
  MeanStep step;
  step.size = value[own] - mean;
  step.error = std::sqrt(known + scatter);
  double square = step.size * step.size / (known + scatter);
  if (scatter > 0.0) {
    const double whole = known + scatter;
    square = normal_square(square, whole * whole * (count - 1.0) / (scatter * scatter));
  }
  step.chance = std::min(1.0, static_cast<double>(flights.size()) * chi_squared_tail(square, 1.0));
  return step;
}

}  // namespace

std::vector<MeanStep> find_mean_steps(const FlightShare& share, const std::vector<Binning>& bins,
                                      const std::vector<Eigen::MatrixXd>& columns,
                                      const std::vector<Eigen::VectorXd>& residuals,
                                      const NoiseModel& noise) {
  std::vector<MeanStep> steps(bins.size());
  const auto found = share.of_each_flight<FlightSums>([&](std::size_t f) {
    Eigen::MatrixXd all(columns[f].rows(), columns[f].cols() + 2);
    all << columns[f], Eigen::VectorXd::Ones(columns[f].rows()), residuals[f];
    const Eigen::MatrixXd white = whitened(all, bins[f], noise, f);
    return FlightSums{bins[f].size(), white.transpose() * white};
  });
  std::vector<std::size_t> flights;
  std::vector<Eigen::MatrixXd> sums;
  std::size_t rows = 0;
  for (std::size_t f = 0; f < found.size(); ++f) {
    rows += found[f].rows;
    sums.push_back(found[f].sums);
    if (found[f].rows > 0) flights.push_back(f);
  }
  if (flights.size() < 2) return steps;
  const SummedMeans means{find_means(sums, static_cast<double>(rows))};
  for (const std::size_t flight : flights) {
    const bool told_of_the_other = flights.size() == 2 && flight == flights.front();
    if (!told_of_the_other) steps[flight] = step_of(flight, flights, means);
  }
  return steps;
}

}  // namespace pcor::internal

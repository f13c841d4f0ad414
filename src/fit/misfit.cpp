#include "fit/misfit.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <utility>

#include <pcor/physics/constants.hpp>
#include "numerics/decompositions.hpp"
#include "numerics/missing.hpp"

namespace pcor::internal {
namespace {

constexpr Eigen::Index states = 6;
constexpr Eigen::Index bumps = 7;  // per state
constexpr double width = 0.75;     // width of a bump, in deviations of its state
constexpr double furthest = 3.0;   // deviations
constexpr std::size_t min_bins = 100;

/// Ratio of two series for each sample; empty if one of them is not recorded.
std::vector<double> ratio_of(const std::vector<double>* over, const std::vector<double>* under) {
  if (over == nullptr || under == nullptr) return {};
  std::vector<double> ratio = *over;
  for (std::size_t i = 0; i < ratio.size(); ++i) ratio[i] /= (*under)[i];
  return ratio;
}

std::vector<double> load_factor_of(const FlightSamples& samples) {
  if (const std::vector<double>* const recorded = samples.model.find(Quantity::normal_acceleration))
    return *recorded;
  std::vector<double> factor = samples.motion.roll;  // load factor of a level turn
  for (double& each : factor)
    each = 1.0 / std::max(std::cos(each * constants::radians_per_degree),
                          0.1);  // NaN stays
  return factor;
}

/// States, one value for each sample; empty if not recorded.
std::array<std::vector<double>, states> states_of(const FlightSamples& samples) {
  const ModelSamples& model = samples.model;
  const auto angle = [&](Quantity pressure, const std::vector<double>& recorded) {
    const std::vector<double> ratio =
        ratio_of(model.find(pressure), model.find(Quantity::radome_dynamic_pressure));
    return ratio.empty() ? recorded : ratio;
  };
  return {angle(Quantity::attack_differential_pressure, samples.motion.attack),
          angle(Quantity::sideslip_differential_pressure, samples.motion.sideslip),
          ratio_of(model.find(Quantity::dynamic_pressure), model.find(Quantity::static_pressure)),
          samples.motion.vertical_speed,
          load_factor_of(samples),
          *model.find(Quantity::static_pressure)};
}

/// Bumps, given the residual and the noise.
struct Posterior {
  Eigen::MatrixXd covariance;
  Eigen::VectorXd mean;
  double gain;  ///< logarithm of the restricted likelihood over that without bumps
};

/// @param products of the whitened rows (bumps, residual) after elimination of the derivatives, which
/// have no prior
/// @param variance of the height of each bump before
Posterior posterior_of(const Eigen::MatrixXd& products, const Eigen::VectorXd& variance) {
  const Eigen::Index count = variance.size();
  const Eigen::VectorXd size = variance.cwiseSqrt();
  Eigen::MatrixXd inner = size.asDiagonal() * products.topLeftCorner(count, count) * size.asDiagonal();
  inner.diagonal().array() += 1.0;
  const Cholesky factor(inner);
  const Eigen::MatrixXd covariance = size.asDiagonal() * factor.solve(Eigen::MatrixXd(size.asDiagonal()));
  const Eigen::VectorXd right = products.col(count).head(count);
  const Eigen::VectorXd mean = covariance * right;
  return {covariance, mean, 0.5 * (right.dot(mean) - factor.log_determinant())};
}

constexpr double min_bump = 1e-3;  // size of a bump over the rms of the residual, practically zero

/// Akaike weight of the model with the misfit relative to the model without (Burnham and Anderson 2002, Model
/// selection and multimodel inference, section 2.9); variances above the minimum count as parameters. There
/// is no misfit if the noise explains the residual equally well.
double weight_of(const Posterior& posterior, const Eigen::VectorXd& variance, double rms) {
  double parameters = 0.0;
  for (Eigen::Index s = 0; s < states; ++s) {
    if (variance[s * bumps] > 4.0 * min_bump * min_bump * rms * rms) parameters += 1.0;
  }
  return 1.0 / (1.0 + std::exp(parameters - posterior.gain));
}

/// The variances at which the restricted likelihood is stationary, limited to sizes from 0.001 to 1 times the
/// rms of the residual: the variance of a state is the sum of squares of its heights over the number of them
/// that the flights determine (MacKay 1992, Neural Computation 4, 415). Successive substitution ends at the
/// same values from any start nearby, unlike a search without derivatives.
Eigen::VectorXd variances_of(const Eigen::MatrixXd& products, double rms) {
  constexpr int max_rounds = 500;
  // Relative to the rms of the residual, of which the misfit is a part. Without this bound a narrow feature,
  // which requires large heights of alternating signs, makes the stated error of the slope of the law several
  // times the residual. The bound is too small for a misfit that is confined to few samples.
  constexpr double maximum = 1.0;
  const auto square = [](double size) { return size * size; };
  Eigen::VectorXd variance = Eigen::VectorXd::Constant(states * bumps, square(0.3 * rms));
  for (int round = 0; round < max_rounds; ++round) {
    const Posterior posterior = posterior_of(products, variance);
    double change = 0.0;
    for (Eigen::Index s = 0; s < states; ++s) {
      const Eigen::Index first = s * bumps;
      const double before = variance[first];
      const double determined = bumps - posterior.covariance.diagonal().segment(first, bumps).sum() / before;
      const double found = posterior.mean.segment(first, bumps).squaredNorm() / std::max(determined, 1e-6);
      const double now = std::clamp(found, square(min_bump * rms), square(maximum * rms));
      variance.segment(first, bumps).setConstant(now);
      change = std::max(change, std::abs(std::log(now / before)));
    }
    if (change < 1e-3) break;
  }
  return variance;
}

/// Variance between the means of flights beyond the noise (DerSimonian and Laird 1986, Controlled Clinical
/// Trials 7, 177), hPa^2. Zero for a single flight.
/// @param flights mean residual of each flight without the misfit, and its variance from the noise, zero
/// where the flight has no bin
double variance_between(const std::vector<std::pair<double, double>>& flights) {
  double weights = 0.0;
  double squares = 0.0;
  double sum = 0.0;
  double count = 0.0;
  for (const auto& [mean, variance] : flights) {
    if (!(variance > 0.0)) continue;
    const double weight = 1.0 / variance;
    weights += weight;
    squares += weight * weight;
    sum += weight * mean;
    count += 1.0;
  }
  if (count < 2.0) return 0.0;
  double scatter = 0.0;
  for (const auto& [mean, variance] : flights) {
    const double from = mean - sum / weights;
    if (variance > 0.0) scatter += from * from / variance;
  }
  return std::max(0.0, (scatter - (count - 1.0)) / (weights - squares / weights));
}

}  // namespace

std::vector<Eigen::MatrixXd> binned_states(FitFlights& flights) {
  return flights.of_local([&](std::size_t flight, const FitFlight& fit) {
    const Binning& bins = flights.bins(flight);
    Eigen::MatrixXd result = Eigen::MatrixXd::Constant(as_index(bins.size()), states, nan);
    const auto series = states_of(fit.residuals().samples());
    for (std::size_t s = 0; s < series.size(); ++s) {
      if (!series[s].empty()) result.col(as_index(s)) = bins.means(series[s]);
    }
    return result;
  });
}

MisfitBasis::MisfitBasis(const FlightPartition& partition, const std::vector<Eigen::MatrixXd>& in_bins) {
  // The means first: the difference of large squares would not show that a state is constant.
  mean_ = Eigen::VectorXd::Zero(states);
  const auto moments_about_mean = [&]() -> Eigen::ArrayXXd {  // mean value and mean square of each state
    const auto sum = partition.all_reduce_flights<Eigen::MatrixXd>([&](std::size_t flight) {
      Eigen::MatrixXd moments = Eigen::MatrixXd::Zero(states, 3);  // number, sum and sum of squares
      for (Eigen::Index s = 0; s < states; ++s) {
        for (const double value : in_bins[flight].col(s)) {
          const double from = value - mean_[s];
          if (std::isfinite(value)) moments.row(s) += Eigen::RowVector3d(1.0, from, from * from);
        }
      }
      return moments;
    });
    return sum.array().rightCols(2).colwise() / sum.array().col(0).max(1.0);
  };
  mean_ = moments_about_mean().col(0).matrix();
  deviation_ = moments_about_mean().col(1).sqrt().matrix();
  for (Eigen::Index s = 0; s < states; ++s) {
    if (!(deviation_[s] > 1e-9 * std::abs(mean_[s]))) deviation_[s] = 0.0;
  }
}

Eigen::Index MisfitBasis::count() { return states * bumps; }

Eigen::MatrixXd MisfitBasis::operator()(const Eigen::MatrixXd& values) const {
  Eigen::MatrixXd result = Eigen::MatrixXd::Zero(values.rows(), count());
  for (Eigen::Index s = 0; s < states; ++s) {
    if (deviation_[s] == 0.0) continue;
    for (Eigen::Index i = 0; i < values.rows(); ++i) {
      if (!std::isfinite(values(i, s))) continue;
      const double z = std::clamp((values(i, s) - mean_[s]) / deviation_[s], -furthest, furthest);
      for (Eigen::Index b = 0; b < bumps; ++b) {
        const double from = (z + furthest - static_cast<double>(b)) / width;
        result(i, s * bumps + b) = std::exp(-0.5 * from * from);
      }
    }
  }
  return result;
}

Eigen::VectorXd Misfit::at(const Eigen::MatrixXd& flown) const {
  if (height.size() == 0) return Eigen::VectorXd::Zero(flown.rows());
  return bumps(flown) * height;
}

Misfit find_misfit(FitFlights& flights, const Solution& solution) {
  Misfit misfit;
  flights.measure_noise(solution.values);
  const FlightPartition& partition = flights.partition();
  std::map<const FitFlights*, std::vector<Eigen::MatrixXd>> states_of_reference;
  for (FitFlights* const each : flights.joint()) {
    if (flights.sees_law(*each)) states_of_reference[each] = binned_states(*each);
  }
  const std::vector<Eigen::MatrixXd>& in_bins = states_of_reference[&flights];
  misfit.bumps = MisfitBasis(partition, in_bins);
  if (flights.bins() < min_bins) return misfit;
  const Eigen::Index requested = as_index(flights.setup().requested.size());
  const Eigen::Index count = MisfitBasis::count();
  const auto rows_of = [&](std::size_t flight) {
    Eigen::MatrixXd all(in_bins[flight].rows(), requested + count + 1);
    all << flights.columns(flight).leftCols(requested), misfit.bumps(in_bins[flight]),
        flights.residual(flight, solution.values);
    return all;
  };
  const auto plain = partition.all_reduce_flights<Eigen::MatrixXd>([&](std::size_t flight) {
    const Eigen::MatrixXd all = rows_of(flight);
    return Eigen::MatrixXd(all.transpose() * all);
  });
  const auto bins = partition.all_reduce_flights<double>(
      [&](std::size_t flight) { return static_cast<double>(in_bins[flight].rows()); });
  const double rms = std::sqrt(plain(requested + count, requested + count) / bins);
  constexpr int rounds = 2;
  for (int round = 0; round < rounds; ++round) {
    const auto white = partition.all_reduce_flights<Eigen::MatrixXd>([&](std::size_t flight) {
      const Eigen::MatrixXd all = whitened(rows_of(flight), flights.bins(flight), flights.noise(flight), 0);
      return Eigen::MatrixXd(all.transpose() * all);
    });
    if (!(rms > 0.0) || !white.allFinite()) return misfit;
    const Eigen::MatrixXd white_after = products_after(white, requested);
    const Eigen::VectorXd variance = variances_of(white_after, rms);
    const Posterior posterior = posterior_of(white_after, variance);
    const double weight = weight_of(posterior, variance, rms);
    misfit.variance = weight * variance;
    misfit.height = weight * posterior.mean;
    const Eigen::MatrixXd plain_after = products_after(plain, requested).topLeftCorner(count, count);
    misfit.rms = std::sqrt(
        weight *
        std::max(
            0.0,
            (plain_after * (posterior.covariance + posterior.mean * posterior.mean.transpose())).trace()) /
        bins);
    flights.measure_noise(solution.values, [&](const FitFlights& reference, std::size_t flight) {
      return misfit.at(states_of_reference.at(&reference)[flight]);
    });
  }
  misfit.between_flights =
      variance_between(partition.all_gather_flights<std::pair<double, double>>([&](std::size_t flight) {
        const Eigen::VectorXd residual =
            flights.residual(flight, solution.values) - misfit.at(in_bins[flight]);
        if (residual.size() == 0) return std::pair(0.0, 0.0);
        return std::pair(residual.mean(),
                         1.0 / information_about_mean(flights.bins(flight), flights.noise(flight)));
      }));
  return misfit;
}

}  // namespace pcor::internal

#include "diagnose/noise_model.hpp"

#include <algorithm>
#include <cmath>

#include "numerics/decompositions.hpp"
#include "numerics/local_noise.hpp"
#include "numerics/triangular_factor.hpp"

namespace pcor::internal {
namespace {

constexpr double pi = 3.14159265358979323846;
constexpr std::size_t most_shapes = 48;
constexpr double shortest_period = 300.0;  // s
constexpr std::size_t fewest_innovations = 20;

/// The coefficients of the best predictors from 0, 1 ... p values before, and how many times larger than
/// that of order p the variance of what they do not predict is.
struct Predictors {
  std::vector<std::vector<double>> coefficients;
  std::vector<double> variance;
};

Predictors predictors_of(const std::vector<double>& highest) {
  const std::size_t order = highest.size();
  Predictors result{std::vector<std::vector<double>>(order + 1), std::vector<double>(order + 1, 1.0)};
  result.coefficients[order] = highest;
  for (std::size_t m = order; m > 0; --m) {
    const std::vector<double>& above = result.coefficients[m];
    const double reflection = above[m - 1];
    const double kept = 1.0 - reflection * reflection;
    std::vector<double>& below = result.coefficients[m - 1];
    for (std::size_t i = 0; i + 1 < m; ++i)
      below.push_back((above[i] + reflection * above[m - 2 - i]) / kept);
    result.variance[m - 1] = result.variance[m] / kept;
  }
  return result;
}

Eigen::VectorXd without_drift(const Binning& bins, const Eigen::VectorXd& residual) {
  const Eigen::MatrixXd shapes = drift_shapes(bins);
  if (shapes.cols() == 0) return residual;
  const Eigen::MatrixXd normal = shapes.transpose() * shapes;
  const double ridge = 1e-9 * normal.trace();
  const Eigen::MatrixXd conditioned =
      normal + ridge * Eigen::MatrixXd::Identity(normal.rows(), normal.cols());
  return residual - shapes * symmetric_solution(conditioned, shapes.transpose() * residual);
}

}  // namespace

Eigen::MatrixXd drift_shapes(const Binning& bins) {
  if (bins.size() < 2) return Eigen::MatrixXd(as_index(bins.size()), 0);
  const double begin = bins.time().front();
  const double length = bins.time().back() - begin;
  const auto by_period = static_cast<std::size_t>(2.0 * length / shortest_period);
  const std::size_t count = std::min({most_shapes, by_period, bins.size() / 15});
  Eigen::MatrixXd shapes(as_index(bins.size()), as_index(count));
  for (std::size_t k = 1; k <= count; ++k) {
    for (std::size_t i = 0; i < bins.size(); ++i) {
      const double phase = pi * static_cast<double>(k) * (bins.time()[i] - begin) / length;
      shapes(as_index(i), as_index(k - 1)) = std::cos(phase) / static_cast<double>(k);
    }
  }
  return shapes;
}

NoiseModel estimate_noise(const std::vector<Binning>& bins, const std::vector<Eigen::VectorXd>& residuals) {
  NoiseModel noise;
  std::vector<double> all;
  std::vector<Stretch> stretches;
  std::vector<Eigen::VectorXd> fast;
  for (std::size_t f = 0; f < bins.size(); ++f) {
    fast.push_back(without_drift(bins[f], residuals[f]));
    for (const Stretch& stretch : bins[f].stretches())
      stretches.push_back({all.size() + stretch.first, stretch.count});
    all.insert(all.end(), fast[f].data(), fast[f].data() + fast[f].size());
    noise.level.emplace_back(Eigen::VectorXd::Ones(fast[f].size()));
  }
  constexpr int rounds = 2;
  for (int round = 0; round < rounds; ++round) {
    std::vector<double> scaled;
    scaled.reserve(all.size());
    for (std::size_t f = 0; f < bins.size(); ++f) {
      const Eigen::VectorXd ratio = fast[f].cwiseQuotient(noise.level[f]);
      scaled.insert(scaled.end(), ratio.data(), ratio.data() + ratio.size());
    }
    noise.coefficients = autoregression(scaled, stretches).coefficients;
    // The level of the innovations: first without a level of its own for each time.
    for (Eigen::VectorXd& level : noise.level) level.setOnes();
    std::vector<Eigen::VectorXd> innovations;
    std::vector<double> whole;
    for (std::size_t f = 0; f < bins.size(); ++f) {
      innovations.emplace_back(whitened(fast[f], bins[f], noise, f));
      whole.insert(whole.end(), innovations[f].data(), innovations[f].data() + innovations[f].size());
    }
    const double common = robust_deviation(whole);
    for (std::size_t f = 0; f < bins.size(); ++f) {
      const std::vector<double>& time = bins[f].time();
      for (std::size_t first = 0; first < time.size();) {
        std::size_t last = first;
        while (last < time.size() && time[last] < time[first] + local_noise_time) ++last;
        const double* const begin = innovations[f].data() + first;
        const double* const end = innovations[f].data() + last;
        double here = common;
        if (last - first >= fewest_innovations) here = robust_deviation({begin, end});
        const double level = local_noise_level(here, common);
        noise.level[f]
            .segment(as_index(first), as_index(last - first))
            .setConstant(level > 0.0 ? level : 1.0);
        first = last;
      }
    }
  }
  return noise;
}

Eigen::MatrixXd whitened(const Eigen::Ref<const Eigen::MatrixXd>& columns, const Binning& bins,
                         const NoiseModel& noise, std::size_t flight) {
  const Predictors predictors = predictors_of(noise.coefficients);
  const std::size_t order = noise.coefficients.size();
  const Eigen::VectorXd scale = noise.level[flight].cwiseInverse();
  Eigen::MatrixXd result(columns.rows(), columns.cols());
  for (Eigen::Index c = 0; c < columns.cols(); ++c) {
    const Eigen::VectorXd scaled = columns.col(c).cwiseProduct(scale);
    double* const out = result.col(c).data();
    for (const Stretch& stretch : bins.stretches()) {
      const double* const x = scaled.data() + stretch.first;
      for (std::size_t t = 0; t < stretch.count; ++t) {
        const std::size_t m = std::min(t, order);
        double value = x[t];
        for (std::size_t k = 0; k < m; ++k) value -= predictors.coefficients[m][k] * x[t - 1 - k];
        out[stretch.first + t] = m == order ? value : value / std::sqrt(predictors.variance[m]);
      }
    }
  }
  return result;
}

}  // namespace pcor::internal

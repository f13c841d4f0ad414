#include "numerics/whitening.hpp"

#include <algorithm>
#include <cmath>

#include "numerics/triangular_factor.hpp"

namespace pcor::internal {
namespace {

/// The autocovariance at lags 0 ... p-1 of an autoregression of order p whose innovations have variance one,
/// by the recursion of Levinson backwards and forwards.
std::vector<double> autocovariance(const std::vector<double>& coefficients) {
  const std::size_t order = coefficients.size();
  std::vector<std::vector<double>> predictors(order + 1);
  predictors[order] = coefficients;
  double variance = 1.0;
  for (std::size_t m = order; m > 0; --m) {
    const std::vector<double>& above = predictors[m];
    const double reflection = above[m - 1];
    const double kept = 1.0 - reflection * reflection;
    for (std::size_t i = 0; i + 1 < m; ++i)
      predictors[m - 1].push_back((above[i] + reflection * above[m - 2 - i]) / kept);
    variance /= kept;
  }
  std::vector<double> result{variance};
  for (std::size_t lag = 1; lag < order; ++lag) {
    double sum = 0.0;
    for (std::size_t i = 0; i < lag; ++i) sum += predictors[lag][i] * result[lag - 1 - i];
    result.push_back(sum);
  }
  return result;
}

}  // namespace

Whitening::Whitening(const Binning& bins, const NoiseModel& noise, std::size_t flight)
    : coefficients_(noise.coefficients), level_(noise.level[flight]) {
  if (coefficients_.empty()) coefficients_.push_back(0.0);
  order_ = coefficients_.size();
  std::vector<double> slow_time;
  std::vector<double> slow_variance;
  for (std::size_t j = 0; j < slow_times.size(); ++j) {
    if (!(noise.slow[j] > 0.0)) continue;
    slow_time.push_back(slow_times[j]);
    slow_variance.push_back(noise.slow[j] * noise.slow[j]);
  }
  const Eigen::Index order = as_index(order_);
  const Eigen::Index slow = as_index(slow_time.size());
  slow_variance_ = Eigen::Map<const Eigen::VectorXd>(slow_variance.data(), slow);
  const Eigen::Index size = order + slow;
  const Eigen::Index count = as_index(bins.size());
  decay_ = Eigen::MatrixXd::Zero(slow, count);
  gain_.resize(size, count);
  deviation_.resize(count);

  const Eigen::Map<const Eigen::VectorXd> coefficients(coefficients_.data(), order);
  const std::vector<double> lags = autocovariance(coefficients_);
  Eigen::MatrixXd stationary(order, order);
  for (Eigen::Index i = 0; i < order; ++i) {
    for (Eigen::Index j = 0; j < order; ++j)
      stationary(i, j) = lags[static_cast<std::size_t>(std::abs(i - j))];
  }
  Eigen::MatrixXd now = Eigen::MatrixXd::Zero(size, size);  // covariance of the state
  Eigen::MatrixXd next = now;
  now.diagonal().tail(slow) = slow_variance_;
  Eigen::VectorXd seen(size);   // covariance of state and observation
  Eigen::VectorXd ahead(size);  // of the next value of the autoregression and the state
  Eigen::VectorXd decay = Eigen::VectorXd::Ones(slow);
  for (const Stretch& stretch : bins.stretches()) begins_.push_back(as_index(stretch.first));
  std::size_t stretch = 0;
  for (Eigen::Index t = 0; t < count; ++t) {
    if (t > 0) {
      const double since =
          bins.time()[static_cast<std::size_t>(t)] - bins.time()[static_cast<std::size_t>(t - 1)];
      for (Eigen::Index j = 0; j < slow; ++j)
        decay[j] = std::exp(-since / slow_time[static_cast<std::size_t>(j)]);
    }
    decay_.col(t) = decay;
    next.bottomRightCorner(slow, slow) =
        decay.asDiagonal() * now.bottomRightCorner(slow, slow) * decay.asDiagonal();
    for (Eigen::Index j = 0; j < slow; ++j)
      next(order + j, order + j) += (1.0 - decay[j] * decay[j]) * slow_variance_[j];
    if (stretch < begins_.size() && begins_[stretch] == t) {
      ++stretch;
      next.topLeftCorner(order, order) = stationary;
      next.topRightCorner(order, slow).setZero();
    } else {
      ahead.noalias() = now.topRows(order).transpose() * coefficients;
      next(0, 0) = ahead.head(order).dot(coefficients) + 1.0;
      next.block(0, 1, 1, order - 1) = ahead.head(order - 1).transpose();
      next.block(1, 0, order - 1, 1) = ahead.head(order - 1);
      next.block(1, 1, order - 1, order - 1) = now.topLeftCorner(order - 1, order - 1);
      next.block(0, order, 1, slow) = ahead.tail(slow).cwiseProduct(decay).transpose();
      next.block(1, order, order - 1, slow) = now.block(0, order, order - 1, slow) * decay.asDiagonal();
    }
    next.bottomLeftCorner(slow, order) = next.topRightCorner(order, slow).transpose();
    seen = level_[t] * next.col(0) + next.rightCols(slow).rowwise().sum();
    const double variance = level_[t] * seen[0] + seen.tail(slow).sum();
    gain_.col(t) = seen / variance;
    next.noalias() -= gain_.col(t) * seen.transpose();
    now.swap(next);
    deviation_[t] = std::sqrt(variance);
    log_determinant_ += std::log(variance);
  }
}

Eigen::MatrixXd Whitening::operator()(const Eigen::Ref<const Eigen::MatrixXd>& columns) const {
  const auto order = static_cast<Eigen::Index>(order_);
  const Eigen::Index slow = decay_.rows();
  Eigen::MatrixXd result(columns.rows(), columns.cols());
  std::vector<double> state(static_cast<std::size_t>(order + slow));
  double* const fast = state.data();
  double* const drift = state.data() + order;
  for (Eigen::Index c = 0; c < columns.cols(); ++c) {
    std::fill(state.begin(), state.end(), 0.0);
    std::size_t stretch = 0;
    for (Eigen::Index t = 0; t < columns.rows(); ++t) {
      if (stretch < begins_.size() && begins_[stretch] == t) {
        ++stretch;
        std::fill_n(fast, order, 0.0);
      } else {
        double foreseen = 0.0;
        for (Eigen::Index k = order - 1; k >= 0; --k) {
          foreseen += coefficients_[static_cast<std::size_t>(k)] * fast[k];
          if (k > 0) fast[k] = fast[k - 1];
        }
        fast[0] = foreseen;
      }
      const double* const decay = decay_.data() + t * slow;
      double predicted = level_[t] * fast[0];
      for (Eigen::Index j = 0; j < slow; ++j) {
        drift[j] *= decay[j];
        predicted += drift[j];
      }
      const double innovation = columns(t, c) - predicted;
      const double* const gain = gain_.data() + t * (order + slow);
      for (std::size_t k = 0; k < state.size(); ++k) state[k] += gain[k] * innovation;
      result(t, c) = innovation / deviation_[t];
    }
  }
  return result;
}

Eigen::VectorXd Whitening::transposed(const Eigen::VectorXd& values) const {
  const auto order = static_cast<Eigen::Index>(order_);
  const Eigen::Index slow = decay_.rows();
  Eigen::VectorXd result(values.size());
  // What all that comes later makes of the state, backwards step by step.
  Eigen::VectorXd later = Eigen::VectorXd::Zero(order + slow);
  std::size_t stretch = begins_.size();
  for (Eigen::Index t = values.size(); t-- > 0;) {
    result[t] = values[t] / deviation_[t] + gain_.col(t).dot(later);
    later[0] -= level_[t] * result[t];
    later.tail(slow).array() -= result[t];
    later.tail(slow).array() *= decay_.col(t).array();
    if (stretch > 0 && begins_[stretch - 1] == t) {
      --stretch;
      later.head(order).setZero();
    } else {
      const double newest = later[0];
      for (Eigen::Index k = 0; k < order; ++k)
        later[k] = coefficients_[static_cast<std::size_t>(k)] * newest + (k + 1 < order ? later[k + 1] : 0.0);
    }
  }
  return result;
}

Eigen::VectorXd Whitening::slow_parts(const Eigen::VectorXd& residuals) const {
  const Eigen::VectorXd weighted = transposed((*this)(residuals));
  Eigen::VectorXd result = Eigen::VectorXd::Zero(residuals.size());
  for (Eigen::Index j = 0; j < decay_.rows(); ++j) {
    double before = 0.0;  // sums of what was and what comes, each with what is left of it here
    for (Eigen::Index t = 0; t < result.size(); ++t) {
      before = decay_(j, t) * before + weighted[t];
      result[t] += slow_variance_[j] * before;
    }
    double after = 0.0;
    for (Eigen::Index t = result.size(); t-- > 0;) {
      result[t] += slow_variance_[j] * after;
      after = decay_(j, t) * (after + weighted[t]);
    }
  }
  return result;
}

}  // namespace pcor::internal

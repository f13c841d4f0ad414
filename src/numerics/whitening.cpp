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

/// A covariance of a handful of variables, of which the upper triangle is kept. In loops by hand: blocks of
/// such a size cost a matrix library more than they compute.
class Covariance {
 public:
  explicit Covariance(Eigen::Index size) : size_(size), values_(static_cast<std::size_t>(size * size), 0.0) {}
  double& operator()(Eigen::Index row, Eigen::Index column) {
    return values_[static_cast<std::size_t>(row * size_ + column)];
  }

 private:
  Eigen::Index size_;
  std::vector<double> values_;
};

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
  Covariance now(size);  // of the state
  Covariance next(size);
  for (Eigen::Index j = 0; j < slow; ++j) now(order + j, order + j) = slow_variance_[j];
  Eigen::VectorXd seen(size);   // covariance of state and observation
  Eigen::VectorXd ahead(size);  // of the next value of the autoregression and the state
  Eigen::VectorXd decay = Eigen::VectorXd::Ones(slow);
  for (const Stretch& stretch : bins.stretches()) begins_.push_back(as_index(stretch.first));
  std::size_t stretch = 0;
  double usual = 0.0;  // s from the bin before
  for (Eigen::Index t = 0; t < count; ++t) {
    if (t > 0) {
      const double since =
          bins.time()[static_cast<std::size_t>(t)] - bins.time()[static_cast<std::size_t>(t - 1)];
      for (Eigen::Index j = 0; j < slow && since != usual; ++j)
        decay[j] = std::exp(-since / slow_time[static_cast<std::size_t>(j)]);
      usual = since;
    }
    decay_.col(t) = decay;
    for (Eigen::Index j = 0; j < slow; ++j) {
      for (Eigen::Index i = 0; i <= j; ++i)
        next(order + i, order + j) = decay[i] * decay[j] * now(order + i, order + j);
      next(order + j, order + j) += (1.0 - decay[j] * decay[j]) * slow_variance_[j];
    }
    if (stretch < begins_.size() && begins_[stretch] == t) {
      ++stretch;
      for (Eigen::Index j = 0; j < order; ++j) {
        for (Eigen::Index i = 0; i <= j; ++i) next(i, j) = stationary(i, j);
      }
      for (Eigen::Index j = order; j < size; ++j) {
        for (Eigen::Index i = 0; i < order; ++i) next(i, j) = 0.0;
      }
    } else {
      for (Eigen::Index j = 0; j < size; ++j) {
        ahead[j] = 0.0;
        for (Eigen::Index k = 0; k < order; ++k)
          ahead[j] += coefficients[k] * now(std::min(k, j), std::max(k, j));
      }
      next(0, 0) = 1.0;
      for (Eigen::Index k = 0; k < order; ++k) next(0, 0) += ahead[k] * coefficients[k];
      for (Eigen::Index j = 1; j < order; ++j) {
        next(0, j) = ahead[j - 1];
        for (Eigen::Index i = 1; i <= j; ++i) next(i, j) = now(i - 1, j - 1);
      }
      for (Eigen::Index j = order; j < size; ++j) {
        next(0, j) = ahead[j] * decay[j - order];
        for (Eigen::Index i = 1; i < order; ++i) next(i, j) = now(i - 1, j) * decay[j - order];
      }
    }
    double variance = 0.0;
    for (Eigen::Index i = 0; i < size; ++i) {
      seen[i] = level_[t] * next(0, i);
      for (Eigen::Index j = order; j < size; ++j) seen[i] += next(std::min(i, j), std::max(i, j));
      variance += i == 0 ? level_[t] * seen[0] : i < order ? 0.0 : seen[i];
    }
    gain_.col(t) = seen / variance;
    for (Eigen::Index j = 0; j < size; ++j) {
      for (Eigen::Index i = 0; i <= j; ++i) now(i, j) = next(i, j) - gain_(i, t) * seen[j];
    }
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

#include "numerics/whitening.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "numerics/triangular_factor.hpp"

namespace pcor::internal {
namespace {

double* column(Eigen::MatrixXd& matrix, std::size_t number) { return matrix.col(as_index(number)).data(); }

double dot(const double* a, const double* b, std::size_t count) {
  using Values = Eigen::Map<const Eigen::VectorXd>;
  return Values(a, as_index(count)).dot(Values(b, as_index(count)));
}

}  // namespace

std::vector<double> autocovariance(const std::vector<double>& coefficients, std::size_t count) {
  // The predictors of lower orders, by the recursion of Levinson backwards.
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
  for (std::size_t lag = 1; lag < count; ++lag) {
    const std::vector<double>& predictor = predictors[std::min(lag, order)];
    double sum = 0.0;
    for (std::size_t i = 0; i < predictor.size(); ++i) sum += predictor[i] * result[lag - 1 - i];
    result.push_back(sum);
  }
  return result;
}

Whitening::Whitening(const Binning& bins, const NoiseModel& noise, std::size_t flight)
    : coefficients_(noise.coefficients), level_(noise.level[flight]) {
  if (coefficients_.empty()) coefficients_.push_back(0.0);
  order_ = coefficients_.size();
  std::vector<double> slow_time;
  std::vector<double> slow_variance;
  for (std::size_t j = 0; j < drift_time_constants.size(); ++j) {
    if (!(noise.drift_component_rms[j] > 0.0)) continue;
    slow_time.push_back(drift_time_constants[j]);
    slow_variance.push_back(noise.drift_component_rms[j] * noise.drift_component_rms[j]);
  }
  const std::size_t slow = slow_time.size();
  slow_variance_ = Eigen::Map<const Eigen::VectorXd>(slow_variance.data(), as_index(slow));
  const std::size_t size = order_ + slow;
  const Eigen::Index count = as_index(bins.size());
  decay_ = Eigen::MatrixXd::Zero(as_index(slow), count);
  gain_.resize(as_index(size), count);
  deviation_.resize(count);

  const std::vector<double> stationary = autocovariance(coefficients_, order_);
  // Covariance of the state, of which the upper triangle is kept. In loops by hand: blocks of such a size
  // cost a matrix library more than they compute.
  Eigen::MatrixXd now = Eigen::MatrixXd::Zero(as_index(size), as_index(size));
  Eigen::MatrixXd next = now;
  for (std::size_t j = 0; j < slow; ++j) column(now, order_ + j)[order_ + j] = slow_variance[j];
  std::vector<double> seen(size);   // covariance of state and observation
  std::vector<double> ahead(size);  // covariance of the next value of the autoregression with the state
  std::vector<double> decay(slow, 1.0);
  begins_.setConstant(count, false);
  for (const Segment& segment : bins.segments()) begins_[as_index(segment.first)] = true;
  std::size_t since_begin = 0;  // bins in this stretch
  double usual = 0.0;           // s from the bin before
  for (Eigen::Index t = 0; t < count; ++t) {
    if (t > 0) {
      const double since =
          bins.time()[static_cast<std::size_t>(t)] - bins.time()[static_cast<std::size_t>(t - 1)];
      for (std::size_t j = 0; j < slow && since != usual; ++j) decay[j] = std::exp(-since / slow_time[j]);
      usual = since;
    }
    std::copy(decay.begin(), decay.end(), decay_.col(t).data());
    if (begins_[t]) since_begin = 0;
    if (slow == 0 && since_begin++ >= order_) {
      // An autoregression alone is known when as many values of it were seen: its innovation is all that is
      // new.
      gain_.col(t).setZero();
      gain_(0, t) = 1.0 / level_[t];
      deviation_[t] = level_[t];
      log_determinant_ += 2.0 * std::log(level_[t]);
      continue;
    }
    for (std::size_t j = 0; j < slow; ++j) {
      const double* const from = column(now, order_ + j) + order_;
      double* const to = column(next, order_ + j) + order_;
      for (std::size_t i = 0; i <= j; ++i) to[i] = decay[i] * decay[j] * from[i];
      to[j] += (1.0 - decay[j] * decay[j]) * slow_variance[j];
    }
    if (begins_[t]) {
      for (std::size_t j = 0; j < order_; ++j)
        std::reverse_copy(stationary.begin(), stationary.begin() + static_cast<std::ptrdiff_t>(j + 1),
                          column(next, j));
      for (std::size_t j = order_; j < size; ++j) std::fill_n(column(next, j), order_, 0.0);
    } else {
      std::fill(ahead.begin(), ahead.end(), 0.0);
      for (std::size_t k = 0; k < order_; ++k) {
        const double* const from = column(now, k);
        for (std::size_t i = 0; i < k; ++i) ahead[i] += coefficients_[k] * from[i];
        ahead[k] += dot(from, coefficients_.data(), k + 1);
      }
      for (std::size_t j = order_; j < size; ++j)
        ahead[j] = dot(column(now, j), coefficients_.data(), order_);
      column(next, 0)[0] = 1.0 + dot(ahead.data(), coefficients_.data(), order_);
      for (std::size_t j = 1; j < order_; ++j) {
        column(next, j)[0] = ahead[j - 1];
        std::copy_n(column(now, j - 1), j, column(next, j) + 1);
      }
      for (std::size_t j = order_; j < size; ++j) {
        const double* const from = column(now, j);
        double* const to = column(next, j);
        to[0] = ahead[j] * decay[j - order_];
        for (std::size_t i = 1; i < order_; ++i) to[i] = from[i - 1] * decay[j - order_];
      }
    }
    for (std::size_t i = 0; i < size; ++i) seen[i] = level_[t] * column(next, i)[0];
    for (std::size_t j = order_; j < size; ++j) {
      const double* const from = column(next, j);
      for (std::size_t i = 0; i <= j; ++i) seen[i] += from[i];
      for (std::size_t i = order_; i < j; ++i) seen[j] += from[i];
    }
    const double variance =
        std::accumulate(seen.begin() + static_cast<std::ptrdiff_t>(order_), seen.end(), level_[t] * seen[0]);
    double* const gain = gain_.col(t).data();
    for (std::size_t i = 0; i < size; ++i) gain[i] = seen[i] / variance;
    for (std::size_t j = 0; j < size; ++j) {
      const double* const from = column(next, j);
      double* const to = column(now, j);
      for (std::size_t i = 0; i <= j; ++i) to[i] = from[i] - gain[i] * seen[j];
    }
    deviation_[t] = std::sqrt(variance);
    log_determinant_ += std::log(variance);
  }
}

Eigen::MatrixXd Whitening::operator()(const Eigen::Ref<const Eigen::MatrixXd>& columns) const {
  constexpr Eigen::Index columns_at_a_time = 8;  // their latencies overlap
  using Row = Eigen::Array<double, columns_at_a_time, 1>;
  const auto order = static_cast<Eigen::Index>(order_);
  const Eigen::Index slow = decay_.rows();
  Eigen::MatrixXd result(columns.rows(), columns.cols());
  std::vector<Row> state(static_cast<std::size_t>(order + slow));
  Row* const fast = state.data();
  Row* const drift = state.data() + order;
  for (Eigen::Index first = 0; first < columns.cols(); first += columns_at_a_time) {
    const Eigen::Index width = std::min(columns_at_a_time, columns.cols() - first);
    Row innovation = Row::Zero();
    std::fill(state.begin(), state.end(), Row::Zero());
    for (Eigen::Index t = 0; t < columns.rows(); ++t) {
      if (begins_[t]) {
        std::fill_n(fast, order, Row::Zero());
      } else {
        Row foreseen = Row::Zero();
        for (Eigen::Index k = order - 1; k >= 0; --k) {
          foreseen += coefficients_[static_cast<std::size_t>(k)] * fast[k];
          if (k > 0) fast[k] = fast[k - 1];
        }
        fast[0] = foreseen;
      }
      const double* const decay = decay_.data() + t * slow;
      Row predicted = level_[t] * fast[0];
      for (Eigen::Index j = 0; j < slow; ++j) {
        drift[j] *= decay[j];
        predicted += drift[j];
      }
      for (Eigen::Index c = 0; c < width; ++c) innovation[c] = columns(t, first + c) - predicted[c];
      const double* const gain = gain_.data() + t * (order + slow);
      for (std::size_t k = 0; k < state.size(); ++k) state[k] += gain[k] * innovation;
      for (Eigen::Index c = 0; c < width; ++c) result(t, first + c) = innovation[c] / deviation_[t];
    }
  }
  return result;
}

Eigen::VectorXd Whitening::transposed(const Eigen::VectorXd& values) const {
  const auto order = static_cast<Eigen::Index>(order_);
  const Eigen::Index slow = decay_.rows();
  Eigen::VectorXd result(values.size());
  // Effect of all later values on the state, backwards step by step.
  Eigen::VectorXd later = Eigen::VectorXd::Zero(order + slow);
  for (Eigen::Index t = values.size(); t-- > 0;) {
    result[t] = values[t] / deviation_[t] + gain_.col(t).dot(later);
    later[0] -= level_[t] * result[t];
    later.tail(slow).array() -= result[t];
    later.tail(slow).array() *= decay_.col(t).array();
    if (begins_[t]) {
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
    double before = 0.0;  // sums of past and of future values, each with its remaining fraction
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

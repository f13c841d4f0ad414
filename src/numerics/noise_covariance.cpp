#include "numerics/noise_covariance.hpp"

#include <cmath>

#include "numerics/triangular_factor.hpp"

namespace pcor::internal {
namespace {

/// A process of that time and of variance one: its covariance matrix times the columns.
Eigen::MatrixXd with_memory(const Eigen::MatrixXd& columns, const std::vector<double>& time, double memory) {
  Eigen::MatrixXd result(columns.rows(), columns.cols());
  Eigen::RowVectorXd before = Eigen::RowVectorXd::Zero(columns.cols());
  const auto decay = [&](Eigen::Index t) {
    const auto i = static_cast<std::size_t>(t);
    return std::exp(-(time[i] - time[i - 1]) / memory);
  };
  for (Eigen::Index t = 0; t < columns.rows(); ++t) {
    if (t > 0) before *= decay(t);
    before += columns.row(t);
    result.row(t) = before;
  }
  Eigen::RowVectorXd after = Eigen::RowVectorXd::Zero(columns.cols());
  for (Eigen::Index t = columns.rows(); t-- > 1;) {
    after = (after + columns.row(t)) * decay(t);
    result.row(t - 1) += after;
  }
  return result;
}

/// Sum over all pairs of bins of u(t) C(t-s) v(s), for columns u, v and the autocovariance C of an
/// autoregression with innovations of variance one.
Eigen::MatrixXd autoregressive_covariance(const std::vector<double>& coefficients,
                                          const Eigen::MatrixXd& columns,
                                          const std::vector<Segment>& segments) {
  // The noise is its innovations put through a recursive filter, so a sum (column . noise) is a sum over the
  // innovations of the column put through the same filter backwards in time. Innovations before the first
  // sample matter as long as the filter remembers.
  constexpr Eigen::Index run_out = 300;
  const Eigen::Index count = columns.cols();
  const Eigen::Index order = as_index(coefficients.size());
  Eigen::MatrixXd matrix = Eigen::MatrixXd::Zero(count, count);
  for (const Segment& segment : segments) {
    const Eigen::Index length = as_index(segment.count);
    Eigen::MatrixXd filtered(length + (order > 0 ? run_out : 0), count);
    for (Eigen::Index c = 0; c < count; ++c) {
      const double* const last = columns.col(c).data() + segment.first + segment.count - 1;
      double* const now = filtered.col(c).data();
      for (Eigen::Index step = 0; step < filtered.rows(); ++step) {
        now[step] = step < length ? last[-step] : 0.0;
        for (Eigen::Index k = 0; k < std::min(order, step); ++k)
          now[step] += coefficients[static_cast<std::size_t>(k)] * now[step - 1 - k];
      }
    }
    matrix.selfadjointView<Eigen::Lower>().rankUpdate(filtered.transpose());
  }
  return matrix.selfadjointView<Eigen::Lower>();
}

}  // namespace

Eigen::MatrixXd noise_covariance(const Eigen::MatrixXd& columns, const Binning& bins, const NoiseModel& noise,
                                 std::size_t flight) {
  const Eigen::MatrixXd fast = noise.level[flight].asDiagonal() * columns;
  Eigen::MatrixXd covariance = autoregressive_covariance(noise.coefficients, fast, bins.segments());
  for (std::size_t k = 0; k < drift_time_constants.size(); ++k) {
    if (noise.drift_component_rms[k] > 0.0)
      covariance += noise.drift_component_rms[k] * noise.drift_component_rms[k] * columns.transpose() *
                    with_memory(columns, bins.time(), drift_time_constants[k]);
  }
  return covariance;
}

}  // namespace pcor::internal

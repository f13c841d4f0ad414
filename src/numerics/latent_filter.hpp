#pragma once

#include <Eigen/Dense>
#include <cmath>

namespace pcor::internal {

/// Rows that are read and written one after another.
using RowByRow = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// Whitened rows: the innovation of each row, divided by its standard deviation.
struct WhiteRows {
  RowByRow rows;             ///< zero where the row has no value
  Eigen::VectorXd variance;  ///< variance of the innovation; zero if the row has no value
  double log_determinant = 0.0;
};

/// A Kalman filter for rows that depend on `count` latent processes (Ornstein-Uhlenbeck processes and random
/// walks): it subtracts the prediction from earlier rows from a residual and, with the same gains, from
/// further columns. Exact for any gaps. Source: Kalman (1960), Journal of Basic Engineering 82, 35; Harvey
/// (1989), Forecasting, structural time series models and the Kalman filter, section 3.4.
template <int count>
class LatentFilter {
 public:
  using States = Eigen::Matrix<double, count, 1>;

  /// @param variance of the processes before the first row
  /// @param size of the rows, the residual and the columns together
  /// @param rows how many there will be
  LatentFilter(const States& variance, Eigen::Index size, Eigen::Index rows)
      : covariance_(variance.asDiagonal()), means_(Processes::Zero(count, size)), change_(size) {
    white_.rows = RowByRow::Zero(rows, size);
    white_.variance = Eigen::VectorXd::Zero(rows);
  }

  /// Time update: every process keeps its fraction `stays`, and the variance `added` enters.
  void pass(const States& stays, const States& added) {
    for (Eigen::Index to = 0; to < count; ++to) {
      covariance_.col(to).array() *= stays.array() * stays[to];
      means_.row(to) *= stays[to];
    }
    covariance_.diagonal() += added;
  }

  /// Adds `times` times the process `from` to the process `to`.
  void couple(Eigen::Index to, Eigen::Index from, double times) {
    covariance_.row(to) += times * covariance_.row(from);
    covariance_.col(to) += times * covariance_.col(from);
    means_.row(to) += times * means_.row(from);
  }

  /// Reads one row, `row` = `by` times the processes + noise of this variance, as number `number`.
  template <class Row>
  void read(Eigen::Index number, const Row& row, const States& by, double noise) {
    // A row may depend on only some of the processes; the others are skipped.
    States shared = States::Zero();
    change_ = row;
    for (Eigen::Index from = 0; from < count; ++from) {
      if (by[from] == 0.0) continue;
      shared += by[from] * covariance_.col(from);
      change_ -= by[from] * means_.row(from);
    }
    const double variance = by.dot(shared) + noise;
    const States gain = shared / variance;
    for (Eigen::Index to = 0; to < count; ++to) {
      covariance_.col(to) -= shared[to] * gain;
      means_.row(to) += gain[to] * change_;
    }
    white_.rows.row(number) = change_ * (1.0 / std::sqrt(variance));
    white_.variance[number] = variance;
    white_.log_determinant += std::log(variance);
  }

  WhiteRows& white() { return white_; }

 private:
  using Processes = Eigen::Matrix<double, count, Eigen::Dynamic, Eigen::RowMajor>;

  Eigen::Matrix<double, count, count> covariance_;
  Processes means_;
  Eigen::RowVectorXd change_;
  WhiteRows white_{};
};

}  // namespace pcor::internal

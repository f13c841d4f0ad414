#pragma once

#include <Eigen/Dense>
#include <cstddef>
#include <vector>

#include <pcor/numerics/noise.hpp>

namespace cereal {

template <class Archive>
void serialize(Archive& archive, pcor::Segment& segment) {
  archive(segment.first, segment.count);
}

}  // namespace cereal

namespace pcor::internal {

/// Means over about four seconds: long enough that the noise of sensors is not what whitening amplifies,
/// short enough for every manoeuvre. Longer ones for residuals that are not of one sample alone, and for sums
/// over long flights.
class Binning {
 public:
  static constexpr double usual_width = 4.0;  ///< s
  /// Maximum width for sums, s: twenty bins in `local_noise_time` determine the level of the noise there.
  static constexpr double max_width = 15.0;

  Binning() = default;  // empty
  /// @param residual one value for each record, NaN where not used; @param time s; @param step s
  /// @param width s, to the next number of records
  Binning(const std::vector<double>& residual, const std::vector<double>& time, double step,
          double width = usual_width);

  std::size_t size() const { return time_.size(); }
  /// Time from bin to bin, s.
  double width() const { return width_; }
  /// Middles of the bins, s.
  const std::vector<double>& time() const { return time_; }
  /// Bins that follow one another without a gap.
  const std::vector<Segment>& segments() const { return segments_; }

  /// The means of a column that has one value for each record, over the records that are used.
  template <class Column>
  Eigen::VectorXd means(const Column& values) const {
    Eigen::VectorXd sum = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(size()));
    for (std::size_t k = 0; k < record_.size(); ++k)
      sum[bin_[k]] += static_cast<double>(values[static_cast<decltype(values.size())>(record_[k])]);
    return sum.cwiseQuotient(count_);
  }

  /// The records that are in bins, and the bin of each.
  const std::vector<std::size_t>& records() const { return record_; }
  const std::vector<Eigen::Index>& bins() const { return bin_; }
  /// Number of records in each bin.
  const Eigen::VectorXd& counts() const { return count_; }

  /// The records are not archived: columns that are already bin means do not use them.
  template <class Archive>
  void serialize(Archive& archive) {
    archive(width_, time_, segments_);
  }

 private:
  double width_ = usual_width;
  std::vector<std::size_t> record_;
  std::vector<Eigen::Index> bin_;
  Eigen::VectorXd count_;
  std::vector<double> time_;
  std::vector<Segment> segments_;
};

}  // namespace pcor::internal

#pragma once

#include <Eigen/Dense>

#include "numerics/binning.hpp"

namespace pcor::internal {

/// A flight in bins, for the members of a team that do not own it: derivatives or other columns, and the
/// residual last.
struct BinnedRows {
  Binning bins{};
  Eigen::MatrixXd rows{};

  template <class Archive>
  void serialize(Archive& archive) {
    archive(bins, rows);
  }
};

}  // namespace pcor::internal

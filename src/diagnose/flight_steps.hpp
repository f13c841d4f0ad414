#pragma once

#include <Eigen/Dense>
#include <vector>

#include "numerics/binning.hpp"
#include "numerics/noise_model.hpp"
#include "parallel/flight_partition.hpp"

namespace pcor::internal {

/// By how much the mean of one flight's residual differs from that of the others.
struct MeanOffset {
  double size = 0.0;    ///< hPa; positive where it lies above the others
  double error = 0.0;   ///< hPa; with drift, and with the scatter of the others
  double chance = 1.0;  ///< that the largest step of all flights is as large by drift and scatter alone
};

/// Compares the mean of each flight, beside what a model explains and what drifts, with those of the others.
/// The scatter of the others' means counts as far as it is larger than drift makes it, with as few degrees of
/// freedom as there are flights (Satterthwaite 1946, Biometrics Bulletin 2, 110). A step that the model
/// explains is none. The flights are those against one reference.
///
/// @param columns of the model, in bins, of each own flight; @param residuals likewise, hPa; @param noise
/// likewise
/// @return one for each flight; of chance 1 where there is nothing to compare it with. Of two flights the
/// second alone has one, since both differ by the same.
std::vector<MeanOffset> find_mean_offsets(const FlightPartition& share, const std::vector<Binning>& bins,
                                          const std::vector<Eigen::MatrixXd>& columns,
                                          const std::vector<Eigen::VectorXd>& residuals,
                                          const NoiseModel& noise);

}  // namespace pcor::internal

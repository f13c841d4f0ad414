#pragma once

#include <Eigen/Dense>
#include <cstddef>
#include <functional>
#include <vector>

#include "numerics/noise_model.hpp"
#include "parallel/flight_partition.hpp"

namespace pcor::internal {

/// Whitened columns and residuals of flights, each against each of its references, and the sums of this
/// generalised least-squares problem that a search needs. A process of a team has the rows of its flights
/// only.
struct WhitenedSystem {
  FlightPartition share = FlightPartition(0);
  std::vector<Eigen::MatrixXd> rows{};             ///< per flight: whitened columns and, last, the residual
  std::vector<std::vector<Eigen::Index>> block{};  ///< per flight: index of the minute of each row
  Eigen::Index blocks = 0;                         ///< minutes of all flights
  std::size_t row_count = 0;                       ///< total of all flights
  Eigen::MatrixXd information{};                   ///< columns and residual with columns and residual
  Eigen::MatrixXd plain{};                         ///< the same as if the noise had no slow parts

  Eigen::Index columns() const { return information.cols() - 1; }

  /// Whitened residual of a flight of this process after the columns with these coefficients.
  Eigen::VectorXd left(std::size_t flight, const Eigen::VectorXd& coefficients) const;

  /// Sums over the minutes of all flights of a value of each row. @param of_rows gives these values for a
  /// flight of this process
  Eigen::VectorXd by_minutes(const std::function<Eigen::VectorXd(std::size_t flight)>& of_rows) const;
};

/// Whitens the columns of each own flight. @param noise likewise, each of one flight alone
WhitenedSystem find_scores(const FlightPartition& share, const std::vector<Binning>& bins,
                           const std::vector<Eigen::MatrixXd>& columns,
                           const std::vector<Eigen::VectorXd>& residuals,
                           const std::vector<NoiseModel>& noise);

/// Whitens with one noise model for all flights and the noise level of each flight.
WhitenedSystem find_scores(const FlightPartition& share, const std::vector<Binning>& bins,
                           const std::vector<Eigen::MatrixXd>& columns,
                           const std::vector<Eigen::VectorXd>& residuals, const NoiseModel& noise);

/// Removes from the rows of `later` the noise in common with `earlier`, the same flight against another
/// reference: both contain the noise of the aircraft's own sensors. The remaining rows stay in units of the
/// noise.
///
/// @param noise whitened residual of each flight after all findings; on return the residual of `later` has no
/// common part
void take_out_common_noise(const std::vector<Binning>& bins, std::size_t earlier, std::size_t later,
                           std::vector<Eigen::VectorXd>& noise, WhitenedSystem& scores);

/// Takes the last `count` columns before the residual out of the system, as noise: their coefficients have a
/// normal prior with variance 1 in units of the noise and are averaged over.
void marginalize(WhitenedSystem& system, Eigen::Index count);

/// Sums the rows of all flights.
void sum_up(WhitenedSystem& scores);

}  // namespace pcor::internal

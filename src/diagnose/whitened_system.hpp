#pragma once

#include <Eigen/Dense>
#include <cstddef>
#include <functional>
#include <vector>

#include "numerics/noise_model.hpp"
#include "parallel/flight_partition.hpp"

namespace pcor::internal {

/// Whitened columns and residuals of flights, each against each of its references, and the sums over all of
/// them that a search needs: those of a generalised least-squares problem. A member of a team has the rows of
/// its own.
struct WhitenedSystem {
  FlightPartition share = FlightPartition(0);
  std::vector<Eigen::MatrixXd> rows{};             ///< of each flight, whitened columns and last the residual
  std::vector<std::vector<Eigen::Index>> bin{};    ///< bin of each row of each flight; empty: rows are bins
  std::vector<std::vector<Eigen::Index>> block{};  ///< number of the minute of each bin of each flight
  Eigen::Index blocks = 0;                         ///< minutes of all flights
  std::size_t row_count = 0;                       ///< of all flights
  Eigen::MatrixXd information{};                   ///< columns and residual with columns and residual
  Eigen::MatrixXd plain{};                         ///< the same as if the noise had no slow parts

  Eigen::Index columns() const { return information.cols() - 1; }
  Eigen::Index bin_of(std::size_t flight, Eigen::Index row) const {
    return bin[flight].empty() ? row : bin[flight][static_cast<std::size_t>(row)];
  }

  /// What is left of the whitened residual of an own flight after the columns with these coefficients.
  Eigen::VectorXd left(std::size_t flight, const Eigen::VectorXd& coefficients) const;

  /// The sums over the minutes of all flights of what each row has. @param of_rows gives it for an own flight
  Eigen::VectorXd by_minutes(const std::function<Eigen::VectorXd(std::size_t flight)>& of_rows) const;
};

/// White rows of a flight, columns and residual, and the bin of each row.
struct WhiteFlight {
  Eigen::MatrixXd rows{};
  std::vector<Eigen::Index> bin{};
};

/// Whitens the columns of each own flight. @param noise likewise, each of one flight alone
/// @param white rows of flights that need no whitening; empty for the others
WhitenedSystem find_scores(const FlightPartition& share, const std::vector<Binning>& bins,
                           const std::vector<Eigen::MatrixXd>& columns,
                           const std::vector<Eigen::VectorXd>& residuals,
                           const std::vector<NoiseModel>& noise, const std::vector<WhiteFlight>& white = {});

/// The same with one noise for all flights, with the levels of the own.
WhitenedSystem find_scores(const FlightPartition& share, const std::vector<Binning>& bins,
                           const std::vector<Eigen::MatrixXd>& columns,
                           const std::vector<Eigen::VectorXd>& residuals, const NoiseModel& noise);

/// Takes out of the rows of `later` what their noise has in common with that of `earlier`, the same flight
/// against another reference: both hold the noise of the aircraft's own sensors. What is left of the rows
/// stays in units of the noise.
///
/// @param noise what is left of the whitened residual of each flight when all that was found is taken off; of
/// the later one without what is common, from here on
void take_out_common_noise(const std::vector<Binning>& bins, std::size_t earlier, std::size_t later,
                           std::vector<Eigen::VectorXd>& noise, WhitenedSystem& scores);

/// Takes the last `count` columns before the residual out of the system, as noise: their coefficients have a
/// normal prior with variance 1 in units of the noise and are averaged over. Their best fit is subtracted
/// from the rows.
void marginalize(WhitenedSystem& system, Eigen::Index count);

/// Sums the rows of all flights.
void sum_up(WhitenedSystem& scores);

}  // namespace pcor::internal

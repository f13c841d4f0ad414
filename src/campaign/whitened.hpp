#pragma once

#include <Eigen/Dense>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include "campaign/columns.hpp"
#include "numerics/noise_model.hpp"
#include "parallel/flight_partition.hpp"

namespace pcor::internal {

// Noise of the residuals in bins, the weights that follow from it, and the sums of weighted rows: fit,
// diagnosis, what-if and comparison have them from here.

/// Binned inputs of the noise estimate.
struct BinnedFit {
  /// Columns fitted to a flight of this rank.
  std::function<Eigen::MatrixXd(std::size_t flight)> columns;
  /// Residual after the fit, hPa.
  std::function<Eigen::VectorXd(std::size_t flight)> residual;
  /// Digest of the parameters of the fit, on which the ranks must agree.
  std::uint64_t state = 0;
};

/// @param columns those that are not zero in all flights
using FindNoise =
    std::function<NoiseModel(const std::vector<Binning>& bins, const std::vector<Eigen::MatrixXd>& columns,
                             const std::vector<Eigen::VectorXd>& residuals)>;

/// Noise of each flight, separate for each reference. The common part is found from a few flights by `find`;
/// the level of a flight follows from the common part and its residual.
std::vector<NoiseModel> noise_of_flights(const FlightPartition& partition, const BinnedFlights& flights,
                                         const BinnedFit& fit, const FindNoise& find);

/// Common noise of the flights against the first reference, with the levels of the flights of this rank.
NoiseModel noise_of_first_reference(const BinnedFlights& flights, const std::vector<NoiseModel>& noise);

/// Columns of two matrices with the same rows in one.
Eigen::MatrixXd side_by_side(const Eigen::MatrixXd& left, const Eigen::MatrixXd& right);

/// Robust standard deviation of the values of all ranks together: one exchange, after which every rank holds
/// all values, 8 bytes each. @param values of the local flights
double robust_deviation(Communicator& comm, const std::vector<Eigen::VectorXd>& values);

/// Weights of the bins in least squares, 1/hPa: the square root of the share of samples in a bin, relative to
/// the fullest bin, over the deviation of the residual. @param deviation hPa, above zero
Eigen::VectorXd weights_of_bins(const Binning& bins, double deviation);

/// Information of a flight on the common mean of its bins, 1/hPa^2: the number of independent bins over
/// their variance; zero without bins.
double information_about_mean(const Binning& bins, const NoiseModel& noise);

/// Sums of products of the rows (columns, residual) in each of several parts of the flights, for example
/// parts that are held out one at a time. Sums of flights are additive.
struct PartialSums {
  std::vector<Eigen::MatrixXd> products{};  ///< products of the rows, one matrix for each part
  std::vector<double> counts{};             ///< number of rows in each part

  PartialSums() = default;
  PartialSums(std::size_t parts, Eigen::Index width)
      : products(parts, Eigen::MatrixXd::Zero(width, width)), counts(parts, 0.0) {}

  void add(std::size_t part, const Eigen::VectorXd& row);
  PartialSums& operator+=(const PartialSums& other);

  template <class Archive>
  void serialize(Archive& archive) {
    archive(products, counts);
  }
};

/// Whitened columns and residuals of all flights against their references, and the sums of a generalised
/// least-squares problem. A rank has the rows of its local flights and the sums of all.
struct WhitenedSystem {
  FlightPartition partition = FlightPartition(0);
  std::vector<Eigen::MatrixXd> rows{};             ///< per flight: whitened columns and, last, the residual
  std::vector<std::vector<Eigen::Index>> bin{};    ///< per flight: bin of each row; empty: rows are bins
  std::vector<std::vector<Eigen::Index>> block{};  ///< per flight: index of the minute of each bin
  Eigen::Index blocks = 0;                         ///< minutes of all flights
  std::size_t row_count = 0;                       ///< independent rows of all flights
  Eigen::MatrixXd information{};                   ///< columns and residual with columns and residual
  Eigen::MatrixXd plain{};                         ///< the same as if the noise had no slow parts

  Eigen::Index columns() const { return information.cols() - 1; }
  Eigen::Index bin_of(std::size_t flight, Eigen::Index row) const {
    return bin[flight].empty() ? row : bin[flight][static_cast<std::size_t>(row)];
  }

  /// Sums of the whitened columns with these coefficients, for each flight of this process.
  std::vector<Eigen::VectorXd> sums_of_columns(const Eigen::VectorXd& coefficients) const;
  /// Whitened residuals of each flight of this process after these sums.
  std::vector<Eigen::VectorXd> residuals_after(const Eigen::VectorXd& coefficients) const;

  /// Sums over the minutes of all flights of a value of each row. @param of_rows gives these values for a
  /// flight of this process
  Eigen::VectorXd by_minutes(const std::function<Eigen::VectorXd(std::size_t flight)>& of_rows) const;
};

/// White rows of a flight, columns and residual, and the bin of each row.
struct WhiteFlight {
  Eigen::MatrixXd rows{};
  std::vector<Eigen::Index> bin{};
};

/// Whitens the columns of each local flight. @param noise likewise, each of one flight alone
/// @param white rows of flights that need no whitening; empty for the others
/// @param sums_up false: `information`, and with it `columns()`, is not set before the caller calls `sum_up`
WhitenedSystem whiten_system(const FlightPartition& partition, const std::vector<Binning>& bins,
                             const std::vector<Eigen::MatrixXd>& columns,
                             const std::vector<Eigen::VectorXd>& residuals,
                             const std::vector<NoiseModel>& noise, const std::vector<WhiteFlight>& white = {},
                             bool sums_up = true);

/// Whitens with one noise model for all flights and the noise level of each flight.
WhitenedSystem whiten_system(const FlightPartition& partition, const std::vector<Binning>& bins,
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
/// normal prior with variance 1 in units of the noise and are averaged over. Their best fit is subtracted
/// from the rows.
void marginalize(WhitenedSystem& system, Eigen::Index count);

/// Computes `information` from the rows of all flights.
void sum_up(WhitenedSystem& scores);

}  // namespace pcor::internal

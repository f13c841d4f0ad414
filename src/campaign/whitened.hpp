#pragma once

#include <Eigen/Dense>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include "campaign/binned_flights.hpp"
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
  std::function<Eigen::VectorXd(std::size_t flight)> left;
  /// Digest of the parameters of the fit, on which the ranks must agree.
  std::uint64_t state = 0;
};

using FindNoise =
    std::function<NoiseModel(const std::vector<Binning>& bins, const std::vector<Eigen::MatrixXd>& columns,
                             const std::vector<Eigen::VectorXd>& left)>;

/// Noise of each flight, separate for each reference. The common part is found from a few flights by `find`;
/// the level of a flight follows from the common part and its residual.
std::vector<NoiseModel> noise_of_flights(const FlightPartition& share, const BinnedFlights& flights,
                                         const BinnedFit& fit, const FindNoise& find);

/// Common noise of the flights against the first reference, with the levels of the flights of this rank.
NoiseModel noise_of_first_reference(const BinnedFlights& flights, const std::vector<NoiseModel>& noise);

/// Robust standard deviation of the values of all ranks together. @param values of the local flights
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
  FlightPartition share = FlightPartition(0);
  std::vector<Eigen::MatrixXd> rows{};             ///< whitened columns, then the residual, of each flight
  std::vector<std::vector<Eigen::Index>> block{};  ///< minute of each row, one list for each flight
  Eigen::Index blocks = 0;                         ///< number of minutes, all flights
  std::size_t row_count = 0;                       ///< number of rows, all flights
  Eigen::MatrixXd information{};                   ///< columns and residual with columns and residual
  Eigen::MatrixXd plain{};                         ///< the same as if the noise had no slow parts

  Eigen::Index columns() const { return information.cols() - 1; }

  /// Whitened residual of a local flight minus its columns times the coefficients.
  Eigen::VectorXd left(std::size_t flight, const Eigen::VectorXd& coefficients) const;

  /// Sums of a quantity of the rows over each minute of all flights. @param of_rows returns the quantity for
  /// a local flight
  Eigen::VectorXd by_minutes(const std::function<Eigen::VectorXd(std::size_t flight)>& of_rows) const;
};

/// Whitens the columns of each local flight. @param noise one model for each flight, with the levels of that
/// flight
WhitenedSystem find_scores(const FlightPartition& share, const std::vector<Binning>& bins,
                           const std::vector<Eigen::MatrixXd>& columns,
                           const std::vector<Eigen::VectorXd>& residuals,
                           const std::vector<NoiseModel>& noise);

/// Whitens the columns of each local flight. @param noise one model for all flights, with the levels of each
WhitenedSystem find_scores(const FlightPartition& share, const std::vector<Binning>& bins,
                           const std::vector<Eigen::MatrixXd>& columns,
                           const std::vector<Eigen::VectorXd>& residuals, const NoiseModel& noise);

/// Removes from the rows of `later` the noise that they share with the rows of `earlier`, which are the same
/// flight against another reference: both contain the noise of the aircraft's sensors. The rows keep the unit
/// of the noise.
///
/// @param noise whitened residual of each flight minus all findings; the function removes the shared noise
/// from the residual of `later`
void take_out_common_noise(const std::vector<Binning>& bins, std::size_t earlier, std::size_t later,
                           std::vector<Eigen::VectorXd>& noise, WhitenedSystem& scores);

/// Removes the last `count` columns before the residual by averaging over their coefficients, which have a
/// normal prior with variance 1 in units of the noise.
void marginalize(WhitenedSystem& system, Eigen::Index count);

/// Computes `information` from the rows of all flights.
void sum_up(WhitenedSystem& scores);

}  // namespace pcor::internal

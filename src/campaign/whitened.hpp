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

/// Robust standard deviation of the values of the own flights of all members together.
double robust_deviation(Communicator& comm, const std::vector<Eigen::VectorXd>& values);

/// Weights of least squares in units of the deviation of a residual: the root of the samples in each bin over
/// the most, over the deviation.
Eigen::VectorXd weights_of_bins(const Binning& bins, double deviation);

/// Information of a flight about a common mean of its bins, 1/hPa^2: the number of independent bins over
/// their variance; zero without bins.
double information_about_mean(const Binning& bins, const NoiseModel& noise);

/// Sums over the rows (columns, residual) of several parts of the flights, such as those that are held out in
/// turn. Sums of flights add up.
struct PartialSums {
  std::vector<Eigen::MatrixXd> products{};  ///< of the rows of each part with each other
  std::vector<double> counts{};             ///< rows of each part

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

/// Whitened columns and residuals of flights, each against each of its references, and the sums over all of
/// them that a search needs: those of a generalised least-squares problem. A member of a team has the rows of
/// its own.
struct WhitenedSystem {
  FlightPartition share = FlightPartition(0);
  std::vector<Eigen::MatrixXd> rows{};             ///< of each flight, whitened columns and last the residual
  std::vector<std::vector<Eigen::Index>> block{};  ///< of each flight, the number of the minute of each row
  Eigen::Index blocks = 0;                         ///< minutes of all flights
  std::size_t row_count = 0;                       ///< of all flights
  Eigen::MatrixXd information{};                   ///< columns and residual with columns and residual
  Eigen::MatrixXd plain{};                         ///< the same as if the noise had no slow parts

  Eigen::Index columns() const { return information.cols() - 1; }

  /// What is left of the whitened residual of an own flight after the columns with these coefficients.
  Eigen::VectorXd left(std::size_t flight, const Eigen::VectorXd& coefficients) const;

  /// The sums over the minutes of all flights of what each row has. @param of_rows gives it for an own flight
  Eigen::VectorXd by_minutes(const std::function<Eigen::VectorXd(std::size_t flight)>& of_rows) const;
};

/// Whitens the columns of each own flight. @param noise likewise, each of one flight alone
WhitenedSystem find_scores(const FlightPartition& share, const std::vector<Binning>& bins,
                           const std::vector<Eigen::MatrixXd>& columns,
                           const std::vector<Eigen::VectorXd>& residuals,
                           const std::vector<NoiseModel>& noise);

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
/// normal prior with variance 1 in units of the noise and are averaged over.
void marginalize(WhitenedSystem& system, Eigen::Index count);

/// Sums the rows of all flights.
void sum_up(WhitenedSystem& scores);

}  // namespace pcor::internal

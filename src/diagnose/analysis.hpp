#pragma once

#include <Eigen/Dense>
#include <memory>
#include <vector>

#include "campaign/columns.hpp"
#include "campaign/effect_search.hpp"
#include "campaign/whitened.hpp"
#include "diagnose/flight_columns.hpp"
#include "numerics/noise_model.hpp"
#include "numerics/triangular_factor.hpp"

namespace pcor::internal {

/// Number of fits of a cross-validation. Each omits one block of five minutes in five.
inline constexpr std::size_t held_out_parts = 5;

/// Part that contains a time of a flight.
std::size_t held_out_part(const FlightSamples& samples, double time);

/// Residuals on blocks that were not used in a fit.
struct HeldOut {
  /// rms after a least-squares correction as in refit: hPa, first reference, without outliers
  double rms = 0.0;
  Eigen::VectorXd chi2;  ///< squared innovations of each minute, all references, in units of the noise
};

/// Chosen effects and their rivals in one system.
struct Competition {
  WhitenedSystem system{};
  std::vector<ColumnGroup> groups{};  ///< the chosen effects, then the rivals
};

/// Statistics of a diagnosis: noise and missing effects, estimated alternately because each needs the other.
///
/// Each flight has one entry per reference; entries against the first reference come first, and each
/// reference has its separate noise. Functions without a flight number refer to the first reference; flight
/// numbers count all entries. A rank has records, bins and rows of its local flights, and only
/// the outlines of the others.
class Analysis {
 public:
  /// @param groups of columns of the flights' candidates, one for each effect that is tested
  /// @param added coefficients of the base of effects of the flow that were found before and are in the model
  /// now, one vector for each effect
  /// @param prior inverse prior variances of the coefficients of the base about the model; empty: none
  Analysis(PartitionedColumns columns, std::vector<ColumnGroup> groups,
           const std::vector<Eigen::VectorXd>& added = {}, Eigen::VectorXd prior = {});

  /// Partition of the flights against the first reference.
  const FlightPartition& partition() const { return first_partition_; }
  /// Partition of all entries, one per flight and reference.
  const FlightPartition& whole_partition() const { return partition_; }
  const std::vector<FlightColumns>& flights() const { return flights_; }
  std::size_t flight_count() const { return binned_.bins.size(); }
  std::size_t reference_count() const { return binned_.reference.back() + 1; }
  const FlightColumns& flight(std::size_t number) const {
    return number < flights_.size() ? flights_[number] : further_[number - flights_.size()];
  }
  const Binning& bins(std::size_t flight) const { return binned_.bins[flight]; }
  /// Noise against the first reference, with the levels of local flights.
  NoiseModel noise() const { return noise_of_first_reference(binned_, noise_); }
  /// Noise estimated together with an offset for each flight, so that it does not contain the steps between
  /// flights.
  NoiseModel noise_beside_offsets() const;
  /// Twice the gain in log-likelihood by slow drift against the first reference.
  double drift_gain() const { return drift_gain_; }
  const EffectSearch& search() const { return *search_; }
  const WhitenedSystem& scores() const { return *scores_; }
  /// Scores of the base followed by other columns instead of the candidates'. @param more in bins, of each
  /// flight against each reference @param chosen effects whose columns are the first of these; their
  /// uncertain shapes stay columns
  WhitenedSystem scores_with(const std::vector<Eigen::MatrixXd>& more,
                             const std::vector<std::size_t>& chosen = {}) const;
  /// Scores of the base, the chosen effects with their uncertain shapes, and rivals. @param rivals in bins,
  /// of each flight against each reference: one column for each rival and reference
  Competition competition(const std::vector<std::size_t>& chosen,
                          const std::vector<Eigen::MatrixXd>& rivals) const;
  /// Factor of the variance of GPS, from halves of flights and from references; 1 without GPS.
  double variance_factor() const { return variance_factor_; }
  const std::vector<ColumnGroup>& groups() const { return groups_; }
  const SearchResult& result() const { return result_; }
  Eigen::Index base() const { return base_; }

  /// Columns of the base and of some groups, and residuals with outliers replaced, in bins, against the first
  /// reference.
  BinnedFlights binned(const std::vector<std::size_t>& groups) const;

  /// Coefficients of all columns, zero except those of base and groups.
  /// @param estimate of base and groups, in the order of `EffectSearch::fit`
  Eigen::VectorXd coefficients(const std::vector<std::size_t>& groups, const Eigen::VectorXd& estimate) const;
  /// Coefficients by maximum likelihood.
  Eigen::VectorXd coefficients(const std::vector<std::size_t>& groups) const {
    return coefficients(groups, search_->fit(groups).estimate);
  }

  /// Contribution of columns with these coefficients to the residual of every record in the bins of a flight,
  /// hPa; NaN for other records.
  std::vector<double> added(std::size_t flight, const Eigen::VectorXd& coefficients) const;
  /// Contribution of the columns of a group alone.
  std::vector<double> added_by(std::size_t flight, std::size_t group,
                               const Eigen::VectorXd& coefficients) const;

  /// `coefficients` by least squares against the first reference, as a refit has them.
  Eigen::VectorXd least_squares(const std::vector<std::size_t>& groups) const;

  /// Residual of base and groups on five-minute blocks that were excluded from their fit, one block in five
  /// at a time. The rms is NaN if one part has more than 80 % of the samples.
  HeldOut held_out(const std::vector<std::size_t>& groups) const;

  /// Most likely drift of a flight after columns with these coefficients, one value per record, hPa.
  /// @param coefficients of least squares; coefficients of the noise model may move along collinear columns
  /// as the drift allows
  std::vector<double> drift(std::size_t flight, const Eigen::VectorXd& coefficients) const;

 private:
  /// Noise against a reference, and the columns and residuals that it was found from; bins never change.
  struct KnownNoise {
    std::vector<Eigen::MatrixXd> columns{};
    std::vector<Eigen::VectorXd> residuals{};
    FoundNoise found{};
  };

  /// Iterates noise and effects until they are stable. Returns the likelihood of the result minus the cost of
  /// its effects. @param generous removes all candidate effects before the first noise estimate
  double search_from(const Eigen::VectorXd& start, bool generous);
  /// Finds the factor of the variance of GPS, and repeats the search with it.
  void find_variance_factor();
  /// Factor with base and groups, from halves of flights and from references.
  double variance_factor_with(const std::vector<std::size_t>& chosen) const;
  void replace_outliers(const Eigen::VectorXd& coefficients);
  /// @param is_rough a first estimate without slow drift
  void find_noise(const std::vector<std::size_t>& groups, const Eigen::VectorXd& coefficients, bool is_rough);
  /// Noise of each flight against each reference after base and groups. The shared part is estimated from a
  /// few flights by `find(bins, columns, residuals)`; the levels of a flight follow from it and the flight's
  /// residual.
  std::vector<NoiseModel> noise_after(const std::vector<std::size_t>& groups,
                                      const Eigen::VectorXd& coefficients, const FindNoise& find) const;
  /// @param chosen effects found so far; the shapes of those of the flow are uncertain
  void find_search(const std::vector<std::size_t>& chosen);
  /// Columns of the uncertain shapes of the chosen effects of the flow: groups first, then the added effects.
  std::vector<Eigen::MatrixXd> find_shape_uncertainty(const std::vector<std::size_t>& chosen);
  /// Whitens the columns, followed by those of uncertain shapes and the nuisances of GPS.
  /// @param of_gps which of all columns the first ones are; flights against GPS have no others
  WhitenedSystem whiten(const std::vector<Eigen::MatrixXd>& columns,
                        const std::vector<Eigen::Index>& of_gps) const;
  /// Whitens the columns of base and candidates.
  WhitenedSystem whiten_all() const;
  /// Removes the common noise from the rows against further references.
  void take_out_common_noise(WhitenedSystem& scores) const;

  /// Residual of a flight after columns with these coefficients, in bins.
  Eigen::VectorXd binned_residual_after(std::size_t flight, const Eigen::VectorXd& coefficients) const {
    return binned_.residuals[flight] - binned_.columns[flight] * coefficients;
  }
  /// Columns and residual of a flight as a refit has them: in bins, or the white rows of GPS.
  Eigen::MatrixXd rows_of_refit(std::size_t flight, const std::vector<Eigen::Index>& indices) const;
  /// Inverse variances of the priors of base and groups.
  Eigen::VectorXd precision_of(const std::vector<std::size_t>& groups) const;
  /// Coefficients of base and groups from the products of their columns and the residual with each other.
  /// @param rows number of rows in the products
  Eigen::VectorXd solution(const Eigen::MatrixXd& products, double rows,
                           const std::vector<std::size_t>& groups) const;
  /// Rms against the first reference, without outliers, hPa. @param coefficients for the records of each part
  double rms_of_parts(const std::vector<Eigen::VectorXd>& coefficients) const;
  /// Positions of the columns of base and groups.
  std::vector<Eigen::Index> indices_of(const std::vector<std::size_t>& groups) const;

  FlightPartition partition_;
  FlightPartition first_partition_;
  std::vector<FlightColumns> flights_{};
  std::vector<FlightColumns> further_{};  // against references after the first
  std::vector<ColumnGroup> groups_;
  Eigen::Index base_ = 0;
  BinnedFlights binned_{};
  std::vector<NoiseModel> noise_{};
  std::vector<std::vector<KnownNoise>> known_noise_{};  // against each reference; for repeated searches
  double drift_gain_ = 0.0;
  double likelihood_ = 0.0;
  Eigen::Index nuisances_ = 0;                  // columns of nuisances of GPS
  double variance_factor_ = 1.0;                // the whitened rows of GPS are divided by its root
  Eigen::VectorXd prior_;                       // inverse variances of the coefficients of the base
  std::vector<Eigen::VectorXd> added_{};        // coefficients of all columns for each added effect
  std::vector<Eigen::MatrixXd> uncertainty_{};  // columns of uncertain shapes of each flight, in bins
  Eigen::VectorXd coefficients_{};              // all columns, from the last noise estimate
  std::vector<Eigen::VectorXd> white_noise_{};  // whitened residuals after all findings
  std::unique_ptr<WhitenedSystem> scores_{};
  std::unique_ptr<EffectSearch> search_{};
  SearchResult result_{};
};

}  // namespace pcor::internal

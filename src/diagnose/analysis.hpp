#pragma once

#include <Eigen/Dense>
#include <cstdint>
#include <memory>
#include <vector>

#include "campaign/binned_flights.hpp"
#include "campaign/columns.hpp"
#include "diagnose/flight_columns.hpp"
#include "diagnose/search.hpp"
#include "diagnose/whitened_system.hpp"
#include "numerics/noise_model.hpp"

namespace pcor::internal {

/// The flights in stretches of five minutes, one in five of which is left out of a fit at a time.
inline constexpr std::size_t held_out_parts = 5;

/// The part that a time of a flight belongs to.
std::size_t held_out_part(const FlightSamples& samples, double time);

/// What is left on stretches that took no part in a fit.
struct HeldOut {
  /// Of a correction by least squares, as refit makes it: hPa, with the first reference, without outliers.
  double rms = 0.0;
  Eigen::VectorXd chi2;  ///< of each minute, squared innovations of all references in units of the noise
};

/// The statistics of a diagnosis: noise and missing effects of some flights, found in turn, since each needs
/// the other.
///
/// A flight is there once for each reference, those against the first reference first; each reference has a
/// noise of its own. What is told of flights without a number is told of the first reference; a number of a
/// flight counts them all. A member of a team has the records, bins and rows of its own flights; of the
/// others it has the outlines, and none.
class Analysis {
 public:
  /// @param groups of columns of the flights' candidates, one for each effect that is tested
  /// @param added coefficients of the base of effects of the flow that were found before and are in the model
  /// now, one vector for each effect
  Analysis(TeamColumns columns, std::vector<ColumnGroup> groups, std::uint64_t seed,
           const std::vector<Eigen::VectorXd>& added = {});

  /// Of the flights against the first reference.
  const FlightPartition& share() const { return first_share_; }
  /// Of all flights, each counted for each reference.
  const FlightPartition& whole_share() const { return share_; }
  const std::vector<FlightColumns>& flights() const { return flights_; }
  /// How many flights there are, each counted for each reference.
  std::size_t flight_count() const { return binned_.bins.size(); }
  const FlightColumns& flight(std::size_t number) const {
    return number < flights_.size() ? flights_[number] : further_[number - flights_.size()];
  }
  const std::vector<Binning>& bins() const { return first_bins_; }
  const Binning& bins(std::size_t flight) const { return binned_.bins[flight]; }
  /// Of the flights against the first reference, with the levels of the own.
  const NoiseModel& noise() const { return first_noise_; }
  /// Twice the gain in log-likelihood by slow drift against the first reference.
  double drift_gain() const { return drift_gain_; }
  const Search& search() const { return *search_; }
  const WhitenedSystem& scores() const { return *scores_; }
  /// The scores of the base with other columns behind it, instead of the candidates'. @param more in bins, of
  /// each flight against each reference
  WhitenedSystem scores_with(const std::vector<Eigen::MatrixXd>& more) const;
  const std::vector<ColumnGroup>& groups() const { return groups_; }
  const SearchResult& result() const { return result_; }
  Eigen::Index base() const { return base_; }

  /// Columns of base and of some groups, in bins, of each flight.
  std::vector<Eigen::MatrixXd> columns_of(const std::vector<std::size_t>& groups) const;
  /// Residuals in bins, outliers replaced.
  const std::vector<Eigen::VectorXd>& residuals() const { return first_residuals_; }

  /// What base and groups add to the residual of every record of a flight, hPa. @param estimate of base and
  /// the groups' columns, as `Search::fit` gives it
  std::vector<double> added(std::size_t flight, const std::vector<std::size_t>& groups,
                            const Eigen::VectorXd& estimate) const;
  /// What the group at place `which` of `groups` adds alone.
  std::vector<double> added_by(std::size_t flight, const std::vector<std::size_t>& groups, std::size_t which,
                               const Eigen::VectorXd& estimate) const;

  /// What base and groups leave on stretches of five minutes that took no part in their fit: one in five of
  /// them at a time.
  HeldOut held_out(const std::vector<std::size_t>& groups) const;

  /// The drift of a flight that is most likely after base and `groups`, one value for each record, hPa.
  std::vector<double> drift(std::size_t flight, const std::vector<std::size_t>& groups) const;

 private:
  /// Noise and effects in turn until they are stable; the likelihood of what came out, less what its effects
  /// cost. @param generous the first noise is found with whatever might be an effect taken off
  double search_from(const Eigen::VectorXd& start, bool generous);
  void replace_outliers(const std::vector<std::size_t>& groups, const Eigen::VectorXd& estimate);
  void find_noise(const std::vector<std::size_t>& groups, const Eigen::VectorXd& estimate);
  void find_first_noise(const Eigen::VectorXd& estimate);
  /// The noise of the flights against each reference. What flights share of it is found from a few of them,
  /// by `find(bins, columns, residuals)`; the levels of a flight follow from that and its own residual.
  void for_each_reference(const std::vector<std::size_t>& groups, const Eigen::VectorXd& estimate,
                          const FindNoise& find);
  void keep_coefficients(const std::vector<std::size_t>& groups, const Eigen::VectorXd& estimate);
  /// @param chosen effects found so far; the shapes of those of the flow are uncertain
  void find_search(const std::vector<std::size_t>& chosen);
  /// Columns of the uncertain shapes of the chosen effects of the flow, in the order of the groups, then of
  /// the effects that were added.
  std::vector<Eigen::MatrixXd> find_shape_uncertainty(const std::vector<std::size_t>& chosen);
  /// Whitens the columns, followed by those of uncertain shapes.
  WhitenedSystem whiten(const std::vector<Eigen::MatrixXd>& columns) const;
  /// Out of the rows against further references.
  void take_out_common_noise(WhitenedSystem& scores) const;
  FlightColumns& flight(std::size_t number) {
    return number < flights_.size() ? flights_[number] : further_[number - flights_.size()];
  }
  std::vector<Eigen::MatrixXd> all_columns_of(const std::vector<std::size_t>& groups) const;

  /// What base and groups leave of the residual of a flight, in bins.
  Eigen::VectorXd left_of(std::size_t flight, const std::vector<std::size_t>& groups,
                          const Eigen::VectorXd& estimate) const;
  /// The places of the columns of base and groups.
  std::vector<Eigen::Index> places_of(const std::vector<std::size_t>& groups) const;

  FlightPartition share_;
  FlightPartition first_share_;
  std::vector<FlightColumns> flights_{};
  std::vector<FlightColumns> further_{};  // against other references
  std::vector<ColumnGroup> groups_;
  std::uint64_t seed_;
  Eigen::Index base_ = 0;
  BinnedFlights binned_{};
  std::vector<Binning> first_bins_{};
  std::vector<Eigen::VectorXd> first_residuals_{};
  std::vector<NoiseModel> noise_{};
  NoiseModel first_noise_{};
  double drift_gain_ = 0.0;
  double likelihood_ = 0.0;
  std::vector<Eigen::VectorXd> added_{};        // coefficients of all columns, of each effect that was added
  std::vector<Eigen::MatrixXd> uncertainty_{};  // columns of uncertain shapes of each flight, in bins
  Eigen::VectorXd coefficients_{};              // of all columns, as the last noise was found with
  std::vector<Eigen::VectorXd> white_noise_{};  // what all that was found leaves of the whitened residuals
  std::unique_ptr<WhitenedSystem> scores_{};
  std::unique_ptr<Search> search_{};
  SearchResult result_{};
};

}  // namespace pcor::internal

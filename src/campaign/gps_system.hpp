#pragma once

#include <Eigen/Dense>
#include <cstddef>
#include <string>
#include <vector>

#include "campaign/gps_rows.hpp"

namespace pcor::internal {

/// Standard deviation of the prior of a coefficient of the law by GPS alone, in its typical size: GPS
/// determines few combinations of coefficients, and others would take impossible sizes.
inline constexpr double gps_prior_in_typical_sizes = 1.25;

/// Rows of one flight against wind or height, whitened: their noise is independent, with variance 1.
struct GpsSystem {
  /// Columns: the coefficients of `gps_rows` in their order; the nuisances that all flights share (the first
  /// `gps_shared_nuisances` of `gps_nuisances`), in units of their priors; the residual. A column is the
  /// decrease of the residual per unit of the coefficient. Shear and slopes of isobars differ between
  /// flights; they are eliminated with their priors.
  Eigen::MatrixXf rows{};
  std::vector<std::size_t> record{};  ///< sample of each row

  /// Of `count` columns from `first` on leaves out all but some. @param kept numbers from `first` on
  void keep(const std::vector<Eigen::Index>& kept, Eigen::Index first, Eigen::Index count);

  template <class Archive>
  void serialize(Archive& archive) {
    archive(rows, record);
  }
};

/// Whitens the rows of one flight.
///
/// The columns of `gps_rows` are without gusts and sensor noise that the residual contains: the gain of an
/// absent effect is distributed as chi2. Noise and outliers are fitted to the flight with the coefficients of
/// the law free, within a prior of their typical sizes about the values of the model, and without the
/// effects.
/// @param typical_sizes typical size of each coefficient of the law, the first columns, in its unit; 0:
/// unknown
GpsSystem gps_system(const GpsRows& rows, const std::vector<double>& typical_sizes);

/// Error of the thermometer, K, with ten times the deviation of its prior, and the law free within its own
/// prior. @param typical_sizes as in `gps_system`
double thermometer_of(const GpsSystem& system, const std::vector<double>& typical_sizes);

/// Warning that parts of the flights, or wind and height, disagree by more than their noise explains;
/// empty below a factor of two. @param variance factor of the variance of GPS, see `variance_factor`
std::string format_disagreement(double variance);

/// Evidence of one flight against wind or height about the error of delta-p in parts of its samples.
///
/// @param used samples of the comparison
/// @param parts samples of each part; the first part has all samples
/// @return for each part the products of whitened columns: the shared nuisances, in units of their priors; 1
/// hPa added to the static defect in all samples, and in the part; the residual. Products of flights are
/// additive. A part without samples has an empty matrix; no matrix if the flight has no row.
std::vector<Eigen::MatrixXd> gps_products_of_parts(GpsKind kind, const FlightSamples& samples,
                                                   const ModelDefinition& model,
                                                   const std::vector<std::size_t>& used,
                                                   const std::vector<std::vector<std::size_t>>& parts);

}  // namespace pcor::internal

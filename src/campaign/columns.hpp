#pragma once

#include <Eigen/Dense>
#include <cstddef>
#include <functional>
#include <memory>
#include <utility>
#include <vector>

#include <pcor/residuals/residuals.hpp>
#include "campaign/candidate.hpp"
#include "campaign/gps_system.hpp"
#include "numerics/binning.hpp"
#include "numerics/noise_model.hpp"
#include "parallel/flight_partition.hpp"

namespace pcor::internal {

/// Inputs of a diagnosis from a flight against one reference, one value for each record.
///
/// Columns are changes of the residual with the sign inverted: the reduction by a unit of a coefficient. They
/// are derivatives through the whole chain at the model's prediction, never at the noisy speed of the laser,
/// whose noise is in the residual.
struct FlightColumns {
  std::size_t file = 0;       ///< number of the file
  std::size_t reference = 0;  ///< number of the reference
  /// Time over which the residual holds one independent mean, s; zero: every sample.
  double window = 0.0;
  std::shared_ptr<const FlightSamples> samples;
  std::vector<Mask> mask;
  std::vector<double> given;     ///< residual with the coefficients of the model, hPa; NaN if not used
  std::vector<double> residual;  ///< `given` with outliers replaced in the diagnosis, hPa
  /// Exact residual of every sample, hPa, not measured at the sensor.
  std::vector<double> exact{};
  /// Like `given`, for samples excluded because of the flaps; NaN at all others. Columns are computed for
  /// them as well.
  std::vector<double> flaps_out{};
  Eigen::MatrixXf base;        ///< columns of the free coefficients of the models, hPa per unit
  Eigen::MatrixXf candidates;  ///< columns of the tested parameters of all candidates, one after another
  bool is_by_gps = false;      ///< against wind or height
  GpsSystem gps{};             ///< GPS fits: whitened rows, with the columns of `base` and `candidates`
  /// Motion of the flight, for smooth functions and pictures; NaN everywhere if unknown.
  std::vector<std::pair<Quantity, std::vector<double>>> quantities{};
  std::vector<double> corrected_pressure{};  ///< corrected static pressure, hPa

  const std::vector<double>& quantity(Quantity quantity) const;

  /// Leaves out the other columns of the base.
  void keep_base(const std::vector<Eigen::Index>& kept);
  /// Leaves out the other columns of candidates. @param kept numbers from the first candidate's column
  void keep_candidates(const std::vector<Eigen::Index>& kept);
};

/// Serialization of columns for other ranks.
void save(cereal::BinaryOutputArchive& archive, const FlightColumns& columns);
void load(cereal::BinaryInputArchive& archive, FlightColumns& columns);

/// Copy without records: the part known on ranks that do not own the flight.
FlightColumns outline_of(const FlightColumns& flight);

/// Computes the columns of one flight against one of the set's references.
///
/// @param extended samples with the inputs of the model, all candidates and the reference
/// @param first_part only the first part of the samples is used, 0 to 1
/// @throws Error if the model cannot be used on the samples.
FlightColumns find_columns(const std::shared_ptr<const FlightSamples>& extended, const ModelDefinition& model,
                           const CandidateModels& set, std::size_t reference, const MaskOptions& mask,
                           double first_part);

/// Binned flights of all ranks, each against one reference, grouped by reference. A rank has the bins of its
/// flights; for other flights it has the outline, and their bins are empty.
struct BinnedFlights {
  std::vector<Binning> bins{};
  std::vector<Eigen::MatrixXd> columns{};    ///< base and candidates, in bins
  std::vector<Eigen::VectorXd> residuals{};  ///< hPa, in bins
  std::vector<std::size_t> reference{};      ///< reference of each flight; the first reference comes first
  std::vector<NoiseFlight> outlines{};       ///< outlines of all flights
};

/// Bins in which the residual of each flight of this rank has values, hPa. @param residual_of returns the
/// residual
BinnedFlights in_bins(const FlightPartition& partition, const std::vector<FlightColumns>& flights,
                      const std::function<std::vector<double>(std::size_t flight)>& residual_of);

}  // namespace pcor::internal

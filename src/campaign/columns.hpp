#pragma once

#include <Eigen/Dense>
#include <memory>
#include <utility>
#include <vector>

#include <pcor/residuals/residuals.hpp>
#include "campaign/candidate.hpp"
#include "numerics/binning.hpp"
#include "residuals/packed_residuals.hpp"

namespace pcor::internal {

/// What a diagnosis sees of a flight against one reference, one value for each record.
///
/// Columns are changes of the residual, with the sign turned: what a unit of a coefficient takes away. They
/// are derivatives through the whole chain where the model says that the air is, never at the noisy speed of
/// the laser, whose noise is that of the residual.
struct FlightColumns {
  std::size_t file = 0;       ///< which of the files
  std::size_t reference = 0;  ///< which of the references
  /// Over how long a mean of the residual tells something new, s; zero: of every sample.
  double window = 0.0;
  std::shared_ptr<const FlightSamples> samples;
  std::vector<Mask> mask;
  std::vector<double> given;     ///< the residual with the coefficients of the model, hPa; NaN where not used
  std::vector<double> residual;  ///< the same; in the diagnosis outliers are replaced, hPa
  /// The residual as it is, not measured at the sensor, of every sample, hPa.
  std::vector<double> exact{};
  /// As `given`, of samples that are not used because flaps are out; NaN at all others. Columns are found for
  /// them too.
  std::vector<double> flaps_out{};
  Eigen::MatrixXf base;        ///< of the free coefficients of the models, hPa per unit
  Eigen::MatrixXf candidates;  ///< of the tested parameters of all candidates, one after another
  /// How the flight was flown, for smooth functions and pictures; NaN everywhere where not known.
  std::vector<std::pair<Quantity, std::vector<double>>> quantities{};
  std::vector<double> corrected_pressure{};  ///< static, hPa

  const std::vector<double>& quantity(Quantity quantity) const;

  template <class Archive>
  void serialize(Archive& archive) {
    archive(file, reference, window, samples, mask, given, residual, exact, flaps_out, base, candidates,
            quantities, corrected_pressure);
  }
};

/// The same without a record: what the members of a team know of a flight that another owns.
FlightColumns outline_of(const FlightColumns& flight);

/// Finds the columns of one flight against one of the set's references.
///
/// @param extended samples that hold what the model, all candidates and the reference read
/// @param first_part only the first part of the samples is used, 0 to 1
/// @throws Error if the model cannot be used on the samples.
FlightColumns find_columns(const std::shared_ptr<const FlightSamples>& extended, const ModelDefinition& model,
                           const CandidateModels& set, std::size_t reference, const MaskOptions& mask,
                           double first_part);

/// Base and candidates of a flight side by side, in bins.
Eigen::MatrixXd binned_columns(const FlightColumns& flight, const Binning& bins);

}  // namespace pcor::internal

#pragma once

#include <Eigen/Dense>
#include <memory>
#include <string>
#include <vector>

#include <pcor/residuals/reference.hpp>
#include <pcor/residuals/residuals.hpp>
#include "model_io/sensor_doubt.hpp"

namespace pcor::internal {

/// How far the calibration of a reference, and that of the thermometer, may be wrong, and what that does to
/// the residuals of a model.
///
/// Of the laser: scale and angles of the beam. Of a second static system: zero, gain and drift of its
/// transducers, and what its law states to leave of delta-p. Of the thermometer: its offset and the recovery
/// factor. Sizes: `doubts_of`.
class ReferenceDoubt {
 public:
  /// @param trusted the reference counts as exact: there is no doubt
  ReferenceDoubt(const ModelDefinition& model, const Reference& reference, bool trusted);

  /// Like "lams-scale.scale"; of a second system with its name in front. One name is one error, whichever
  /// reference it is seen in.
  const std::vector<std::string>& names() const { return names_; }
  /// Standard uncertainties, each in the unit of its coefficient.
  const Eigen::VectorXd& sizes() const { return sizes_; }
  bool empty() const { return names_.empty(); }

  /// What one standard uncertainty of each does to the residual at some samples, hPa, a column each.
  /// @param parameters of the residuals of the model held against the reference; null: those of the files
  Eigen::MatrixXd columns(const std::shared_ptr<const FlightSamples>& flight,
                          const std::vector<std::size_t>& samples, const double* parameters = nullptr) const;

 private:
  std::size_t model_parameters_;      // of the model as it came
  std::size_t reference_parameters_;  // of that of the reference
  ModelDefinition model_;             // with the effects of its doubts
  std::shared_ptr<const Reference> reference_;
  std::vector<std::string> names_;
  Eigen::VectorXd sizes_;
  std::vector<std::size_t> places_;  // among the parameters of residuals with all these effects
};

}  // namespace pcor::internal

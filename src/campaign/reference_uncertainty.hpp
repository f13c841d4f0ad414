#pragma once

#include <Eigen/Dense>
#include <memory>
#include <string>
#include <vector>

#include <pcor/residuals/reference.hpp>
#include <pcor/residuals/residuals.hpp>
#include "model_io/sensor_uncertainty.hpp"

namespace pcor::internal {

/// Calibration uncertainty of a reference and of the thermometer, and its effect on the residuals of a model.
///
/// Laser: scale and angles of the beam. Second static system: zero, gain and drift of its transducers, and
/// the stated residual error of delta-p of its model. Thermometer: offset and recovery factor. Sizes:
/// `uncertainties_of`.
///
/// A second system whose law is neither fitted nor fixed by the fit also has the stated errors of its
/// coefficients, one column for each independent direction.
class ReferenceUncertainty {
 public:
  /// @param trusted the calibration is assumed exact: its uncertainty is zero
  /// @param with_law add the stated errors of the law of a second system, also if it is trusted
  ReferenceUncertainty(const ModelDefinition& model, const Reference& reference, bool trusted,
                       bool with_law = false);

  /// Names like "lams-scale.scale"; for a second system with the variable of the sensor in front, like
  /// "QCFR: qcf-zero.offset"; for its law with the name of the law and both pressures. The same name in
  /// several references denotes the same error.
  const std::vector<std::string>& names() const { return names_; }
  /// Standard uncertainties, each in the unit of its coefficient.
  const Eigen::VectorXd& sizes() const { return sizes_; }
  bool empty() const { return names_.empty(); }

  /// Change of the residual by one standard uncertainty of each at some samples, hPa, a column each.
  /// @param parameters of the residuals of the model compared with the reference; null: values in the files
  Eigen::MatrixXd columns(const std::shared_ptr<const FlightSamples>& flight,
                          const std::vector<std::size_t>& samples, const double* parameters = nullptr) const;

 private:
  std::size_t model_parameters_;      // number of parameters of the input model
  std::size_t reference_parameters_;  // number of parameters of the reference's model
  ModelDefinition model_;             // model with the effects of its uncertainties
  std::shared_ptr<const Reference> reference_;
  Eigen::MatrixXd law_root_;  // square root of the covariance of its law; no columns: without these errors
  std::vector<std::string> names_;
  Eigen::VectorXd sizes_;
  std::vector<std::size_t> indices_;  // indices among the parameters of residuals with all these effects
};

}  // namespace pcor::internal

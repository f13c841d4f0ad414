#pragma once

#include <pcor/residuals/masks.hpp>
#include <pcor/residuals/reference.hpp>
#include <pcor/residuals/samples.hpp>

#include <array>
#include <cstddef>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

namespace pcor {

/// Coefficient that changes a parameter differently at every sample.
struct Direction {
  std::size_t parameter = 0;
  std::vector<double> rate{};  ///< one value per sample, units of the parameter per unit of the coefficient
};

/// Comparison of one model with one reference on one flight.
///
/// The residual is reference minus model, hPa. The parameters are those of the model, in the order of
/// `Chain::parameters`, followed by those of the reference's model if the reference is a static system: both
/// can be fitted.
class Residuals {
 public:
  /// @throws Error if the model, or that of the reference, cannot be used on the samples.
  Residuals(std::shared_ptr<const FlightSamples> samples, const ModelDefinition& model,
            const Reference& reference, const MaskOptions& options = {});
  /// Constructor with known masks, from these samples or from others of the same flight.
  Residuals(std::shared_ptr<const FlightSamples> samples, const ModelDefinition& model,
            const Reference& reference, std::vector<Mask> mask);
  Residuals(Residuals&&) noexcept;
  Residuals& operator=(Residuals&&) noexcept;
  ~Residuals();

  const FlightSamples& samples() const { return *samples_; }
  const std::shared_ptr<const FlightSamples>& shared_samples() const { return samples_; }
  std::size_t size() const { return samples_->time.size(); }

  /// Parameters in the model files.
  const std::vector<double>& parameters() const { return parameters_; }

  /// True for each parameter in which the residual is exactly linear: for a static-pressure residual the
  /// parameters of catalogue effects at the static ports, unless delta-p has a lower limit.
  const std::vector<bool>& is_linear() const { return linear_; }

  /// Mask of every sample, at the parameters of the files unless `set_mask` replaced it.
  const std::vector<Mask>& mask() const { return mask_; }

  /// Masks for the residual at these parameters, on which the detection of bursts depends.
  std::vector<Mask> masks_at(const double* parameters, const MaskOptions& options) const;
  void set_mask(std::vector<Mask> mask) { mask_ = std::move(mask); }

  std::array<std::size_t, mask_count> mask_counts() const;

  /// Residual of every sample, NaN if a value is missing. @param parameters all of them
  std::vector<double> values(const double* parameters) const;

  /// Residuals and their derivatives at some samples.
  ///
  /// @param samples indices of the samples
  /// @param parameters all of them
  /// @param requested requested parameters of the derivatives
  /// @param residual a value for each of the samples, hPa
  /// @param derivatives `requested.size()` columns with a value for each of the samples, column by column,
  /// hPa per unit of the parameter. Linear ones are exact from the model, others by dual numbers through the
  /// whole chain.
  void evaluate(const std::vector<std::size_t>& samples, const double* parameters,
                const std::vector<std::size_t>& requested, double* residual, double* derivatives) const;

  /// Variant of `evaluate` with the residual at the sensor of the reference, to which its noise is added: the
  /// LAMS speed along the beam minus `predicted_sensor`, multiplied by the derivative of the residual with
  /// respect to it at the air data of the model. Equal to the residual to first order, hPa. Identical to
  /// `evaluate` for references without such a sensor.
  ///
  /// Delta-p from LAMS is a gain times the noisy speed, and an effect before it (the recovery factor, the
  /// elevation of the beam) changes that gain: least squares of delta-p would reduce the gain to reduce the
  /// noise, and detect a false effect.
  void evaluate_at_sensor(const std::vector<std::size_t>& samples, const double* parameters,
                          const std::vector<std::size_t>& requested, double* residual,
                          double* derivatives) const;

  /// Half-width of the window of samples on which a residual depends; zero if it depends on one sample only.
  std::size_t half_width() const;

  /// Derivatives at some samples of residuals with a window, with respect to coefficients whose effect varies
  /// from sample to sample: with the parameters a_k of the samples k, the sum of dr_i/da_k rate_k. Exact:
  /// dual numbers through the whole chain and through the sums over the window. Samples whose rate is zero
  /// need no finite derivative.
  ///
  /// @param derivatives `directions.size()` columns with a value for each of the samples, column by column,
  /// hPa per unit of the coefficient
  /// @pre `half_width()` is not zero
  void differentiate_along(const std::vector<std::size_t>& samples, const double* parameters,
                           const std::vector<Direction>& directions, double* derivatives) const;

  /// Model column measured by the sensor of the reference, and its noise-free prediction at every sample from
  /// the air data of the model: for LAMS the speed along the beam, m/s. NaN if missing. Empty for a
  /// reference whose noise is added directly to the residual.
  std::optional<std::pair<Quantity, std::vector<double>>> predicted_sensor(const double* parameters) const;

  /// Copy of the samples in which both systems have the mean of the two recorded static, and of the two
  /// dynamic, pressures, for derivatives with respect to coefficients of two static systems. nullptr if the
  /// reference is not a static system.
  ///
  /// If both models contain the same effect, only the difference of its coefficients is determined, and the
  /// two derivatives must be exactly opposite. At the recorded pressures they differ by the noise of the
  /// residual, which biases common coefficients: a fit would reduce the noise by tens of hPa of static
  /// defect. The pressures differ by the difference of the defects, less than 1 %, and so do the derivatives.
  /// The mean still contains the noise of the noisier system, so the dynamic pressure is predicted from the
  /// radome, if it is recorded.
  std::shared_ptr<const FlightSamples> at_common_pressures() const;

  /// Delta-p required by the reference, p(reference) - p at the port, hPa; NaN if missing.
  std::vector<double> target_defect(const double* parameters) const;

  /// Quantity of the model's chain, for figures and bands: e.g. mach, attack. NaN everywhere if the chain
  /// does not compute it.
  std::vector<double> quantity(Quantity quantity, const double* parameters) const;

 private:
  std::shared_ptr<const FlightSamples> samples_;
  std::unique_ptr<ModelOnSamples> model_;
  std::unique_ptr<ReferenceOnSamples> reference_;
  std::vector<double> parameters_;
  std::vector<bool>
      linear_terms_;          // one per parameter: whether delta-p alone depends on it, as a linear term
  std::vector<bool> linear_;  // one per parameter: linear term without a minimum of delta-p
  std::vector<Mask> mask_;
};

}  // namespace pcor

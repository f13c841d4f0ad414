#pragma once

#include <pcor/residuals/masks.hpp>
#include <pcor/residuals/reference.hpp>
#include <pcor/residuals/samples.hpp>

#include <array>
#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace pcor {

/// A coefficient that changes a parameter differently at every sample.
struct Direction {
  std::size_t parameter = 0;
  std::vector<double> rate{};  ///< of every sample, units of the parameter per unit of the coefficient
};

/// One model held against one reference on one flight.
///
/// The residual is that of the reference less the model, hPa. Its parameters are those of the model, in the
/// order of `Chain::parameters`, and after them those of the reference's model where the reference is a
/// static system: both can be fitted.
class Residuals {
 public:
  /// @throws Error if the model, or that of the reference, cannot be used on the samples.
  Residuals(std::shared_ptr<const FlightSamples> samples, const ModelDefinition& model,
            const Reference& reference, const MaskOptions& options = {});
  /// The same with masks that are known: they were found on these samples, or on others of the same flight.
  Residuals(std::shared_ptr<const FlightSamples> samples, const ModelDefinition& model,
            const Reference& reference, std::vector<Mask> mask);
  Residuals(Residuals&&) noexcept;
  Residuals& operator=(Residuals&&) noexcept;
  ~Residuals();

  const FlightSamples& samples() const;
  const std::shared_ptr<const FlightSamples>& shared_samples() const;
  std::size_t size() const;

  /// The parameters as the models' files have them.
  const std::vector<double>& parameters() const;

  /// True for each parameter in which the residual is exactly linear: where it is a static pressure, those of
  /// effects of the catalogue at the static ports, where delta-p has no lower limit.
  const std::vector<bool>& is_linear() const;

  /// The mask of every sample, at the parameters of the files unless `set_mask` replaced it.
  const std::vector<Mask>& mask() const;

  /// The masks with the residual at these parameters: bursts are seen in it.
  std::vector<Mask> masks_at(const double* parameters, const MaskOptions& options) const;
  void set_mask(std::vector<Mask> mask);

  std::array<std::size_t, mask_count> mask_counts() const;

  /// The residual of every sample, NaN where a value is missing. @param parameters all of them
  std::vector<double> values(const double* parameters) const;

  /// Residuals and their derivatives at some samples.
  ///
  /// @param samples `count` places of samples
  /// @param parameters all of them
  /// @param wanted the parameters whose derivatives are wanted
  /// @param residual `count` values, hPa
  /// @param derivatives `wanted.size()` columns of `count` values, one after another, hPa per unit of the
  ///        parameter
  /// Exact: linear ones from the model itself, others by dual numbers through the whole chain.
  void evaluate(const std::size_t* samples, std::size_t count, const double* parameters,
                const std::vector<std::size_t>& wanted, double* residual, double* derivatives) const;

  /// As `evaluate`, with the residual measured where the noise of the reference's sensor is added to it: the
  /// speed along the beam of LAMS less `predicted_sensor`, times the derivative of the residual by it where
  /// the model of the file says that the air is. Equal to the residual to first order, hPa. The same as
  /// `evaluate` for references without such a sensor.
  ///
  /// Delta-p from LAMS is a gain times the noisy speed, and an effect before it (the recovery factor, the
  /// elevation of the beam) changes that gain: least squares of delta-p would shrink the gain to shrink the
  /// noise, and find an effect that is not there.
  void evaluate_at_sensor(const std::size_t* samples, std::size_t count, const double* parameters,
                          const std::vector<std::size_t>& wanted, double* residual,
                          double* derivatives) const;

  /// How many samples on either side a residual is made of; zero where it is of one sample alone.
  std::size_t reach() const;

  /// Derivatives at some samples of residuals that are made of their neighbours too, by coefficients that
  /// change from sample to sample: with the parameters a_k of the samples k, the sum of dr_i/da_k rate_k.
  /// Exact: dual numbers through the whole chain and through the sums over neighbours. Samples whose rate is
  /// zero need no finite derivative of their own.
  ///
  /// @param derivatives `directions.size()` columns of `count` values, one after another, hPa per unit of the
  ///        coefficient
  /// @pre `reach()` is not zero
  void differentiate_along(const std::size_t* samples, std::size_t count, const double* parameters,
                           const std::vector<Direction>& directions, double* derivatives) const;

  /// The column of the model's samples that the sensor of the reference fills, and what the sensor would show
  /// at every sample where the model says that the air is, without its noise: of LAMS the speed along the
  /// beam, m/s. NaN where missing. Nothing for a reference whose noise is added to the residual itself.
  std::optional<std::pair<Quantity, std::vector<double>>> predicted_sensor(const double* parameters) const;

  /// The samples with the mean of what model and reference recorded as the static and the dynamic pressure of
  /// both: where derivatives by coefficients of two static systems are to be taken. Null where the reference
  /// is no static system.
  ///
  /// Of the same effect in both laws the flights know the difference alone, and there the two derivatives are
  /// exactly opposite. At the recorded pressures they differ by the noise of the residual, which a fit takes
  /// for a signal of what both systems have in common: it shrinks the noise by tens of hPa of static defect.
  /// The pressures differ by the difference of the defects, less than 1 %, and so do the derivatives. The
  /// mean still holds the noise of the noisier system, so the dynamic pressure is the one that the radome
  /// predicts, where it is recorded.
  std::shared_ptr<const FlightSamples> at_common_pressures() const;

  /// Delta-p that the reference asks for, p(reference) - p at the port, hPa; NaN where missing.
  std::vector<double> target_defect(const double* parameters) const;

  /// A quantity of the model's chain, for pictures and bands: e.g. mach, attack. NaN everywhere where the
  /// chain does not have it.
  std::vector<double> quantity(Quantity quantity, const double* parameters) const;

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

/// The names of all parameters in the order of `Residuals::parameters`, like "static-qp.a2"; those of the
/// reference's model begin with "reference:".
std::vector<std::string> residual_parameter_names(const ModelDefinition& model, const Reference& reference);

}  // namespace pcor

#pragma once

#include <ceres/jet.h>

#include <cstddef>
#include <vector>

#include <pcor/residuals/masks.hpp>
#include <pcor/residuals/residuals.hpp>
#include "residuals/model_on_samples.hpp"

namespace pcor::internal {

inline constexpr int jet_width = 4;

/// Number and its derivatives with respect to a few parameters.
using Jet = ceres::Jet<double, jet_width>;

/// Sensor of a reference whose noise enters the residual through the chain.
class NoisySensor {
 public:
  virtual ~NoisySensor() = default;

  /// Column of the model's samples that it fills.
  virtual Quantity quantity() const = 0;

  /// Noise-free reading of the sensor predicted by the model, at some samples.
  virtual void predict(const std::size_t* samples, std::size_t count, const double* parameters,
                       double* out) const = 0;
  virtual void predict(const std::size_t* samples, std::size_t count, const Jet* parameters,
                       Jet* out) const = 0;

  /// Derivative of the predicted reading with respect to delta-p, units per hPa, at some samples.
  virtual void differentiate_by_defect(const std::size_t* samples, std::size_t count,
                                       const double* parameters, double* out) const = 0;

  /// Derivative of the residual with respect to the sensor, hPa per unit, at the prediction with the files'
  /// parameters, for every sample.
  virtual std::vector<double> sensitivity() const = 0;
};

/// Residual that depends on neighbouring samples.
class Neighbours {
 public:
  virtual ~Neighbours() = default;

  /// Number of samples on either side.
  virtual std::size_t reach() const = 0;

  /// `Residuals::differentiate_along`.
  virtual void differentiate(const std::size_t* samples, std::size_t count, const double* parameters,
                             const std::vector<Direction>& directions, double* derivatives) const = 0;
};

/// Reference on the samples of a flight, compared with a model. The parameters are all parameters of the
/// model, followed by all parameters of the reference's model.
class ReferenceOnSamples {
 public:
  /// Some samples, with the gathered inputs of model and reference.
  struct Block {
    const std::vector<Batch::Input>& model;
    const std::vector<Batch::Input>& reference;
    const std::size_t* samples;  ///< indices of the samples
    std::size_t count;
  };

  virtual ~ReferenceOnSamples() = default;

  /// Reference minus model, hPa.
  virtual void residuals(const Block& block, const double* parameters, double* out) const = 0;
  virtual void residuals(const std::size_t* samples, std::size_t count, const Jet* parameters,
                         Jet* out) const = 0;

  /// Inputs of the reference.
  virtual std::vector<Batch::Input> columns() const { return {}; }

  /// Model that corrects it; null without a model.
  virtual const ModelOnSamples* model() const { return nullptr; }

  /// Null if its noise is added to the residual directly.
  virtual const NoisySensor* sensor() const { return nullptr; }

  /// Null if its residual depends on one sample.
  virtual const Neighbours* neighbours() const { return nullptr; }

  /// Reason why a sample has no residual although the model has its pressures.
  virtual Mask why_missing(std::size_t sample) const = 0;

  /// Marks the samples with implausible values of the reference, among samples that have a residual and no
  /// other mask.
  /// @param airspeed of the pressures, m/s
  virtual void mark_implausible(std::vector<Mask>& masks, const std::vector<double>& airspeed,
                                const MaskOptions& options) const;
};

}  // namespace pcor::internal

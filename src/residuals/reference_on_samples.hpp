#pragma once

#include <ceres/jet.h>

#include <cstddef>
#include <vector>

#include <pcor/residuals/masks.hpp>
#include <pcor/residuals/residuals.hpp>
#include "residuals/model_on_samples.hpp"

namespace pcor::internal {

inline constexpr int jet_width = 4;

/// A number and its derivatives by a few parameters.
using Jet = ceres::Jet<double, jet_width>;

/// A sensor of a reference whose noise goes through the chain before it is in the residual.
class NoisySensor {
 public:
  virtual ~NoisySensor() = default;

  /// Which column of the model's samples it fills.
  virtual Quantity quantity() const = 0;

  /// What it would show where the model says that the air is, without its noise, at some samples.
  virtual void predict(const std::size_t* samples, std::size_t count, const double* parameters,
                       double* out) const = 0;
  virtual void predict(const std::size_t* samples, std::size_t count, const Jet* parameters,
                       Jet* out) const = 0;

  /// The derivative of the residual by it, hPa per unit, at the prediction of the files' parameters, for
  /// every sample.
  virtual std::vector<double> sensitivity() const = 0;
};

/// A residual that is made of the samples around its own.
class Neighbours {
 public:
  virtual ~Neighbours() = default;

  /// How many samples on either side.
  virtual std::size_t reach() const = 0;

  /// `Residuals::differentiate_along`.
  virtual void differentiate(const std::size_t* samples, std::size_t count, const double* parameters,
                             const std::vector<Direction>& directions, double* derivatives) const = 0;
};

/// What a reference says of the samples of a flight, beside the model that is held against it. Parameters are
/// all of them: those of the model, then those of the reference's own model.
class ReferenceOnSamples {
 public:
  /// Some samples, with what model and reference read of them gathered.
  struct Block {
    const std::vector<Batch::Input>& model;
    const std::vector<Batch::Input>& reference;
    const std::size_t* samples;  ///< which they are
    std::size_t count;
  };

  virtual ~ReferenceOnSamples() = default;

  /// Of the reference less the model, hPa.
  virtual void residuals(const Block& block, const double* parameters, double* out) const = 0;
  virtual void residuals(const std::size_t* samples, std::size_t count, const Jet* parameters,
                         Jet* out) const = 0;

  /// What it reads for itself.
  virtual std::vector<Batch::Input> columns() const { return {}; }

  /// The model that corrects it; null where it has none.
  virtual const ModelOnSamples* model() const { return nullptr; }

  /// Null where its noise is added to the residual itself.
  virtual const NoisySensor* sensor() const { return nullptr; }

  /// Null where its residual is of one sample alone.
  virtual const Neighbours* neighbours() const { return nullptr; }

  /// Why a sample has no residual, though the model has its pressures.
  virtual Mask why_missing(std::size_t sample) const = 0;

  /// Marks the samples at which it cannot be believed, among those that have a residual and no other mask.
  /// @param airspeed of the pressures, m/s
  virtual void mark_implausible(std::vector<Mask>& masks, const std::vector<double>& airspeed,
                                const MaskOptions& options) const;
};

}  // namespace pcor::internal

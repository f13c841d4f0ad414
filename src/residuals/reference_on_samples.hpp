#pragma once

#include <ceres/jet.h>

#include <algorithm>
#include <cstddef>
#include <vector>

#include <pcor/residuals/masks.hpp>
#include <pcor/residuals/residuals.hpp>
#include "residuals/model_on_samples.hpp"

namespace pcor {

namespace internal {

inline constexpr int jet_width = 4;

/// Number and its derivatives with respect to a few parameters.
using Jet = ceres::Jet<double, jet_width>;

/// Parameter, and the destination of derivatives by it.
struct ColumnOfParameter {
  std::size_t parameter;
  double* values;
};

/// Derivatives by dual numbers. `evaluate(dual, out)` computes the `count` values for dual parameters.
template <class Evaluate>
void differentiate(std::size_t count, const std::vector<double>& parameters,
                   const std::vector<ColumnOfParameter>& columns, const Evaluate& evaluate) {
  std::vector<Jet> out(count);
  for (std::size_t first = 0; first < columns.size(); first += jet_width) {
    const std::size_t width = std::min<std::size_t>(jet_width, columns.size() - first);
    std::vector<Jet> dual(parameters.begin(), parameters.end());
    for (std::size_t k = 0; k < width; ++k)
      dual[columns[first + k].parameter].v[static_cast<Eigen::Index>(k)] = 1.0;
    evaluate(static_cast<const Jet*>(dual.data()), out.data());
    for (std::size_t k = 0; k < width; ++k) {
      for (std::size_t i = 0; i < count; ++i)
        columns[first + k].values[i] = out[i].v[static_cast<Eigen::Index>(k)];
    }
  }
}

class LamsOnSamples;

}  // namespace internal

/// Reference on the samples of a flight, compared with a model. The parameters are all parameters of the
/// model, followed by all parameters of the reference's model.
class ReferenceOnSamples {
 public:
  /// Some samples, with the gathered inputs of model and reference.
  struct Block {
    const std::vector<Batch::Input>& model;
    const std::vector<Batch::Input>& reference;
    const std::vector<std::size_t>& samples;  ///< indices of the samples
  };

  virtual ~ReferenceOnSamples() = default;

  /// Reference minus model, hPa.
  virtual void residuals(const Block& block, const double* parameters, double* out) const = 0;
  virtual void residuals(const std::vector<std::size_t>& samples, const internal::Jet* parameters,
                         internal::Jet* out) const = 0;

  /// Inputs of the reference.
  virtual std::vector<Batch::Input> columns() const { return {}; }

  /// Model that corrects it; null without a model.
  virtual const ModelOnSamples* model() const { return nullptr; }

  /// The laser, whose noise enters the residual through the chain; null if the noise of the reference is
  /// added to the residual directly.
  virtual const internal::LamsOnSamples* laser() const { return nullptr; }

  /// Number of samples on either side on which its residual depends.
  virtual std::size_t half_width() const { return 0; }

  /// `Residuals::differentiate_along`; called only if `half_width()` is not 0.
  virtual void differentiate_along(const std::vector<std::size_t>&, const double*,
                                   const std::vector<Direction>&, double*) const {}

  /// Reason why a sample has no residual although the model has its pressures.
  virtual Mask why_missing(std::size_t sample) const = 0;

  /// Marks the samples with implausible values of the reference, among samples that have a residual and no
  /// other mask.
  /// @param airspeed of the pressures, m/s
  virtual void mark_implausible(std::vector<Mask>& /*masks*/, const std::vector<double>& /*airspeed*/) const {
  }
};

}  // namespace pcor

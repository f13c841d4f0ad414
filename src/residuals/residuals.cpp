#include <pcor/residuals/residuals.hpp>

#include <algorithm>
#include <functional>
#include <mutex>
#include <numeric>
#include <utility>

#include "numerics/missing.hpp"
#include "residuals/masks.hpp"
#include "residuals/model_on_samples.hpp"
#include "residuals/moving_columns.hpp"
#include "residuals/predicted_pressures.hpp"
#include "residuals/references/lams.hpp"

namespace pcor {

using namespace internal;

namespace {

/// Derivatives by dual numbers with respect to the parameters `indices` among the `requested` ones, into
/// their columns. `values(dual, out)` computes the `count` values for dual parameters.
template <class Values>
void differentiate(std::size_t count, const std::vector<double>& parameters,
                   const std::vector<std::size_t>& requested, const std::vector<std::size_t>& indices,
                   double* derivatives, const Values& values) {
  std::vector<Jet> dual(parameters.size());
  std::vector<Jet> out(count);
  for (std::size_t first = 0; first < indices.size(); first += jet_width) {
    const std::size_t width = std::min<std::size_t>(jet_width, indices.size() - first);
    for (std::size_t p = 0; p < dual.size(); ++p) dual[p] = Jet(parameters[p]);
    for (std::size_t k = 0; k < width; ++k)
      dual[requested[indices[first + k]]].v[static_cast<Eigen::Index>(k)] = 1.0;
    values(dual.data(), out.data());
    for (std::size_t k = 0; k < width; ++k) {
      double* const column = derivatives + indices[first + k] * count;
      for (std::size_t i = 0; i < count; ++i) column[i] = out[i].v[static_cast<Eigen::Index>(k)];
    }
  }
}

}  // namespace

struct Residuals::Implementation {
  std::shared_ptr<const FlightSamples> samples;
  ModelOnSamples model;
  std::unique_ptr<ReferenceOnSamples> reference;
  std::vector<Batch::Input> reference_columns;
  std::vector<double> parameters;
  std::vector<bool> terms;   ///< one per parameter: `ModelOnSamples::linear_terms`, if it is of delta-p alone
  std::vector<bool> linear;  ///< one per parameter: linear term without a minimum of delta-p
  std::vector<Mask> mask;

  /// Derivative of the residual with respect to the speed along the beam; computed on first use.
  const std::vector<double>& sensitivity() const {
    std::call_once(found_, [this] { sensitivity_ = reference->laser()->sensitivity(); });
    return sensitivity_;
  }

  Implementation(std::shared_ptr<const FlightSamples> flight, const ModelDefinition& of,
                 const Reference& compared_with)
      : samples(std::move(flight)),
        model(of, samples->model),
        reference(compared_with.on(*samples, model)),
        reference_columns(reference->columns()),
        parameters(model.parameters()),
        terms(model.linear_terms()),
        linear(terms.size(), !model.chain().has_minimum()) {
    if (const ModelOnSamples* const other = reference->model()) {
      parameters.insert(parameters.end(), other->parameters().begin(), other->parameters().end());
      const std::vector<bool> more = other->linear_terms();
      terms.insert(terms.end(), more.begin(), more.end());
      linear.resize(terms.size(), !other->chain().has_minimum());
    }
    if (!compared_with.is_static_pressure()) terms.assign(terms.size(), false);
    std::transform(terms.begin(), terms.end(), linear.begin(), linear.begin(), std::logical_and<>());
  }

 private:
  mutable std::once_flag found_;
  mutable std::vector<double> sensitivity_;
};

Residuals::Residuals(std::shared_ptr<const FlightSamples> samples, const ModelDefinition& model,
                     const Reference& reference, const MaskOptions& options)
    : Residuals(std::move(samples), model, reference, std::vector<Mask>()) {
  set_mask(masks_at(parameters().data(), options));
}

Residuals::Residuals(std::shared_ptr<const FlightSamples> samples, const ModelDefinition& model,
                     const Reference& reference, std::vector<Mask> mask)
    : implementation_(std::make_unique<Implementation>(std::move(samples), model, reference)) {
  implementation_->mask = std::move(mask);
}

Residuals::Residuals(Residuals&&) noexcept = default;
Residuals& Residuals::operator=(Residuals&&) noexcept = default;
Residuals::~Residuals() = default;

const FlightSamples& Residuals::samples() const { return *implementation_->samples; }
const std::shared_ptr<const FlightSamples>& Residuals::shared_samples() const {
  return implementation_->samples;
}
std::size_t Residuals::size() const { return implementation_->samples->time.size(); }
const std::vector<double>& Residuals::parameters() const { return implementation_->parameters; }
const std::vector<bool>& Residuals::is_linear() const { return implementation_->linear; }
const std::vector<Mask>& Residuals::mask() const { return implementation_->mask; }

std::vector<Mask> Residuals::masks_at(const double* parameters, const MaskOptions& options) const {
  const Implementation& impl = *implementation_;
  return find_masks(samples(), impl.model, *impl.reference, values(parameters), options);
}

void Residuals::set_mask(std::vector<Mask> mask) { implementation_->mask = std::move(mask); }

std::array<std::size_t, mask_count> Residuals::mask_counts() const {
  std::array<std::size_t, mask_count> counts{};
  for (const Mask mask : implementation_->mask) ++counts[static_cast<std::size_t>(mask)];
  return counts;
}

std::vector<double> Residuals::values(const double* parameters) const {
  const Implementation& impl = *implementation_;
  std::vector<double> result(size());
  std::vector<std::size_t> all(size());
  std::iota(all.begin(), all.end(), 0);
  ModelSamples store;
  const std::vector<Batch::Input> inputs = columns_at(parameters, impl.model, *impl.samples, store);
  impl.reference->residuals({inputs, impl.reference_columns, all.data(), size()}, parameters, result.data());
  return result;
}

void Residuals::evaluate(const std::size_t* samples, std::size_t count, const double* parameters,
                         const std::vector<std::size_t>& requested, double* residual,
                         double* derivatives) const {
  const Implementation& impl = *implementation_;
  std::vector<double> store;
  std::vector<double> reference_store;
  const std::vector<Batch::Input> inputs = impl.model.gathered(samples, count, parameters, store);
  const std::vector<Batch::Input> reference_inputs =
      gathered(impl.reference_columns, samples, count, reference_store);
  impl.reference->residuals({inputs, reference_inputs, samples, count}, parameters, residual);

  const std::size_t of_model = impl.model.parameters().size();
  std::vector<std::size_t> curved;  // indices in `requested`
  std::vector<Batch::Derivative> by_model;
  std::vector<Batch::Derivative> by_reference;
  for (std::size_t k = 0; k < requested.size(); ++k) {
    double* const column = derivatives + k * count;
    if (!impl.terms[requested[k]]) {
      curved.push_back(k);
    } else if (requested[k] < of_model) {
      by_model.push_back(impl.model.derivative_by(requested[k], column));
    } else {
      by_reference.push_back(impl.reference->model()->derivative_by(requested[k] - of_model, column));
    }
  }
  if (!by_model.empty()) impl.model.batch().differentiate(inputs, by_model, count, parameters);
  for (const Batch::Derivative& each : by_model) {
    for (std::size_t i = 0; i < count; ++i) each.values[i] = -each.values[i];
  }
  if (!by_reference.empty()) {
    impl.reference->model()->batch().differentiate(reference_inputs, by_reference, count,
                                                   parameters + of_model);
  }
  differentiate(count, {parameters, parameters + impl.parameters.size()}, requested, curved, derivatives,
                [&](const Jet* dual, Jet* out) { impl.reference->residuals(samples, count, dual, out); });
}

void Residuals::evaluate_at_sensor(const std::size_t* samples, std::size_t count, const double* parameters,
                                   const std::vector<std::size_t>& requested, double* residual,
                                   double* derivatives) const {
  const Implementation& impl = *implementation_;
  const LamsOnSamples* const laser = impl.reference->laser();
  if (laser == nullptr) return evaluate(samples, count, parameters, requested, residual, derivatives);
  const std::vector<double>& recorded = *impl.samples->model.find(Quantity::lams_airspeed);
  const std::vector<double>& sensitivity = impl.sensitivity();
  for (std::size_t i = 0; i < count; ++i) {
    const double predicted = laser->predicted_at(samples[i], parameters);
    residual[i] = sensitivity[samples[i]] * (recorded[samples[i]] - predicted);
  }
  // The reading depends on the coefficients of linear terms through delta-p alone.
  const std::vector<bool> terms = impl.model.linear_terms();
  std::vector<std::size_t> curved;  // indices in `requested`
  std::vector<Batch::Derivative> by_defect;
  for (std::size_t k = 0; k < requested.size(); ++k) {
    if (requested[k] < terms.size() && terms[requested[k]])
      by_defect.push_back(impl.model.derivative_by(requested[k], derivatives + k * count));
    else
      curved.push_back(k);
  }
  if (!by_defect.empty()) {
    std::vector<double> store;
    impl.model.batch().differentiate(impl.model.gathered(samples, count, parameters, store), by_defect, count,
                                     parameters);
    const std::vector<Jet> constant(parameters, parameters + terms.size());
    for (std::size_t i = 0; i < count; ++i) {
      const double slope = laser->predicted_at(samples[i], constant.data(), Jet(0.0, 0)).v[0];
      for (const Batch::Derivative& each : by_defect) each.values[i] *= slope;
    }
  }
  differentiate(count, {parameters, parameters + impl.parameters.size()}, requested, curved, derivatives,
                [&](const Jet* dual, Jet* out) {
                  for (std::size_t i = 0; i < count; ++i) out[i] = laser->predicted_at(samples[i], dual);
                });
  for (std::size_t k = 0; k < requested.size(); ++k) {
    for (std::size_t i = 0; i < count; ++i) derivatives[k * count + i] *= -sensitivity[samples[i]];
  }
}

std::size_t Residuals::reach() const { return implementation_->reference->reach(); }

void Residuals::differentiate_along(const std::size_t* samples, std::size_t count, const double* parameters,
                                    const std::vector<Direction>& directions, double* derivatives) const {
  implementation_->reference->differentiate_along(samples, count, parameters, directions, derivatives);
}

std::optional<std::pair<Quantity, std::vector<double>>> Residuals::predicted_sensor(
    const double* parameters) const {
  const LamsOnSamples* const laser = implementation_->reference->laser();
  if (laser == nullptr) return std::nullopt;
  std::vector<double> values;
  for (std::size_t i = 0; i < size(); ++i) values.push_back(laser->predicted_at(i, parameters));
  return std::pair(Quantity::lams_airspeed, std::move(values));
}

std::shared_ptr<const FlightSamples> Residuals::at_common_pressures() const {
  const Implementation& impl = *implementation_;
  if (impl.reference->model() == nullptr) return nullptr;
  auto result = std::make_shared<FlightSamples>(*impl.samples);
  for (const Quantity pressure : {Quantity::static_pressure, Quantity::dynamic_pressure}) {
    std::vector<double>& ours = *result->model.find(pressure);
    std::vector<double>& theirs = *result->reference.find(pressure);
    for (std::size_t i = 0; i < size(); ++i) ours[i] = 0.5 * (ours[i] + theirs[i]);
    if (pressure == Quantity::dynamic_pressure) ours = predicted_by_radome(std::move(ours), result->model);
    theirs = ours;
  }
  return result;
}

std::vector<double> Residuals::target_defect(const double* parameters) const {
  std::vector<double> result = values(parameters);
  const std::vector<double> defect = quantity(Quantity::static_defect, parameters);
  for (std::size_t i = 0; i < result.size(); ++i) result[i] += defect[i];
  return result;
}

std::vector<double> Residuals::quantity(Quantity quantity, const double* parameters) const {
  const Implementation& impl = *implementation_;
  std::vector<double> result(size(), nan);
  if (!impl.model.batch().finds(quantity)) return result;
  ModelSamples store;
  const std::vector<Batch::Input> inputs = columns_at(parameters, impl.model, *impl.samples, store);
  impl.model.batch().run(inputs, {{quantity, result.data()}}, size(), parameters);
  return result;
}

}  // namespace pcor

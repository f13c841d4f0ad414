#include <pcor/residuals/residuals.hpp>

#include <algorithm>
#include <functional>
#include <numeric>
#include <utility>

#include "numerics/missing.hpp"
#include "residuals/masks.hpp"
#include "residuals/model_on_samples.hpp"
#include "residuals/parameter_dependent_columns.hpp"
#include "residuals/predicted_pressures.hpp"
#include "residuals/references/lams.hpp"

namespace pcor {

using namespace internal;

Residuals::Residuals(std::shared_ptr<const FlightSamples> samples, const ModelDefinition& model,
                     const Reference& reference, const MaskOptions& options)
    : Residuals(std::move(samples), model, reference, std::vector<Mask>()) {
  set_mask(masks_at(parameters().data(), options));
}

Residuals::Residuals(std::shared_ptr<const FlightSamples> samples, const ModelDefinition& model,
                     const Reference& reference, std::vector<Mask> mask)
    : samples_(std::move(samples)),
      model_(std::make_unique<ModelOnSamples>(model, samples_->model)),
      reference_(reference.on(*samples_, *model_)),
      parameters_(model_->parameters()),
      linear_terms_(model_->linear_terms()),
      linear_(linear_terms_.size(), !model_->chain().has_minimum()),
      mask_(std::move(mask)) {
  if (const ModelOnSamples* const other = reference_->model()) {
    parameters_.insert(parameters_.end(), other->parameters().begin(), other->parameters().end());
    const std::vector<bool> more = other->linear_terms();
    linear_terms_.insert(linear_terms_.end(), more.begin(), more.end());
    linear_.resize(linear_terms_.size(), !other->chain().has_minimum());
  }
  if (!reference.is_static_pressure()) linear_terms_.assign(linear_terms_.size(), false);
  std::transform(linear_terms_.begin(), linear_terms_.end(), linear_.begin(), linear_.begin(),
                 std::logical_and<>());
}

Residuals::Residuals(Residuals&&) noexcept = default;
Residuals& Residuals::operator=(Residuals&&) noexcept = default;
Residuals::~Residuals() = default;

std::vector<Mask> Residuals::masks_at(const double* parameters, const MaskOptions& options) const {
  return find_masks(samples(), *model_, *reference_, values(parameters), options);
}

std::array<std::size_t, mask_count> Residuals::mask_counts() const {
  std::array<std::size_t, mask_count> counts{};
  for (const Mask mask : mask_) ++counts[static_cast<std::size_t>(mask)];
  return counts;
}

std::vector<double> Residuals::values(const double* parameters) const {
  std::vector<double> result(size());
  std::vector<std::size_t> all(size());
  std::iota(all.begin(), all.end(), 0);
  ModelSamples store;
  const std::vector<Batch::Input> inputs = columns_at(parameters, *model_, *samples_, store);
  reference_->residuals({inputs, reference_->columns(), all}, parameters, result.data());
  return result;
}

void Residuals::evaluate(const std::vector<std::size_t>& samples, const double* parameters,
                         const std::vector<std::size_t>& requested, double* residual,
                         double* derivatives) const {
  const std::size_t count = samples.size();
  std::vector<double> store;
  std::vector<double> reference_store;
  const std::vector<Batch::Input> inputs = model_->gathered(samples, parameters, store);
  const std::vector<Batch::Input> reference_inputs =
      gathered(reference_->columns(), samples, reference_store);
  reference_->residuals({inputs, reference_inputs, samples}, parameters, residual);

  const std::size_t of_model = model_->parameters().size();
  std::vector<ColumnOfParameter> curved;
  std::vector<Batch::Derivative> by_model;
  std::vector<Batch::Derivative> by_reference;
  for (std::size_t k = 0; k < requested.size(); ++k) {
    double* const column = derivatives + k * count;
    if (!linear_terms_[requested[k]]) {
      curved.push_back({requested[k], column});
    } else if (requested[k] < of_model) {
      by_model.push_back(model_->derivative_by(requested[k], column));
    } else {
      by_reference.push_back(reference_->model()->derivative_by(requested[k] - of_model, column));
    }
  }
  if (!by_model.empty()) model_->batch().differentiate(inputs, by_model, count, parameters);
  for (const Batch::Derivative& each : by_model) {
    for (std::size_t i = 0; i < count; ++i) each.values[i] = -each.values[i];
  }
  if (!by_reference.empty()) {
    reference_->model()->batch().differentiate(reference_inputs, by_reference, count, parameters + of_model);
  }
  differentiate(count, {parameters, parameters + parameters_.size()}, curved,
                [&](const Jet* dual, Jet* out) { reference_->residuals(samples, dual, out); });
}

void Residuals::evaluate_at_sensor(const std::vector<std::size_t>& samples, const double* parameters,
                                   const std::vector<std::size_t>& requested, double* residual,
                                   double* derivatives) const {
  const LamsOnSamples* const laser = reference_->laser();
  if (laser == nullptr) return evaluate(samples, parameters, requested, residual, derivatives);
  const std::size_t count = samples.size();
  const std::vector<double>& recorded = *samples_->model.find(Quantity::lams_airspeed);
  const std::vector<double>& sensitivity = laser->sensitivity();
  for (std::size_t i = 0; i < count; ++i) {
    const double predicted = laser->predicted_at(samples[i], parameters);
    residual[i] = sensitivity[samples[i]] * (recorded[samples[i]] - predicted);
  }
  // The reading depends on the coefficients of linear terms through delta-p alone.
  const std::vector<bool> terms = model_->linear_terms();
  std::vector<ColumnOfParameter> curved;
  std::vector<Batch::Derivative> by_defect;
  for (std::size_t k = 0; k < requested.size(); ++k) {
    double* const column = derivatives + k * count;
    if (requested[k] < terms.size() && terms[requested[k]])
      by_defect.push_back(model_->derivative_by(requested[k], column));
    else
      curved.push_back({requested[k], column});
  }
  if (!by_defect.empty()) {
    std::vector<double> store;
    model_->batch().differentiate(model_->gathered(samples, parameters, store), by_defect, count, parameters);
    const std::vector<Jet> constant(parameters, parameters + terms.size());
    for (std::size_t i = 0; i < count; ++i) {
      const double slope = laser->predicted_at(samples[i], constant.data(), Jet(0.0, 0)).v[0];
      for (const Batch::Derivative& each : by_defect) each.values[i] *= slope;
    }
  }
  differentiate(count, {parameters, parameters + parameters_.size()}, curved, [&](const Jet* dual, Jet* out) {
    for (std::size_t i = 0; i < count; ++i) out[i] = laser->predicted_at(samples[i], dual);
  });
  for (std::size_t k = 0; k < requested.size(); ++k) {
    for (std::size_t i = 0; i < count; ++i) derivatives[k * count + i] *= -sensitivity[samples[i]];
  }
}

std::size_t Residuals::half_width() const { return reference_->half_width(); }

void Residuals::differentiate_along(const std::vector<std::size_t>& samples, const double* parameters,
                                    const std::vector<Direction>& directions, double* derivatives) const {
  reference_->differentiate_along(samples, parameters, directions, derivatives);
}

std::optional<std::pair<Quantity, std::vector<double>>> Residuals::predicted_sensor(
    const double* parameters) const {
  const LamsOnSamples* const laser = reference_->laser();
  if (laser == nullptr) return std::nullopt;
  std::vector<double> values;
  for (std::size_t i = 0; i < size(); ++i) values.push_back(laser->predicted_at(i, parameters));
  return std::pair(Quantity::lams_airspeed, std::move(values));
}

std::shared_ptr<const FlightSamples> Residuals::at_common_pressures() const {
  if (reference_->model() == nullptr) return nullptr;
  auto result = std::make_shared<FlightSamples>(*samples_);
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
  std::vector<double> result(size(), nan);
  if (!model_->batch().finds(quantity)) return result;
  ModelSamples store;
  const std::vector<Batch::Input> inputs = columns_at(parameters, *model_, *samples_, store);
  model_->batch().run(inputs, {{quantity, result.data()}}, size(), parameters);
  return result;
}

}  // namespace pcor

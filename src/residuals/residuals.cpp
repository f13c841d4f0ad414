#include <pcor/residuals/residuals.hpp>

#include <algorithm>
#include <mutex>
#include <numeric>
#include <utility>

#include "numerics/missing.hpp"
#include "residuals/masks.hpp"
#include "residuals/model_on_samples.hpp"
#include "residuals/moving_columns.hpp"
#include "residuals/predicted_pressures.hpp"
#include "residuals/reference_on_samples.hpp"

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
  std::vector<bool> linear;
  std::vector<Mask> mask;

  /// Derivative of the residual with respect to the reference's sensor, if it has one; computed on first use.
  const std::vector<double>& sensitivity() const {
    std::call_once(found_, [this] { sensitivity_ = reference->sensor()->sensitivity(); });
    return sensitivity_;
  }

  Implementation(std::shared_ptr<const FlightSamples> flight, const ModelDefinition& of,
                 const Reference& compared_with)
      : samples(std::move(flight)),
        model(of, samples->model),
        reference(compared_with.on(*samples, model)),
        reference_columns(reference->columns()),
        parameters(model.parameters()),
        linear(model.linear()) {
    if (!compared_with.is_static_pressure()) linear.assign(linear.size(), false);
    if (const ModelOnSamples* const other = reference->model()) {
      parameters.insert(parameters.end(), other->parameters().begin(), other->parameters().end());
      std::vector<bool> more = other->linear();
      if (!compared_with.is_static_pressure()) more.assign(more.size(), false);
      linear.insert(linear.end(), more.begin(), more.end());
    }
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
  return find_masks({samples(), impl.model, *impl.reference, values(parameters)}, options);
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
  const ColumnsAt columns(impl.model, *impl.samples, parameters);
  impl.reference->residuals({columns.inputs(), impl.reference_columns, all.data(), size()}, parameters,
                            result.data());
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
  std::vector<LinearColumn> by_model;
  std::vector<LinearColumn> by_reference;
  for (std::size_t k = 0; k < requested.size(); ++k) {
    double* const column = derivatives + k * count;
    if (!impl.linear[requested[k]]) {
      curved.push_back(k);
    } else if (requested[k] < of_model) {
      by_model.push_back({requested[k], column});
    } else {
      by_reference.push_back({requested[k] - of_model, column});
    }
  }
  impl.model.differentiate_linear(inputs, count, parameters, by_model);
  for (const LinearColumn& each : by_model) {
    for (std::size_t i = 0; i < count; ++i) each.derivatives[i] = -each.derivatives[i];
  }
  if (!by_reference.empty()) {
    impl.reference->model()->differentiate_linear(reference_inputs, count, parameters + of_model,
                                                  by_reference);
  }
  differentiate(count, {parameters, parameters + impl.parameters.size()}, requested, curved, derivatives,
                [&](const Jet* dual, Jet* out) { impl.reference->residuals(samples, count, dual, out); });
}

void Residuals::evaluate_at_sensor(const std::size_t* samples, std::size_t count, const double* parameters,
                                   const std::vector<std::size_t>& requested, double* residual,
                                   double* derivatives) const {
  const Implementation& impl = *implementation_;
  const NoisySensor* const sensor = impl.reference->sensor();
  if (sensor == nullptr) return evaluate(samples, count, parameters, requested, residual, derivatives);
  const std::vector<double>& recorded = *impl.samples->model.find(sensor->quantity());
  const std::vector<double>& sensitivity = impl.sensitivity();
  sensor->predict(samples, count, parameters, residual);
  for (std::size_t i = 0; i < count; ++i)
    residual[i] = sensitivity[samples[i]] * (recorded[samples[i]] - residual[i]);
  // In some coefficients delta-p is linear, and the reading depends on them through delta-p alone.
  const std::vector<bool> linear = impl.model.linear();
  std::vector<std::size_t> curved;  // indices in `requested`
  std::vector<LinearColumn> by_defect;
  for (std::size_t k = 0; k < requested.size(); ++k) {
    if (requested[k] < linear.size() && linear[requested[k]])
      by_defect.push_back({requested[k], derivatives + k * count});
    else
      curved.push_back(k);
  }
  if (!by_defect.empty()) {
    std::vector<double> store;
    impl.model.differentiate_linear(impl.model.gathered(samples, count, parameters, store), count, parameters,
                                    by_defect);
    std::vector<double> slope(count);
    sensor->differentiate_by_defect(samples, count, parameters, slope.data());
    for (const LinearColumn& each : by_defect) {
      for (std::size_t i = 0; i < count; ++i) each.derivatives[i] *= slope[i];
    }
  }
  differentiate(count, {parameters, parameters + impl.parameters.size()}, requested, curved, derivatives,
                [&](const Jet* dual, Jet* out) { sensor->predict(samples, count, dual, out); });
  for (std::size_t k = 0; k < requested.size(); ++k) {
    for (std::size_t i = 0; i < count; ++i) derivatives[k * count + i] *= -sensitivity[samples[i]];
  }
}

std::size_t Residuals::reach() const {
  const Neighbours* const neighbours = implementation_->reference->neighbours();
  return neighbours == nullptr ? 0 : neighbours->reach();
}

void Residuals::differentiate_along(const std::size_t* samples, std::size_t count, const double* parameters,
                                    const std::vector<Direction>& directions, double* derivatives) const {
  implementation_->reference->neighbours()->differentiate(samples, count, parameters, directions,
                                                          derivatives);
}

std::optional<std::pair<Quantity, std::vector<double>>> Residuals::predicted_sensor(
    const double* parameters) const {
  const NoisySensor* const sensor = implementation_->reference->sensor();
  if (sensor == nullptr) return std::nullopt;
  std::vector<std::size_t> all(size());
  std::iota(all.begin(), all.end(), 0);
  std::vector<double> values(size());
  sensor->predict(all.data(), size(), parameters, values.data());
  return std::pair(sensor->quantity(), std::move(values));
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
  const ColumnsAt columns(impl.model, *impl.samples, parameters);
  impl.model.batch().run(columns.inputs(), {{quantity, result.data()}}, size(), parameters);
  return result;
}

}  // namespace pcor

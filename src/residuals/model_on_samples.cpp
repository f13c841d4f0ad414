#include "residuals/model_on_samples.hpp"

#include <algorithm>
#include <iterator>

namespace pcor {
namespace {

std::vector<Quantity> roles_of(const ModelDefinition& file, const ModelSamples& samples) {
  std::vector<Quantity> roles;
  std::copy_if(samples.roles.begin(), samples.roles.end(), std::back_inserter(roles),
               [&](Quantity quantity) { return !is_role(quantity) || file.variables.count(quantity) != 0; });
  return roles;
}

}  // namespace

std::vector<Batch::Input> internal::gathered(const std::vector<Batch::Input>& columns,
                                             const std::vector<std::size_t>& samples,
                                             std::vector<double>& store) {
  store.resize(columns.size() * samples.size());
  std::vector<Batch::Input> inputs;
  double* to = store.data();
  for (const Batch::Input& column : columns) {
    inputs.push_back({column.quantity, to});
    for (const std::size_t sample : samples) *to++ = column.values[sample];
  }
  return inputs;
}

ModelOnSamples::ModelOnSamples(const ModelDefinition& file, const ModelSamples& samples)
    : model_(file.model), batch_(file.model, roles_of(file, samples)) {
  for (const Quantity input : chain().inputs()) columns_.push_back({input, samples.find(input)->data()});
  for (const ParameterDependentColumn& column : samples.parameter_dependent) {
    std::size_t first = 0;
    for (const ModelEffect& effect : model_.effects) {
      if (effect.id == column.effect) dependences_.push_back({&column, first + column.parameter});
      first += effect.parameters.size();
    }
  }
}

std::vector<Batch::Input> ModelOnSamples::gathered(const std::vector<std::size_t>& samples,
                                                   const double* parameters,
                                                   std::vector<double>& store) const {
  const std::size_t count = samples.size();
  std::vector<Batch::Input> inputs = internal::gathered(columns_, samples, store);
  for (const ParameterDependence& each : dependences_) {
    const double change = parameters[each.parameter] - each.column->at;
    for (std::size_t c = 0; c < columns_.size(); ++c) {
      if (columns_[c].quantity != each.column->quantity) continue;
      for (std::size_t i = 0; i < count; ++i) store[c * count + i] += each.column->slope[samples[i]] * change;
    }
  }
  return inputs;
}

bool ModelOnSamples::matches_parameters(const double* parameters) const {
  return std::all_of(dependences_.begin(), dependences_.end(), [parameters](const ParameterDependence& each) {
    return parameters[each.parameter] == each.column->at;
  });
}

std::vector<double> ModelOnSamples::parameters_of_columns() const {
  std::vector<double> values = parameters();
  for (const ParameterDependence& each : dependences_) values[each.parameter] = each.column->at;
  return values;
}

std::vector<bool> ModelOnSamples::linear_terms() const {
  std::vector<bool> linear;
  for (std::size_t effect = 0; effect < chain().effect_count(); ++effect) {
    for (std::size_t p = 0; p < chain().parameter_count_of(effect); ++p)
      linear.push_back(chain().is_static_sum_linear(effect, p));
  }
  linear.resize(parameters().size(), false);
  return linear;
}

void ModelOnSamples::port_pressure_plus(Quantity added, const std::vector<Batch::Input>& inputs,
                                        std::size_t count, const double* parameters, double* out) const {
  std::vector<double> other(count);
  batch_.run(inputs, {{Quantity::port_static_pressure, out}, {added, other.data()}}, count, parameters);
  for (std::size_t i = 0; i < count; ++i) out[i] += other[i];
}

Batch::Derivative ModelOnSamples::derivative_by(std::size_t parameter, double* values) const {
  std::size_t effect = chain().effect_count() - 1;
  while (chain().first_parameter_of(effect) > parameter) --effect;
  return {effect, parameter - chain().first_parameter_of(effect), values};
}

bool ModelOnSamples::is_missing_needed(std::size_t sample) const {
  return std::any_of(columns_.begin(), columns_.end(), [&](const Batch::Input& column) {
    return chain().needs(column.quantity) && std::isnan(column.values[sample]);
  });
}

bool ModelOnSamples::is_missing_any(std::size_t sample) const {
  return std::any_of(columns_.begin(), columns_.end(),
                     [&](const Batch::Input& column) { return std::isnan(column.values[sample]); });
}

}  // namespace pcor

#include "residuals/parameter_dependent_columns.hpp"

#include <algorithm>
#include <cmath>

#include <pcor/effects/catalogue.hpp>
#include <pcor/realtime/wetness.hpp>
#include "roles/fast_series.hpp"

namespace pcor::internal {

Memory memory_of(const ModelEffect& effect) {
  const EffectInfo* const info = effect_named(effect.id);
  return info != nullptr ? info->memory : Memory{};
}

std::vector<double> airspeed_along_beam(const ModelDefinition& model, const ModelSamples& samples,
                                        const double* parameters) {
  const ModelOnSamples law(model, samples);
  if (parameters == nullptr) parameters = law.parameters().data();
  std::vector<double> speed(samples.find(Quantity::static_pressure)->size());
  for (std::size_t i = 0; i < speed.size(); ++i) speed[i] = law.airspeed_along_beam(i, parameters);
  return speed;
}

std::vector<double> history_input(Quantity quantity, const ModelSamples& samples,
                                  const std::vector<double>& time, double step, double seconds) {
  if (quantity == Quantity::wetness) {
    const std::vector<double>* const water = samples.find(Quantity::liquid_water);
    if (water == nullptr) return {};
    Wetness wetness(1.0 / step, std::max(0.0, seconds));
    std::vector<double> values(water->size());
    for (std::size_t i = 0; i < values.size(); ++i) {
      const double since_last = i > 0 ? time[i] - time[i - 1] : step;
      if (since_last > 1.5 * step) wetness.reset();  // a gap, the same as in the sample loop
      values[i] = wetness((*water)[i], since_last > 1.5 * step ? step : since_last);
    }
    return values;
  }
  const FastSeries& speed = samples.along_beam;
  if (speed.values.empty()) return {};
  return rate_of(speed, time, step, speed.min_period, seconds);
}

void find_parameter_dependent_columns(const Model& model, const double* parameters,
                                      const std::vector<double>& time, double step, ModelSamples& samples) {
  constexpr double little = 0.05;  // s
  std::size_t first = 0;
  for (const ModelEffect& effect : model.effects) {
    const Memory memory = memory_of(effect);
    const std::size_t position = first + memory.parameter;
    first += effect.parameters.size();
    if (memory.of == Quantity::count) continue;
    std::vector<double>* const column = samples.find(memory.of);
    if (column == nullptr) continue;
    auto dependent =
        std::find_if(samples.parameter_dependent.begin(), samples.parameter_dependent.end(),
                     [&](const ParameterDependentColumn& each) { return each.quantity == memory.of; });
    if (dependent == samples.parameter_dependent.end())
      dependent = samples.parameter_dependent.insert(
          dependent, {memory.of, effect.id, memory.parameter, 0.0, std::vector<double>(column->size(), 0.0)});
    const double at = parameters[position];
    const auto over = [&](double seconds) { return history_input(memory.of, samples, time, step, seconds); };
    std::vector<double> values = over(at);
    if (memory.of == Quantity::airspeed_rate) {
      // A fit needs the same samples at every delay: next to a gap, without an earlier value, the derivative
      // is used.
      const std::vector<double> derivative = over(0.0);
      for (std::size_t i = 0; i < values.size(); ++i) {
        if (std::isnan(values[i])) values[i] = derivative[i];
      }
    }
    const std::vector<double> above = over(at + little);
    const double lower = memory.of == Quantity::wetness ? std::max(0.0, at - little) : at - little;
    const std::vector<double> below = over(lower);
    dependent->at = at;
    for (std::size_t i = 0; i < values.size(); ++i) {
      const double slope = (above[i] - below[i]) / (at + little - lower);
      dependent->slope[i] = std::isfinite(slope) ? slope : 0.0;  // next to a gap
    }
    // In place: readers of the column keep its address.
    std::copy(values.begin(), values.end(), column->begin());
  }
}

std::vector<Batch::Input> columns_at(const double* parameters, const ModelOnSamples& model,
                                     const FlightSamples& samples, ModelSamples& store) {
  std::vector<Batch::Input> inputs = model.columns();
  if (model.matches_parameters(parameters)) return inputs;
  store = samples.model;
  find_parameter_dependent_columns(model.model(), parameters, samples.time, samples.step, store);
  for (Batch::Input& input : inputs) input.values = store.find(input.quantity)->data();
  return inputs;
}

}  // namespace pcor::internal

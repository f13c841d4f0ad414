#include "residuals/moving_columns.hpp"

#include <algorithm>
#include <cmath>

#include <pcor/effects/catalogue.hpp>

#include "residuals/model_on_samples.hpp"
#include "residuals/rate_of_series.hpp"

namespace pcor::internal {
Memory memory_of(const ModelEffect& effect) {
  const std::size_t known = effect_named(effect.id);
  return known < catalogue_size ? effect_facts[known].memory : Memory{};
}

std::vector<double> airspeed_along_beam(const ModelFile& model, const ModelSamples& samples,
                                        const double* parameters) {
  const ModelOnSamples law(model, samples);
  if (parameters == nullptr) parameters = law.parameters().data();
  std::vector<double> speed(samples.find(Quantity::static_pressure)->size());
  for (std::size_t i = 0; i < speed.size(); ++i) speed[i] = law.airspeed_along_beam(i, parameters);
  return speed;
}

void find_moving_columns(const ModelFile& model, const double* parameters, const std::vector<double>& time,
                         double step, ModelSamples& samples) {
  constexpr double little = 0.05;  // s
  std::size_t first = 0;
  for (const ModelEffect& effect : model.model.effects) {
    const Memory memory = memory_of(effect);
    const std::size_t place = first + memory.parameter;
    first += effect.parameters.size();
    if (memory.of == Quantity::count) continue;
    const auto column = std::find_if(samples.columns.begin(), samples.columns.end(),
                                     [&](const auto& each) { return each.first == memory.of; });
    if (column == samples.columns.end()) continue;
    auto moving = std::find_if(samples.moving.begin(), samples.moving.end(),
                               [&](const MovingColumn& each) { return each.quantity == memory.of; });
    if (moving == samples.moving.end())
      moving = samples.moving.insert(moving, {memory.of, effect.id, memory.parameter, 0.0,
                                              std::vector<double>(column->second.size(), 0.0)});
    const double at = parameters[place];
    const FastSeries& speed = samples.along_beam;
    const double period = speed.shortest_period;
    // A fit needs the same samples at every delay: where nothing is known of so long before, beside a gap,
    // the derivative stands in.
    const std::vector<double> derivative = rate_of(speed, time, step, period);
    std::vector<double> rate = rate_of(speed, time, step, period, at);
    for (std::size_t i = 0; i < rate.size(); ++i) {
      if (std::isnan(rate[i])) rate[i] = derivative[i];
    }
    const std::vector<double> above = rate_of(speed, time, step, period, at + little);
    const std::vector<double> below = rate_of(speed, time, step, period, at - little);
    moving->at = at;
    for (std::size_t i = 0; i < rate.size(); ++i) {
      const double slope = (above[i] - below[i]) / (2.0 * little);
      moving->slope[i] = std::isfinite(slope) ? slope : 0.0;  // beside a gap
    }
    // In place: what reads the column keeps its address.
    std::copy(rate.begin(), rate.end(), column->second.begin());
  }
}

}  // namespace pcor::internal

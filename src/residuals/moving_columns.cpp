#include "residuals/moving_columns.hpp"

#include <algorithm>
#include <cmath>

#include <pcor/effects/catalogue.hpp>
#include <pcor/numerics/noise.hpp>
#include <pcor/realtime/rate_filter.hpp>

#include "numerics/missing.hpp"
#include "residuals/model_on_samples.hpp"

namespace pcor::internal {
namespace {

/// The mean square of values, those beyond six robust deviations counted as if they were there.
double clipped_variance(const std::vector<double>& values) {
  std::vector<double> known;
  for (const double value : values) {
    if (std::isfinite(value)) known.push_back(value);
  }
  if (known.empty()) return 0.0;
  const double limit = 6.0 * robust_deviation(known);
  double sum = 0.0;
  for (const double value : known) sum += std::min(value * value, limit * limit);
  return sum / static_cast<double>(known.size());
}

}  // namespace

Memory memory_of(const ModelEffect& effect) {
  const std::size_t known = effect_named(effect.id);
  return known < catalogue_size ? effect_facts[known].memory : Memory{};
}

std::vector<double> mean_rate(const std::vector<double>& values, const std::vector<double>& time, double step,
                              double shortest_period, double seconds) {
  const RateFilter filter(1.0 / step, seconds, shortest_period);
  std::vector<double> rate(values.size(), nan);
  for (std::size_t first = 0; first < values.size();) {
    std::size_t end = first + 1;
    while (end < values.size() && time[end] - time[end - 1] <= 1.25 * step) ++end;
    for (std::size_t i = first; i < end; ++i) rate[i] = filter(values.data() + i, i - first, end - 1 - i);
    first = end;
  }
  return rate;
}

double shortest_period_of(const std::vector<double>& values, const std::vector<double>& time, double step) {
  constexpr std::size_t bands = 11;
  constexpr double half_octave = 1.4142135623730951;
  constexpr double flat = 1.3;
  std::vector<double> periods;
  std::vector<double> variance;
  std::vector<double> gain;  // of white noise
  for (std::size_t k = 0; k < bands; ++k) {
    periods.push_back(std::max(RateFilter::usual_period, 2.0 * step) *
                      std::pow(half_octave, static_cast<double>(k)));
    const std::vector<double> rate = mean_rate(values, time, step, periods.back());
    variance.push_back(clipped_variance(rate));
    gain.push_back(RateFilter(1.0 / step, 0.0, periods.back()).gain());
  }
  // The power of each band, as if it were white noise.
  std::vector<double> power;
  for (std::size_t k = 0; k + 1 < bands; ++k)
    power.push_back((variance[k] - variance[k + 1]) / (gain[k] - gain[k + 1]));
  // Where the spectrum still falls at its end, noise is below all of it.
  const double noise = power[1] < flat * power[0] ? power[0] : 0.5 * power[0];
  std::size_t k = 0;
  while (k + 1 < power.size() && power[k] < 2.0 * noise) ++k;
  return periods[k];
}

std::vector<double> airspeed_along_beam(const ModelFile& model, const ModelSamples& samples,
                                        const double* parameters) {
  const ModelOnSamples law(model, samples);
  if (parameters == nullptr) parameters = law.parameters().data();
  std::vector<double> speed(samples.find(Quantity::static_pressure)->size());
  for (std::size_t i = 0; i < speed.size(); ++i) {
    State<double> state;
    law.air(i, parameters, state);
    speed[i] = state[Quantity::corrected_airspeed];
    if (law.chain().has_lams()) speed[i] *= law.chain().cosine_of_beam(state, parameters);
  }
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
    const std::vector<double> airspeed = airspeed_along_beam(model, samples, parameters);
    const double period = shortest_period_of(airspeed, time, step);
    const std::vector<double> rate = mean_rate(airspeed, time, step, period, at);
    const std::vector<double> above = mean_rate(airspeed, time, step, period, at + little);
    const std::vector<double> below = mean_rate(airspeed, time, step, period, at - little);
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

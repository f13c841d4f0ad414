#include <benchmark/benchmark.h>

#include <optional>
#include <string>

#include <pcor/realtime/chain.hpp>
#include "flight.hpp"

namespace pcor::benchmarks {
namespace {

/// Delta-p of one sample from a model with one effect.
void static_defect(benchmark::State& timing, const ModelEffect& effect) {
  Model model;
  model.effects = {effect};
  BindingError error;
  const std::optional<Chain> chain = Chain::build(model, recorded_roles(), &error);
  if (!chain) return timing.SkipWithError(error.message().c_str());
  State<double> state;
  state[Quantity::static_pressure] = 250.0;
  state[Quantity::dynamic_pressure] = 120.0;
  state[Quantity::mach] = 0.78;
  QualityFlags flags;
  for (auto _ : timing) {
    benchmark::DoNotOptimize(state);
    benchmark::DoNotOptimize(chain->static_defect(state, chain->parameters().data(), flags));
  }
}

void catalogue_effect(benchmark::State& timing) { static_defect(timing, {"static-mach3", {-0.087508}}); }
BENCHMARK(catalogue_effect);

void formula_effect(benchmark::State& timing) {
  ModelEffect effect;
  effect.id = "mach-cubed";
  effect.parameters = {-0.087508};
  effect.parameter_names = {"m3"};
  effect.formula = "m3 * mach^3 * static_pressure";
  static_defect(timing, effect);
}
BENCHMARK(formula_effect);

}  // namespace
}  // namespace pcor::benchmarks

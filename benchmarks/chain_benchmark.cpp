#include <benchmark/benchmark.h>

#include <string>

#include <pcor/realtime/loop.hpp>
#include "flight.hpp"
#include "nimbus_model.hpp"

namespace pcor::benchmarks {
namespace {

constexpr std::size_t flight_samples = 4500;

/// Six variables in the style of nimbus: a table of functions, each of which repeats the calculation.
void chain_nimbus_model(benchmark::State& timing) {
  const Flight flight = make_flight(flight_samples);
  const std::vector<nimbus_model::Derivation> chain = nimbus_model::chain();
  nimbus_model::Sample sample{};
  std::size_t i = 0;
  for (auto _ : timing) {
    sample[nimbus_model::PSX] = flight.static_pressure[i];
    sample[nimbus_model::QCX] = flight.dynamic_pressure[i];
    sample[nimbus_model::TTX] = flight.recovery_temperature[i];
    sample[nimbus_model::EWX] = flight.vapor_pressure[i];
    sample[nimbus_model::AKRD] = flight.attack[i];
    for (const nimbus_model::Derivation& derivation : chain) derivation.compute(derivation, sample);
    benchmark::DoNotOptimize(sample);
    i = i + 1 == flight.size() ? 0 : i + 1;
  }
}
BENCHMARK(chain_nimbus_model);

/// The same variables from the sample loop, with delta-p and quality bits.
void run_loop(benchmark::State& timing, const Model& model, const std::vector<Quantity>& recorded,
              const ModelUncertainty& uncertainty) {
  const Flight flight = make_flight(flight_samples);
  std::string error;
  std::optional<Loop> loop = Loop::build(model, recorded, 25.0, &error, CorrectWith::model, uncertainty);
  if (!loop) return timing.SkipWithError(error.c_str());
  std::size_t i = 0;
  double time = 0.0;
  for (auto _ : timing) {
    State<double>& state = loop->state();
    state[Quantity::static_pressure] = flight.static_pressure[i];
    state[Quantity::dynamic_pressure] = flight.dynamic_pressure[i];
    state[Quantity::recovery_temperature] = flight.recovery_temperature[i];
    state[Quantity::vapor_pressure] = flight.vapor_pressure[i];
    state[Quantity::attack] = flight.attack[i];
    state[Quantity::radome_dynamic_pressure] = flight.dynamic_pressure[i];
    state[Quantity::attack_differential_pressure] = -0.2 * flight.dynamic_pressure[i];
    loop->run(time);
    benchmark::DoNotOptimize(state);
    time += 0.04;
    i = i + 1 == flight.size() ? 0 : i + 1;
  }
}

/// Correlated uncertainties of all coefficients, and noise of the pressures and the thermometer.
ModelUncertainty uncertainty_of(const Model& model) {
  const std::size_t count = model.effects.size();
  ModelUncertainty uncertainty;
  for (std::size_t i = 0; i < count; ++i) {
    for (std::size_t j = 0; j < count; ++j) uncertainty.covariance.push_back(i == j ? 1e-8 : 5e-9);
  }
  uncertainty.random[index(Quantity::static_pressure)] = 0.05;
  uncertainty.random[index(Quantity::dynamic_pressure)] = 0.03;
  uncertainty.random[index(Quantity::recovery_temperature)] = 0.1;
  uncertainty.static_defect = 0.1;
  return uncertainty;
}

std::vector<Quantity> c130_roles() {
  return {Quantity::static_pressure,         Quantity::dynamic_pressure,
          Quantity::recovery_temperature,    Quantity::vapor_pressure,
          Quantity::radome_dynamic_pressure, Quantity::attack_differential_pressure};
}

/// Equation 18 of Cooper (2012) for the C-130.
Model equation_18() {
  Model model;
  model.effects = {
      {"static-constant", {0.004127875}}, {"static-alpha", {0.021279816}}, {"static-qp", {0.030849643}}};
  model.recovery = {{0.95, 0.0, 0.0, 0.0}};
  return model;
}

void chain_scalar(benchmark::State& timing) { run_loop(timing, gv_2014(), recorded_roles(), {}); }
BENCHMARK(chain_scalar);

void chain_uncertainty(benchmark::State& timing) {
  run_loop(timing, gv_2014(), recorded_roles(), uncertainty_of(gv_2014()));
}
BENCHMARK(chain_uncertainty);

void chain_equation_18(benchmark::State& timing) { run_loop(timing, equation_18(), c130_roles(), {}); }
BENCHMARK(chain_equation_18);

void chain_equation_18_uncertainty(benchmark::State& timing) {
  run_loop(timing, equation_18(), c130_roles(), uncertainty_of(equation_18()));
}
BENCHMARK(chain_equation_18_uncertainty);

}  // namespace
}  // namespace pcor::benchmarks

#include <benchmark/benchmark.h>

#include <string>

#include <pcor/realtime/loop.hpp>
#include "flight.hpp"
#include "nimbus_model.hpp"

namespace pcor::benchmarks {
namespace {

constexpr std::size_t flight_samples = 4500;

/// What the six variables cost in the way of nimbus: a table of functions that each begin anew.
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

/// The same variables by the sample loop, with delta-p and the quality bits.
void chain_scalar(benchmark::State& timing) {
  const Flight flight = make_flight(flight_samples);
  std::string error;
  std::optional<Loop> loop = Loop::build(gv_2014(), recorded_roles(), 25.0, &error);
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
    loop->run(time);
    benchmark::DoNotOptimize(state);
    time += 0.04;
    i = i + 1 == flight.size() ? 0 : i + 1;
  }
}
BENCHMARK(chain_scalar);

}  // namespace
}  // namespace pcor::benchmarks

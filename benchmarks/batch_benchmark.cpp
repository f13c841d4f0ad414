#include <benchmark/benchmark.h>

#include <vector>

#include <pcor/batch/batch.hpp>
#include "flight.hpp"

namespace pcor::benchmarks {
namespace {

/// The same variables for a whole flight in one call. `items_per_second` counts samples.
void chain_batch(benchmark::State& timing) {
  const Flight flight = make_flight(4500);
  const Batch batch(gv_2014(), recorded_roles());
  std::vector<Batch::Output> outputs;
  std::vector<std::vector<double>> values(6, std::vector<double>(flight.size()));
  for (const Quantity quantity :
       {Quantity::corrected_static_pressure, Quantity::corrected_dynamic_pressure, Quantity::corrected_mach,
        Quantity::humidity, Quantity::ambient_temperature, Quantity::corrected_airspeed}) {
    outputs.push_back({quantity, values[outputs.size()].data()});
  }
  const std::vector<Batch::Input> inputs = flight.inputs();
  for (auto _ : timing) {
    batch.run(inputs, outputs, flight.size());
    benchmark::ClobberMemory();
  }
  timing.SetItemsProcessed(static_cast<std::int64_t>(timing.iterations() * flight.size()));
}
BENCHMARK(chain_batch);

}  // namespace
}  // namespace pcor::benchmarks

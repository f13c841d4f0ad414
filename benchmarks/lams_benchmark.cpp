#include <benchmark/benchmark.h>

#include <pcor/physics/lams.hpp>
#include "flight.hpp"

namespace pcor::benchmarks {
namespace {

/// Runs `solve`, a method for delta-p from LAMS, on one sample at a time.
template <class Solve>
void lams(benchmark::State& timing, const Solve& solve) {
  const Flight flight = make_flight(4500);
  const RecoveryFactor recovery = gv_2014().recovery;
  std::size_t i = 0;
  for (auto _ : timing) {
    const LamsSolution<double> solution =
        solve(flight.static_pressure[i], flight.dynamic_pressure[i], flight.lams_airspeed[i],
              flight.recovery_temperature[i], flight.vapor_pressure[i], recovery);
    benchmark::DoNotOptimize(solution);
    i = i + 1 == flight.size() ? 0 : i + 1;
  }
}

void lams_approach_1(benchmark::State& timing) {
  lams(timing, [](auto... inputs) { return lams_simultaneous(inputs...); });
}
BENCHMARK(lams_approach_1);

void lams_approach_2(benchmark::State& timing) {
  lams(timing, [](auto... inputs) { return lams_iterated(inputs..., 1e-6); });
}
BENCHMARK(lams_approach_2);

}  // namespace
}  // namespace pcor::benchmarks

#include <benchmark/benchmark.h>

#include <array>
#include <string>
#include <vector>

#include <pcor/realtime/nimbus.hpp>
#include "flight.hpp"
#include "nimbus_model.hpp"

namespace pcor::benchmarks {
namespace {

nimbus_model::Sample sample{};

struct Entry {
  void (*compute)(Entry*);
  std::vector<std::size_t> inputs;
  std::size_t output;
};

struct Host {
  using Entry = benchmarks::Entry;
  static double get(Entry* entry, std::size_t input) { return sample[entry->inputs[input]]; }
  static void put(Entry* entry, double value) { sample[entry->output] = value; }
  static bool high_rate() { return true; }
};

using System = NimbusSystem<Host, struct Tag>;

/// The same variables from a table of callbacks: the first computes delta-p and all six, the others fetch
/// them.
void chain_adapter(benchmark::State& timing) {
  using namespace nimbus_model;
  const Flight flight = make_flight(4500);
  std::string error;
  if (!System::install(
          gv_2014(),
          {"static_pressure", "dynamic_pressure", "recovery_temperature", "vapor_pressure", "attack"}, 1.0,
          25.0, &error)) {
    return timing.SkipWithError(error.c_str());
  }
  std::vector<Entry> table{{System::compute, {PSX, QCX, TTX, EWX, AKRD}, PCOR},
                           {System::fetch<Quantity::corrected_static_pressure>, {PCOR}, PSXC},
                           {System::fetch<Quantity::corrected_dynamic_pressure>, {PCOR}, QCXC},
                           {System::fetch<Quantity::corrected_mach>, {PCOR}, MACHX},
                           {System::fetch<Quantity::humidity>, {PCOR}, TASFLG},
                           {System::fetch<Quantity::ambient_temperature>, {PCOR}, ATX},
                           {System::fetch<Quantity::corrected_airspeed>, {PCOR}, TASX}};
  std::size_t i = 0;
  for (auto _ : timing) {
    sample[PSX] = flight.static_pressure[i];
    sample[QCX] = flight.dynamic_pressure[i];
    sample[TTX] = flight.recovery_temperature[i] - constants::ice_point;
    sample[EWX] = flight.vapor_pressure[i];
    sample[AKRD] = flight.attack[i];
    for (Entry& entry : table) entry.compute(&entry);
    benchmark::DoNotOptimize(sample);
    i = i + 1 == flight.size() ? 0 : i + 1;
  }
}
BENCHMARK(chain_adapter);

}  // namespace
}  // namespace pcor::benchmarks

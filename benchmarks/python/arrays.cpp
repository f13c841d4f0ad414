// Corrects ten million samples with the batch kernels, for benchmarks/python/benchmark: arrays MODEL.toml.
// Prints the minimum time of ten runs, s, first with new output arrays, then with reused ones.
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <limits>
#include <memory>
#include <utility>
#include <vector>

#include <pcor/batch/batch.hpp>
#include <pcor/model_io/model_definition.hpp>

int main(int argc, char** argv) {
  if (argc != 2) return 2;
  constexpr std::size_t samples = 10'000'000;
  using pcor::Quantity;
  const pcor::ModelDefinition model = pcor::read_model(argv[1]);
  std::vector<std::vector<double>> recorded;
  std::vector<pcor::Batch::Input> inputs;
  for (const auto& [quantity, value] :
       {std::pair{Quantity::static_pressure, 700.0}, std::pair{Quantity::dynamic_pressure, 67.6},
        std::pair{Quantity::radome_dynamic_pressure, 67.1},
        std::pair{Quantity::attack_differential_pressure, -21.3},
        std::pair{Quantity::recovery_temperature, 280.0}, std::pair{Quantity::vapor_pressure, 4.2}}) {
    recorded.emplace_back(samples, value);
    inputs.push_back({quantity, recorded.back().data()});
  }
  const pcor::Batch batch(model.model, model.roles());
  const std::vector<Quantity> results{
      Quantity::static_defect,  Quantity::corrected_static_pressure, Quantity::corrected_dynamic_pressure,
      Quantity::corrected_mach, Quantity::ambient_temperature,       Quantity::corrected_airspeed};
  std::vector<std::unique_ptr<double[]>> arrays(results.size());
  for (const bool new_arrays : {true, false}) {
    double minimum = std::numeric_limits<double>::infinity();
    for (int i = 0; i < 10; ++i) {
      const auto begin = std::chrono::steady_clock::now();
      std::vector<pcor::Batch::Output> outputs;
      for (std::size_t k = 0; k < results.size(); ++k) {
        if (new_arrays || arrays[k] == nullptr) arrays[k].reset(new double[samples]);
        outputs.push_back({results[k], arrays[k].get()});
      }
      batch.run(inputs, outputs, samples);
      minimum =
          std::min(minimum, std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count());
    }
    std::printf("%.4f\n", minimum);
  }
}

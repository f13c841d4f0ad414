// Loads a model file and runs it in a sample loop of 25 Hz: model_loop data/models/c130-psfd-eq18.toml
#include <cstdio>
#include <pcor/base/error.hpp>
#include <pcor/model_io/model_definition.hpp>
#include <pcor/realtime/loop.hpp>
#include <string>

int main(int argc, char** argv) try {
  if (argc != 2) return std::fprintf(stderr, "usage: model_loop MODEL.toml\n"), 2;
  const pcor::ModelDefinition file = pcor::read_model(argv[1]);
  std::string error;
  auto loop = pcor::Loop::build(file.model, file.roles(), 25.0, &error, pcor::CorrectWith::model,
                                pcor::uncertainty_of(file));
  if (!loop) throw pcor::Error(pcor::Error::Code::model, error);

  std::printf("%s reads", file.model.name.c_str());
  for (const auto& [role, variable] : file.variables) std::printf(" %s", variable.c_str());
  std::printf("\n");

  using pcor::Quantity;
  for (int sample = 0; sample < 3; ++sample) {
    auto& s = loop->state();
    s[Quantity::static_pressure] = 700.0 - 0.03 * sample;  // hPa
    s[Quantity::dynamic_pressure] = 67.6;                  // hPa
    s[Quantity::radome_dynamic_pressure] = 67.1;           // hPa
    s[Quantity::attack_differential_pressure] = -21.3;     // hPa
    s[Quantity::recovery_temperature] = 280.0;             // K
    s[Quantity::vapor_pressure] = 4.2;                     // hPa
    loop->run(sample / 25.0);
    std::printf("p %.3f +- %.3f hPa, q %.3f hPa, T %.2f K, quality %u\n",
                s[Quantity::corrected_static_pressure], s[Quantity::corrected_static_pressure_uncertainty],
                s[Quantity::corrected_dynamic_pressure], s[Quantity::ambient_temperature],
                loop->quality().bits());
  }
} catch (const pcor::Error& error) {
  return std::fprintf(stderr, "%s\n", error.what()), 1;
}

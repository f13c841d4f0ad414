// Installs a model file in a table of callbacks: nimbus_model data/models/c130-psfd-eq18.toml
#include <cstdio>
#include <map>
#include <pcor/base/error.hpp>
#include <pcor/model_io/model_definition.hpp>
#include <pcor/realtime/nimbus.hpp>
#include <string>
#include <vector>

namespace {

using pcor::Quantity;

std::vector<double> sample;  // the dependencies of PCOR, in their order

// A host whose entries are the values themselves; examples/nimbus has a table.
struct Host {
  using Entry = double;
  static double get(Entry*, std::size_t input) { return sample[input]; }
  static void put(Entry* entry, double value) { *entry = value; }
  static bool high_rate() { return false; }
};

using Fuselage = pcor::NimbusSystem<Host, struct FuselageTag>;

bool install(const pcor::ModelDefinition& file, std::string* error) {
  std::vector<std::string> inputs;
  for (const auto& [role, variable] : file.variables) {
    inputs.emplace_back(pcor::info_of(role).name);
    std::printf("PCOR depends on %s\n", variable.c_str());
  }
  return Fuselage::install(file.model, inputs, 1.0, 25.0, error, pcor::CorrectWith::model,
                           pcor::uncertainty_of(file));
}

}  // namespace

int main(int argc, char** argv) try {
  if (argc != 2) return std::fprintf(stderr, "usage: nimbus_model MODEL.toml\n"), 2;
  const pcor::ModelDefinition file = pcor::read_model(argv[1]);
  std::string error;
  if (!install(file, &error)) throw pcor::Error(pcor::Error::Code::model, error);
  std::map<Quantity, double> air{{Quantity::static_pressure, 700.0},               // hPa
                                 {Quantity::dynamic_pressure, 67.6},               // hPa
                                 {Quantity::radome_dynamic_pressure, 67.1},        // hPa
                                 {Quantity::attack_differential_pressure, -21.3},  // hPa
                                 {Quantity::recovery_temperature, 6.85},           // deg C
                                 {Quantity::vapor_pressure, 4.2}};                 // hPa
  for (const Quantity role : file.roles()) sample.push_back(air.at(role));
  double pcor = 0.0;
  double psxc = 0.0;
  double psxc_uncertainty = 0.0;
  Fuselage::compute(&pcor);
  Fuselage::fetch<Quantity::corrected_static_pressure>(&psxc);
  Fuselage::fetch<Quantity::corrected_static_pressure_uncertainty>(&psxc_uncertainty);
  std::printf("PCOR %.3f hPa, PSXC %.3f +- %.3f hPa\n", pcor, psxc, psxc_uncertainty);
} catch (const std::exception& error) {
  return std::fprintf(stderr, "%s\n", error.what()), 1;
}

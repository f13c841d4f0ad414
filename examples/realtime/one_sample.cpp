#include <cstdio>
#include <pcor/realtime/loop.hpp>

int main() {
  using pcor::Quantity;
  pcor::ModelEffect law{"trailing-cone"};            // model c130-psfrd-2003, for PSFRD and QCFRD
  law.formula = "3.29 + 0.0273 * dynamic_pressure";  // delta-p, hPa
  pcor::Model model;
  model.effects = {law};
  std::string error;
  auto loop = pcor::Loop::build(model, {Quantity::static_pressure, Quantity::dynamic_pressure}, 25.0, &error);
  if (!loop) return std::puts(error.c_str()), 1;
  loop->state()[Quantity::static_pressure] = 700.0;                               // hPa
  loop->state()[Quantity::dynamic_pressure] = 67.6;                               // hPa
  loop->run(0.0);                                                                 // s since the first record
  std::printf("%.2f hPa\n", loop->state()[Quantity::corrected_static_pressure]);  // 705.14 hPa
}

#include <cstdio>
#include <pcor/realtime/loop.hpp>

int main() {
  using pcor::Quantity;
  pcor::Model model;
  model.effects = {{"static-constant", {0.0041}}, {"static-qp", {0.0308}}};
  std::string error;
  auto loop = pcor::Loop::build(model, {Quantity::static_pressure, Quantity::dynamic_pressure}, 25.0, &error);
  if (!loop) return std::puts(error.c_str()), 1;
  loop->state()[Quantity::static_pressure] = 700.0;  // hPa
  loop->state()[Quantity::dynamic_pressure] = 67.6;  // hPa
  loop->run(0.0);                                    // time, s
  std::printf("%.2f hPa\n", loop->state()[Quantity::corrected_static_pressure]);
}

// Equation 18 of Cooper (2012) for the C-130's PSFD and QCF, in a sample loop of 25 Hz.
#include <cstdio>
#include <pcor/realtime/loop.hpp>
#include <string>

int main() {
  using pcor::Quantity;
  pcor::Model model;
  model.effects = {
      {"static-constant", {0.004127875}}, {"static-alpha", {0.021279816}}, {"static-qp", {0.030849643}}};
  model.recovery = {{0.95}};
  std::string error;
  auto loop = pcor::Loop::build(
      model,
      {Quantity::static_pressure, Quantity::dynamic_pressure, Quantity::radome_dynamic_pressure,
       Quantity::attack_differential_pressure, Quantity::recovery_temperature, Quantity::vapor_pressure},
      25.0, &error);
  if (!loop) return std::fprintf(stderr, "%s\n", error.c_str()), 1;
  for (int sample = 0; sample < 3; ++sample) {
    auto& s = loop->state();
    s[Quantity::static_pressure] = 700.0 - 0.03 * sample;  // hPa
    s[Quantity::dynamic_pressure] = 67.6;                  // hPa
    s[Quantity::radome_dynamic_pressure] = 67.1;           // hPa
    s[Quantity::attack_differential_pressure] = -21.3;     // hPa
    s[Quantity::recovery_temperature] = 280.0;             // K
    s[Quantity::vapor_pressure] = 4.2;                     // hPa
    loop->run(sample / 25.0);
    std::printf("p %.3f hPa, q %.3f hPa, M %.4f, T %.2f K, v %.2f m/s, quality %u\n",
                s[Quantity::corrected_static_pressure], s[Quantity::corrected_dynamic_pressure],
                s[Quantity::corrected_mach], s[Quantity::ambient_temperature],
                s[Quantity::corrected_airspeed], loop->quality().bits());
  }
}

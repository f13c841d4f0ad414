// Adds a derived variable of the host to a sample loop: potential temperature, K.
#include <cmath>
#include <cstdio>
#include <memory>
#include <pcor/realtime/loop.hpp>
#include <string>

using pcor::Quantity;

struct PotentialTemperature final : pcor::Functor {
  explicit PotentialTemperature(Quantity theta)
      : Functor({Quantity::corrected_static_pressure, Quantity::ambient_temperature}, {theta}) {}
  void compute(pcor::State<double>& s, pcor::QualityFlags&) noexcept override {
    const double p = s[Quantity::corrected_static_pressure];  // hPa
    s[outputs()[0]] = s[Quantity::ambient_temperature] * std::pow(1000.0 / p, 0.2857);
  }
};

int main() {
  pcor::Model model;  // no effects: delta-p is zero
  model.recovery = {{0.95}};
  std::string error;
  auto loop = pcor::Loop::build(
      model, {Quantity::static_pressure, Quantity::dynamic_pressure, Quantity::recovery_temperature}, 25.0,
      &error);
  if (!loop) return std::fprintf(stderr, "%s\n", error.c_str()), 1;
  const Quantity theta = loop->add_variable("THETA").value();
  loop->add(std::make_unique<PotentialTemperature>(theta));
  if (!loop->order(&error)) return std::fprintf(stderr, "%s\n", error.c_str()), 1;
  auto& s = loop->state();
  s[Quantity::static_pressure] = 700.0;       // hPa
  s[Quantity::dynamic_pressure] = 67.6;       // hPa
  s[Quantity::recovery_temperature] = 280.0;  // K
  loop->run(0.0);
  std::printf("T %.2f K, theta %.2f K\n", s[Quantity::ambient_temperature], s[theta]);
}

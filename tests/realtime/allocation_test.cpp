#include <gmock/gmock.h>

#include <cmath>
#include <cstdlib>
#include <new>

#include <pcor/realtime/loop.hpp>
#include "support/uncertain_in_everything.hpp"

namespace {

std::size_t allocations = 0;
std::size_t releases = 0;

void* take(std::size_t size) {
  ++allocations;
  if (void* const memory = std::malloc(size)) return memory;
  std::abort();
}

void* take(std::size_t size, std::size_t alignment) {
  ++allocations;
  if (void* const memory = std::aligned_alloc(alignment, (size + alignment - 1) / alignment * alignment)) {
    return memory;
  }
  std::abort();
}

void give(void* memory) {
  ++releases;
  std::free(memory);
}

}  // namespace

void* operator new(std::size_t size) { return take(size); }
void* operator new[](std::size_t size) { return take(size); }
void* operator new(std::size_t size, std::align_val_t alignment) {
  return take(size, static_cast<std::size_t>(alignment));
}
void* operator new[](std::size_t size, std::align_val_t alignment) {
  return take(size, static_cast<std::size_t>(alignment));
}
void* operator new(std::size_t size, const std::nothrow_t&) noexcept { return take(size); }
void* operator new[](std::size_t size, const std::nothrow_t&) noexcept { return take(size); }
void operator delete(void* memory) noexcept { give(memory); }
void operator delete[](void* memory) noexcept { give(memory); }
void operator delete(void* memory, std::size_t) noexcept { give(memory); }
void operator delete[](void* memory, std::size_t) noexcept { give(memory); }
void operator delete(void* memory, std::align_val_t) noexcept { give(memory); }
void operator delete[](void* memory, std::align_val_t) noexcept { give(memory); }
void operator delete(void* memory, std::size_t, std::align_val_t) noexcept { give(memory); }
void operator delete[](void* memory, std::size_t, std::align_val_t) noexcept { give(memory); }

namespace {

using pcor::Loop;
using pcor::Model;
using pcor::Quantity;

// All stages active: LAMS, flow angles from the radome, a lag, a formula with an extra variable, taper,
// humidity, a calibrated temperature, its filter, and the correction by LAMS.
Model model_with_everything(pcor::LamsApproach approach) {
  Model model;
  model.effects = {
      {"static-constant", {0.004127875}},
      {"static-alpha", {0.021279816}},
      {"static-mach2", {0.01}},
      {"static-lag", {0.15}},
      {"lams-elevation", {0.1}},
      {"adif-drift", {0.05, 0.01, 0.005}},
      {"qcr-angle", {0.0273, 0.0562}},
      {"clock-skew", {0.5}},
      {"temp-lag", {2.3}},
      {"temp-deice-heat", {1.0}},
      {"humidity-error", {0.1}},
      {"total-lag", {0.1}},
      {"temp-calibration", {0.3, 0.01, 0.0001}},
  };
  pcor::ModelEffect thrust;
  thrust.id = "my-thrust";
  thrust.formula = "k * max(ENGTRQ, 0)^1.5 / 100 + if(mach < 0.3, sqrt(dynamic_ratio), tanh(attack))";
  thrust.parameter_names = {"k"};
  thrust.parameters = {0.01};
  model.effects.push_back(thrust);
  pcor::ModelEffect surface;
  surface.id = "static-surface";
  surface.surface = pcor::Surface{{{{Quantity::attack_ratio, -0.3, -0.1, 5}, {Quantity::mach, 0.2, 0.4, 4}}}};
  surface.parameters.assign(surface.surface->parameter_count(), 0.001);
  model.effects.push_back(surface);
  model.recovery = {{0.9959, 0.0283, 0.0374, 0.0762}};
  model.lams.approach = approach;
  model.attack_radome = {4.9, 13.4, 6.1};
  model.sideslip_radome = {0.1, 11.8, 0.0};
  model.policy.taper_below = 40.0;
  model.policy.minimum = -3.0;
  model.domain = {{"mach", 0.2, 0.6}};
  return model;
}

TEST(Allocation, TestCountsAllocations) {
  const std::size_t before = allocations;
  const auto value = std::make_unique<double>(1.0);
  EXPECT_EQ(*value, 1.0);
  EXPECT_GT(allocations, before);
}

TEST(Allocation, LoopDoesNotAllocate) {
  for (const auto approach : {pcor::LamsApproach::simultaneous, pcor::LamsApproach::iterated}) {
    std::string error;
    const pcor::ModelUncertainty uncertainty =
        pcor::test::uncertain_in_everything(model_with_everything(approach));
    auto loop =
        Loop::build(model_with_everything(approach),
                    {Quantity::static_pressure, Quantity::dynamic_pressure, Quantity::radome_dynamic_pressure,
                     Quantity::attack_differential_pressure, Quantity::sideslip_differential_pressure,
                     Quantity::recovery_temperature, Quantity::dew_point, Quantity::lams_airspeed},
                    25.0, &error, pcor::CorrectWith::lams, uncertainty);
    ASSERT_TRUE(loop) << error;
    int corrected = 0;
    int filtered = 0;
    int defects = 0;
    int uncertain = 0;
    const std::size_t allocations_before = allocations;
    const std::size_t releases_before = releases;
    for (int i = 0; i < 20000; ++i) {
      const double time = i / 25.0 + (i > 10000 ? 60.0 : 0.0);  // one gap
      const double wave = std::sin(0.01 * i);
      pcor::State<double>& s = loop->state();
      s[Quantity::static_pressure] = i % 1000 == 0 ? std::nan("") : 700.0 + 20.0 * wave;
      s[Quantity::dynamic_pressure] = 50.0 + 30.0 * std::sin(0.003 * i);
      s[Quantity::radome_dynamic_pressure] = 49.7 + 30.0 * std::sin(0.003 * i);
      s[Quantity::attack_differential_pressure] = -12.0 + 3.0 * wave;
      s[Quantity::sideslip_differential_pressure] = 1.2 * wave;
      s[Quantity::recovery_temperature] = i % 777 == 0 ? std::nan("") : 280.0 + wave;
      s[Quantity::dew_point] = 272.0 + 15.0 * wave;
      s[Quantity::lams_airspeed] = i % 10000 < 3000 ? std::nan("") : 100.0 + 25.0 * std::sin(0.003 * i);
      s[pcor::extra_quantity(0)] = 50.0 + 60.0 * wave;
      loop->run(time);
      filtered += std::isnan(s[Quantity::filtered_lams_temperature]) ? 0 : 1;
      const bool is_in_domain = s[Quantity::mach] >= 0.2 && s[Quantity::mach] <= 0.6;
      defects += is_in_domain && !std::isnan(s[Quantity::static_defect]) ? 1 : 0;
      uncertain += s[Quantity::static_defect_uncertainty] > 0.0 ? 1 : 0;
      corrected += loop->quality().has(pcor::Quality::corrected_with_lams) ? 1 : 0;
    }
    EXPECT_EQ(allocations, allocations_before);
    EXPECT_EQ(releases, releases_before);
    EXPECT_GT(corrected, 10000);
    EXPECT_LT(corrected, 20000);
    EXPECT_GT(filtered, 10000);
    EXPECT_GT(uncertain, 10000);
    EXPECT_EQ(uncertain, defects);
  }
}

}  // namespace

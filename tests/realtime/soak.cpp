/// Feeds the sample loop impossible inputs mixed with plausible ones, for a given time:
///
///     soak SAMPLES
///
/// Gaps, other rates, missing and infinite values, denormals, absurd and plausible ones, each at random in
/// every role, through models that use all stages. It counts the samples that break one of the laws of the
/// loop: a result is finite and plausible, or missing with a bit for the reason; and after a gap it is
/// bit-identical to the result of a new loop on the same samples. It prints the duration of the runs and the
/// number of allocations, and ends with status 1 if a law was broken.
#include <algorithm>
#include <chrono>
#include <cinttypes>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <limits>
#include <new>
#include <optional>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include <pcor/realtime/loop.hpp>
#include "support/uncertain_in_everything.hpp"

namespace {

std::uint64_t allocations = 0;

[[gnu::noinline]] void give(void* memory) { std::free(memory); }

}  // namespace

void* operator new(std::size_t size) {
  ++allocations;
  if (void* const memory = std::malloc(size)) return memory;
  std::abort();
}
void operator delete(void* memory) noexcept { give(memory); }
void operator delete(void* memory, std::size_t) noexcept { give(memory); }

namespace {

using pcor::Loop;
using pcor::Model;
using pcor::Quality;
using pcor::Quantity;

constexpr double missing = std::numeric_limits<double>::quiet_NaN();
constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double rate = 25.0;  // samples in a second

/// Usual values of a role in flight.
struct Usual {
  Quantity quantity;
  double minimum;
  double maximum;
};

/// A model, and the roles that its aircraft records.
struct World {
  Model model;
  std::vector<Usual> roles;
  pcor::CorrectWith with = pcor::CorrectWith::model;
};

/// Expected properties of a result. A filtered result belongs to an earlier sample, and so do its bits.
struct Believed {
  Quantity quantity;
  double minimum;
  double maximum;
};

constexpr Believed results[] = {
    {Quantity::static_defect, -2000.0, 2000.0},
    {Quantity::lams_static_defect, -2000.0, 2000.0},
    {Quantity::corrected_static_pressure, 0.0, 2000.0},
    {Quantity::corrected_dynamic_pressure, 0.0, 2000.0},
    {Quantity::humidity, 0.0, 1.0},
    {Quantity::corrected_mach, 0.0, 3.0},
    {Quantity::ambient_temperature, 100.0, 400.0},
    {Quantity::corrected_airspeed, 0.0, 1500.0},
    {Quantity::lams_temperature, 100.0, 400.0},
    {Quantity::lams_dynamic_pressure, 0.0, 2000.0},
    {Quantity::static_defect_uncertainty, 0.0, 1e300},
    {Quantity::corrected_static_pressure_uncertainty, 0.0, 1e300},
    {Quantity::corrected_dynamic_pressure_uncertainty, 0.0, 1e300},
    {Quantity::ambient_temperature_uncertainty, 0.0, 1e300},
    {Quantity::corrected_airspeed_uncertainty, 0.0, 1e300},
};

/// True if a bit gives the reason for a missing result; the other bits state the method of a result. Bits
/// about the model do not concern the laser that corrected a sample.
bool says_why(pcor::QualityFlags quality, Quantity result) {
  const bool is_uncertainty = result >= Quantity::static_defect_uncertainty;
  if (is_uncertainty && (quality.has(Quality::corrected_with_lams) || quality.has(Quality::outside_domain)))
    return true;
  constexpr Quality reasons[] = {Quality::static_pressure_missing,
                                 Quality::dynamic_pressure_missing,
                                 Quality::impossible_static_pressure,
                                 Quality::impossible_dynamic_pressure,
                                 Quality::effect_input_missing,
                                 Quality::impossible_radome_pressure,
                                 Quality::temperature_missing,
                                 Quality::lams_missing,
                                 Quality::after_gap,
                                 Quality::defect_exceeds_dynamic_pressure,
                                 Quality::filter_window_incomplete,
                                 Quality::no_airflow,
                                 Quality::awaiting_later_samples};
  return std::any_of(std::begin(reasons), std::end(reasons),
                     [quality](Quality reason) { return quality.has(reason); });
}

pcor::ModelEffect formula(const char* text) {
  pcor::ModelEffect effect;
  effect.id = "of-the-user";
  effect.formula = text;
  effect.parameter_names = {"k"};
  effect.parameters = {0.01};
  return effect;
}

std::vector<World> worlds() {
  const std::vector<Usual> radome{{Quantity::static_pressure, 150.0, 1020.0},
                                  {Quantity::dynamic_pressure, 5.0, 250.0},
                                  {Quantity::radome_dynamic_pressure, 5.0, 250.0},
                                  {Quantity::attack_differential_pressure, -30.0, 30.0},
                                  {Quantity::sideslip_differential_pressure, -5.0, 5.0},
                                  {Quantity::recovery_temperature, 220.0, 310.0},
                                  {Quantity::lams_airspeed, 60.0, 260.0}};
  const auto and_of = [](std::vector<Usual> roles, std::initializer_list<Usual> further) {
    roles.insert(roles.end(), further);
    return roles;
  };
  Model model;
  model.effects = {
      {"static-constant", {0.004127875}}, {"static-alpha", {0.021279816}}, {"static-qp", {0.030849643}}};
  model.recovery = {{0.95}};
  model.attack_radome = {4.9, 13.4, 6.1};
  model.sideslip_radome = {0.1, 11.8, 0.0};

  Model all = model;
  for (const pcor::ModelEffect& effect :
       std::vector<pcor::ModelEffect>{{"static-mach2", {0.01}},
                                      {"lams-elevation", {0.1}},
                                      {"adif-drift", {0.05, 0.01, 0.005}},
                                      {"qcr-angle", {0.0273, 0.0562}},
                                      {"temp-deice-heat", {1.0}},
                                      {"humidity-error", {0.1}},
                                      {"temp-calibration", {0.3, 0.01, 1e-4}}})
    all.effects.push_back(effect);
  all.effects.push_back(formula("k * max(ENGTRQ, 0)^1.5 / 100 + tanh(attack) * sqrt(dynamic_ratio)"));
  all.recovery = {{0.9959, 0.0283, 0.0374, 0.0762}};
  all.policy.taper_below = 40.0;
  all.policy.minimum = -3.0;
  all.domain = {{"mach", 0.2, 0.6}};
  Model late = all;
  late.lams.approach = pcor::LamsApproach::iterated;
  for (const pcor::ModelEffect& effect : std::vector<pcor::ModelEffect>{
           {"static-lag", {0.15}}, {"clock-skew", {0.5}}, {"temp-lag", {2.3}}, {"total-lag", {0.1}}})
    late.effects.push_back(effect);

  const Usual torque{pcor::extra_quantity(0), 0.0, 100.0};
  const Usual dew_point{Quantity::dew_point, 200.0, 300.0};
  return {{model, and_of(radome, {{Quantity::vapor_pressure, 0.0, 20.0}})},
          {all, and_of(radome, {dew_point, torque})},
          {all, and_of(radome, {dew_point, torque}), pcor::CorrectWith::lams},
          {late, and_of(radome, {dew_point, torque})}};
}

Loop loop_of(const World& world) {
  std::vector<Quantity> recorded;
  for (const Usual& role : world.roles) {
    if (pcor::is_role(role.quantity)) recorded.push_back(role.quantity);
  }
  std::string error;
  std::optional<Loop> loop = Loop::build(world.model, recorded, rate, &error, world.with,
                                         pcor::test::uncertain_in_everything(world.model));
  if (loop) return std::move(*loop);
  std::fprintf(stderr, "%s\n", error.c_str());
  std::exit(2);
}

class Soak {
 public:
  explicit Soak(World world) : world_(std::move(world)), loop_(loop_of(world_)), fresh_(loop_of(world_)) {}

  void run(std::uint64_t samples) {
    for (std::uint64_t i = 0; i < samples; ++i) {
      if (since_gap_ > 200 && random_() % 500 == 0) fly_through_a_gap();
      if (random_() % 1000 == 0) {
        const double steps[] = {1.0, 1.0, 0.2, 0.9, 1.02, 1.4};
        step_ = steps[random_() % std::size(steps)] / rate;
      }
      time_ += step_;
      const bool is_fair = random_() % 2 == 0;
      for (const Usual& role : world_.roles) loop_.state()[role.quantity] = value(role, is_fair);
      const bool is_compared = since_gap_ < 200;
      if (is_compared) fresh_.state() = loop_.state();
      run_timed();
      ++since_gap_;
      if (is_compared) {
        fresh_.run(time_);
        stale += std::memcmp(&fresh_.state(), &loop_.state(), sizeof(loop_.state())) == 0 ? 0 : 1;
      }
      judge();
    }
  }

  static inline std::uint64_t broken = 0;     ///< results
  static inline std::uint64_t stale = 0;      ///< samples after a gap that are not as a new loop's
  static inline std::uint64_t allocated = 0;  ///< allocations during runs
  static inline std::uint64_t gaps = 0;
  static inline std::vector<std::uint64_t> durations =
      std::vector<std::uint64_t>(1000000);  ///< number of runs by duration in nanoseconds

 private:
  // As in flight, as a fault leaves it, or anything at all.
  double value(const Usual& role, bool is_fair) {
    const double usual =
        role.minimum + (role.maximum - role.minimum) * std::uniform_real_distribution<double>()(random_);
    if (is_fair || random_() % 4 != 0) return usual;
    constexpr double denormal = std::numeric_limits<double>::denorm_min();
    const double faults[] = {missing,  infinity,  -infinity, 0.0,    -0.0,        -usual,
                             denormal, -denormal, 1e-300,    1e-40,  1e-6,        1.0,
                             -1.0,     1e5,       -1e5,      1e10,   1e30,        -1e30,
                             1e300,    -1e300,    -32767.0,  9999.0, 1e3 * usual, 1e-3 * usual};
    if (random_() % 4 != 0) return faults[random_() % std::size(faults)];
    const std::uint64_t bits = random_();
    double any = 0.0;
    std::memcpy(&any, &bits, sizeof any);
    return any;
  }

  void fly_through_a_gap() {
    const double jumps[] = {60.0, 0.1, -10.0, 1e9, missing, infinity};
    const double jump = jumps[random_() % std::size(jumps)];
    // An invalid interval restarts the loop, and so does the interval after it.
    if (!std::isfinite(jump)) loop_.run(jump);
    time_ += std::isfinite(jump) ? jump : 0.0;
    if (std::abs(time_) > 1e8) time_ = 0.0;
    fresh_ = loop_of(world_);
    since_gap_ = 0;
    ++gaps;
  }

  void run_timed() {
    const std::uint64_t allocations_before = allocations;
    const auto begin = std::chrono::steady_clock::now();
    loop_.run(time_);
    const auto took = std::chrono::steady_clock::now() - begin;
    allocated += allocations - allocations_before;
    const auto nanoseconds =
        static_cast<std::size_t>(std::chrono::duration_cast<std::chrono::nanoseconds>(took).count());
    ++durations[std::min(nanoseconds, durations.size() - 1)];
  }

  void judge() {
    constexpr Quantity filtered = Quantity::filtered_lams_temperature;
    const double of_earlier = loop_.state()[filtered];
    // If that sample is missing the bit was set when it was run.
    const bool is_flagged =
        since_gap_ > loop_.delay() + pcor::LowPass::delay(rate) || says_why(loop_.quality(), filtered);
    if (std::isnan(of_earlier) ? !is_flagged : !(of_earlier >= 100.0 && of_earlier <= 400.0))
      tell(filtered, of_earlier);
    for (const Believed& result : results) {
      const double value = loop_.state()[result.quantity];
      const bool is_right = std::isnan(value)
                                ? !loop_.writes(result.quantity) || says_why(loop_.quality(), result.quantity)
                                : value >= result.minimum && value <= result.maximum;
      if (!is_right) tell(result.quantity, value);
    }
  }

  void tell(Quantity quantity, double value) {
    if (++broken > 10) return;
    std::fprintf(stderr, "%s = %g with the bits %x:", std::string(info_of(quantity).name).c_str(), value,
                 loop_.quality().bits());
    for (const Usual& role : world_.roles) std::fprintf(stderr, " %g", loop_.state()[role.quantity]);
    std::fprintf(stderr, "\n");
  }

  World world_;
  Loop loop_;
  Loop fresh_;
  std::mt19937_64 random_{20111117};
  double time_ = 0.0;
  double step_ = 1.0 / rate;  // the interval changes during a run
  std::size_t since_gap_ = 0;
};

// The duration that a share of the runs stays below.
std::size_t quantile(double share) {
  std::uint64_t runs = 0;
  for (const std::uint64_t count : Soak::durations) runs += count;
  const auto requested = static_cast<std::uint64_t>(share * static_cast<double>(runs));
  std::uint64_t seen = 0;
  std::size_t i = 0;
  while (i + 1 < Soak::durations.size() && (seen += Soak::durations[i]) < requested) ++i;
  return i;
}

}  // namespace

int main(int argc, char** argv) {
  const std::uint64_t samples = argc == 2 ? std::strtoull(argv[1], nullptr, 10) : 0;
  if (samples == 0) return std::fprintf(stderr, "soak SAMPLES\n"), 2;
  const std::vector<World> all = worlds();
  for (const World& world : all) Soak(world).run(samples / all.size() + 1);
  std::printf("%" PRIu64 " samples, %" PRIu64 " gaps: p50 %zu ns, p99.99 %zu ns, %" PRIu64 " allocations\n",
              samples, Soak::gaps, quantile(0.5), quantile(0.9999), Soak::allocated);
  std::printf("%" PRIu64 " results broke a law, %" PRIu64 " samples knew of those before a gap\n",
              Soak::broken, Soak::stale);
  return Soak::broken + Soak::stale + Soak::allocated > 0 ? 1 : 0;
}

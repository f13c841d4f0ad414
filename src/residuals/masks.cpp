#include "residuals/masks.hpp"
#include "numerics/missing.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <numeric>

namespace pcor {

const std::array<MaskFacts, mask_count> mask_facts{{
    {"used", "used"},
    {"excluded", "in times that the user excluded"},
    {"missing", "without a value that the model needs"},
    {"ground", "on the ground"},
    {"low_speed", "slower than the least airspeed (--min-airspeed)"},
    {"flaps", "with flaps out (--max-flaps)"},
    {"regime", "in a regime that is excluded (--exclude)"},
    {"reference_missing", "without a value of the reference"},
    {"laser_unlocked", "with a laser airspeed far from that of the pressures"},
    {"impossible", "without a delta-p: impossible with these values and coefficients"},
}};

std::string mask_text(const std::array<std::size_t, mask_count>& counts) {
  std::vector<std::size_t> order(mask_count - 1);
  std::iota(order.begin(), order.end(), 1);
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return counts[a] > counts[b]; });
  std::vector<std::string> parts;
  for (const std::size_t mask : order) {
    if (counts[mask] > 0) parts.push_back(fmt::format("{} {}", counts[mask], mask_facts[mask].meaning));
  }
  return parts.empty() ? "none" : fmt::format("{}", fmt::join(parts, "; "));
}

namespace internal {
namespace {

double airspeed_at(const FlightSamples& samples, std::size_t sample) {
  const std::vector<double>& airspeed = samples.motion.airspeed;
  return airspeed.empty() ? nan : airspeed[sample];
}

Mask mask_as_flown(const FlightSamples& samples, std::size_t sample, const RegimeSet& regimes,
                   const MaskOptions& options) {
  const auto in = [&regimes](Regime regime) { return regimes[static_cast<std::size_t>(regime)]; };
  if (in(Regime::ground)) return Mask::ground;
  if (airspeed_at(samples, sample) < options.least_airspeed) return Mask::low_speed;
  if (!samples.flaps.empty() && samples.flaps[sample] > options.most_flaps) return Mask::flaps;
  return std::any_of(options.exclude.begin(), options.exclude.end(), in) ? Mask::regime : Mask::none;
}

}  // namespace

std::vector<Mask> masks_as_flown(const FlightSamples& samples, const MaskOptions& options) {
  const std::vector<double>& time = samples.time;
  const std::vector<RegimeSet> regimes = regimes_of_samples(time, samples.intervals);
  std::vector<Mask> masks(time.size());
  for (std::size_t i = 0; i < masks.size(); ++i) masks[i] = mask_as_flown(samples, i, regimes[i], options);
  if (!options.intervals || time.empty() || !options.intervals->is_for(samples.name)) return masks;
  for (const Exclusion& exclusion : placed(*options.intervals, time.front(), time.back()).exclude) {
    for (std::size_t i = 0; i < masks.size(); ++i) {
      if (time[i] >= exclusion.begin && time[i] < exclusion.end) masks[i] = Mask::excluded;
    }
  }
  return masks;
}

std::vector<Mask> find_masks(const FlightSamples& samples, const ReferenceOnSamples& reference,
                             const std::vector<double>& residual, const MaskOptions& options) {
  const std::vector<double>& p = *samples.model.find(Quantity::static_pressure);
  const std::vector<double>& q = *samples.model.find(Quantity::dynamic_pressure);
  std::vector<Mask> masks = masks_as_flown(samples, options);
  for (std::size_t i = 0; i < masks.size(); ++i) {
    if (masks[i] == Mask::excluded) continue;
    if (std::isnan(p[i]) || std::isnan(q[i])) {
      masks[i] = Mask::missing;
    } else if (masks[i] == Mask::none) {
      masks[i] = std::isnan(residual[i]) ? reference.why_missing(i)
                                         : reference.why_not_believed(i, airspeed_at(samples, i), options);
    }
  }
  return masks;
}

}  // namespace internal
}  // namespace pcor

#include "residuals/masks.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include <pcor/effects/catalogue.hpp>
#include <pcor/model/formula.hpp>
#include "numerics/missing.hpp"
#include "residuals/flight_statistics.hpp"
#include "residuals/reference_on_samples.hpp"

namespace pcor {

const std::array<MaskInfo, mask_count> mask_info{{
    {"used", "used"},
    {"excluded", "excluded by the user"},
    {"missing", "missing a value of the model"},
    {"ground", "ground"},
    {"low_speed", "below the minimum airspeed (--min-airspeed)"},
    {"regime", "excluded regime (--exclude)"},
    {"frozen", "frozen sensor"},
    {"reference_missing", "missing a value of the reference"},
    {"laser_unlocked", "laser airspeed far from the prediction by the pressures"},
    {"burst", "burst of a few seconds, in which a pressure and the residual jump"},
    {"impossible", "undefined delta-p for these values and coefficients"},
    {"flaps", "flaps extended (--max-flaps)"},
}};

std::string mask_text(const std::array<std::size_t, mask_count>& counts) {
  std::vector<std::size_t> order(mask_count - 1);
  std::iota(order.begin(), order.end(), 1);
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return counts[a] > counts[b]; });
  std::vector<std::string> parts;
  for (const std::size_t mask : order) {
    if (counts[mask] > 0) parts.push_back(fmt::format("{} {}", counts[mask], mask_info[mask].meaning));
  }
  return parts.empty() ? "none" : fmt::format("{}", fmt::join(parts, "; "));
}

namespace internal {
namespace {

std::vector<Mask> masks_without_flaps(const FlightSamples& samples, const MaskOptions& options) {
  const std::vector<double>& time = samples.time;
  const std::vector<double>& airspeed = samples.motion.airspeed;
  const std::vector<RegimeSet> regimes = regimes_of_samples(time, samples.intervals);
  std::vector<Mask> masks(time.size());
  for (std::size_t i = 0; i < masks.size(); ++i) {
    const auto in = [&](Regime regime) { return regimes[i][static_cast<std::size_t>(regime)]; };
    if (in(Regime::ground))
      masks[i] = Mask::ground;
    else if (!airspeed.empty() && airspeed[i] < options.min_airspeed)
      masks[i] = Mask::low_speed;
    else if (std::any_of(options.exclude.begin(), options.exclude.end(), in))
      masks[i] = Mask::regime;
  }
  const auto exclude = [&](const std::vector<Exclusion>& spans) {
    for (const Exclusion& span : spans) {
      for (std::size_t i = 0; i < masks.size(); ++i) {
        if (time[i] >= span.begin && time[i] < span.end) masks[i] = Mask::excluded;
      }
    }
  };
  exclude(options.excluded_times);
  if (options.intervals && !time.empty() && options.intervals->is_for(samples.name))
    exclude(placed(*options.intervals, time.front(), time.back()).exclude);
  return masks;
}

void mark_flaps(const FlightSamples& samples, double maximum, std::vector<Mask>& masks) {
  for (std::size_t i = 0; i < samples.flaps.size(); ++i) {
    if (masks[i] == Mask::none && samples.flaps[i] > maximum) masks[i] = Mask::flaps;
  }
}

/// Whether a quantity is read, or its rate of change.
bool is_read(Quantity quantity, const std::vector<Batch::Input>& read) {
  return std::any_of(read.begin(), read.end(), [quantity](const Batch::Input& column) {
    return column.quantity == quantity || std::any_of(rates.begin(), rates.end(), [&](const Rate& each) {
             return each.quantity == quantity && each.rate == column.quantity;
           });
  });
}

}  // namespace

std::vector<Mask> masks_as_flown(const FlightSamples& samples, const MaskOptions& options) {
  std::vector<Mask> masks = masks_without_flaps(samples, options);
  mark_flaps(samples, options.max_flaps.value_or(flaps_in), masks);
  return masks;
}

std::vector<Mask> find_masks(const FlightSamples& samples, const ModelOnSamples& model,
                             const ReferenceOnSamples& reference, const std::vector<double>& residual,
                             const MaskOptions& options) {
  const std::vector<double>& p = *samples.model.find(Quantity::static_pressure);
  const std::vector<double>& q = *samples.model.find(Quantity::dynamic_pressure);
  std::vector<Mask> masks = masks_without_flaps(samples, options);
  const auto mark = [&masks](std::size_t sample, Mask mask) {
    if (masks[sample] == Mask::none) masks[sample] = mask;
  };
  for (std::size_t i = 0; i < masks.size(); ++i) {
    if (masks[i] != Mask::excluded && (std::isnan(p[i]) || std::isnan(q[i]))) masks[i] = Mask::missing;
  }
  std::vector<const std::vector<double>*> pressures;
  for (const auto& [recorded, read] :
       {std::pair(&samples.model, model.columns()), std::pair(&samples.reference, reference.columns())}) {
    for (const FrozenSpan& span : recorded->frozen) {
      if (!is_read(span.quantity, read)) continue;
      for (std::size_t i = span.first; i < span.first + span.count; ++i) mark(i, Mask::frozen);
    }
    // The radome pressures are excluded: they jump with the flow angles, and effects of the angles with them.
    for (const Quantity quantity :
         {Quantity::static_pressure, Quantity::dynamic_pressure, Quantity::corrected_static_pressure}) {
      const std::vector<double>* const pressure = recorded->find(quantity);
      if (pressure != nullptr && is_read(quantity, read)) pressures.push_back(pressure);
    }
  }
  for (std::size_t i = 0; i < masks.size(); ++i) {
    if (masks[i] == Mask::none && std::isnan(residual[i])) masks[i] = reference.why_missing(i);
  }
  reference.mark_implausible(masks, samples.motion.airspeed);
  // In a gust the dynamic pressure and the residual by wind jump together, although every sensor works.
  if (reference.half_width() == 0) {
    const std::vector<double> used = masked(residual, masks, Mask::none);
    for (const std::size_t sample : find_bursts(used, pressures, samples.time, samples.step))
      mark(sample, Mask::burst);
  }
  const std::vector<ModelEffect>& effects = model.model().effects;
  const bool describes_flaps = std::any_of(effects.begin(), effects.end(), [&](const ModelEffect& effect) {
    return reads_flaps(effect, samples.flaps_variable);
  });
  mark_flaps(samples, options.max_flaps.value_or(describes_flaps ? infinity : flaps_in), masks);
  return masks;
}

bool reads_flaps(const ModelEffect& effect, const std::string& variable) {
  if (effect.is_surface()) {
    const auto& axes = effect.surface->axes;
    return std::any_of(axes.begin(), axes.end(),
                       [](const SurfaceAxis& axis) { return axis.quantity == Quantity::flaps; });
  }
  if (effect.is_formula()) {
    const auto formula = Formula::parse(effect.formula, effect.parameter_names);
    if (!formula) return false;
    return std::any_of(
        formula->variables().begin(), formula->variables().end(),
        [&](const std::string& name) { return name == variable || quantity_named(name) == Quantity::flaps; });
  }
  const auto& needs = effect_named(effect.id)->needs;
  return std::find(needs.begin(), needs.end(), Quantity::flaps) != needs.end();
}

std::vector<std::size_t> used_samples(const std::vector<Mask>& masks, double share) {
  std::vector<std::size_t> used;
  for (std::size_t i = 0; i < masks.size(); ++i) {
    if (masks[i] == Mask::none) used.push_back(i);
  }
  used.resize(static_cast<std::size_t>(std::llround(share * static_cast<double>(used.size()))));
  return used;
}

}  // namespace internal
}  // namespace pcor

#pragma once

#include <array>
#include <cstdint>
#include <string_view>

namespace pcor {

/// Quality of a sample: defects and applied corrections. Each is one bit of the flag variable.
///
/// In the sample loop `filter_window_incomplete` refers to the sample that leaves the filter,
/// `LowPass::delay` samples ago; in a processed flight it is set at that sample.
enum class Quality : std::uint32_t {
  static_pressure_missing = 1U << 0,
  dynamic_pressure_missing = 1U << 1,
  impossible_static_pressure = 1U << 2,
  impossible_dynamic_pressure = 1U << 3,
  effect_input_missing = 1U << 4,
  impossible_radome_pressure = 1U << 5,
  temperature_missing = 1U << 6,
  dry_air_assumed = 1U << 7,
  humidity_limited = 1U << 8,
  lams_missing = 1U << 9,
  tapered = 1U << 10,
  minimum_applied = 1U << 11,
  outside_domain = 1U << 12,
  after_gap = 1U << 13,
  corrected_with_lams = 1U << 14,
  defect_exceeds_dynamic_pressure = 1U << 15,
  filter_window_incomplete = 1U << 16,
  no_airflow = 1U << 17,
  sensor_frozen = 1U << 18,
  uneven_samples = 1U << 19,
  awaiting_later_samples = 1U << 20,
};

/// Quality bit and its meaning.
struct QualityInfo {
  Quality bit;
  std::string_view name;
  std::string_view brief;  ///< meaning in at most 55 characters
  std::string_view meaning;
};

inline constexpr std::array<QualityInfo, 21> quality_info{{
    {Quality::static_pressure_missing, "static_pressure_missing",
     "no static pressure within +-2000 hPa: no results",
     "no static pressure, or outside the plausible range: nothing is derived"},
    {Quality::dynamic_pressure_missing, "dynamic_pressure_missing",
     "no dynamic pressure within +-2000 hPa: no results",
     "no dynamic pressure, or outside the plausible range: nothing is derived"},
    {Quality::impossible_static_pressure, "impossible_static_pressure",
     "impossible static pressure: no results",
     "static pressure below 1 hPa, or outside the plausible range when corrected: nothing is derived"},
    {Quality::impossible_dynamic_pressure, "impossible_dynamic_pressure",
     "zero or below, as on the ground: no Mach number",
     "dynamic pressure zero or below, as on the ground, above that of Mach 1, or outside the plausible range "
     "when corrected: no Mach number, nothing derived from it"},
    {Quality::effect_input_missing, "effect_input_missing", "an input of an effect is missing: no delta-p",
     "an input of the model's effects is missing: no delta-p, or no pressure to correct"},
    {Quality::impossible_radome_pressure, "impossible_radome_pressure",
     "zero or below: no flow angles from the radome",
     "radome dynamic pressure zero or below: no flow angles from the radome"},
    {Quality::temperature_missing, "temperature_missing", "no temperature: no airspeed",
     "no temperature, or outside the plausible range: no airspeed"},
    {Quality::dry_air_assumed, "dry_air_assumed", "no humidity: dry air",
     "no humidity, or a vapour pressure not below the static pressure: constants of dry air"},
    {Quality::humidity_limited, "humidity_limited", "vapour pressure set to zero or to saturation",
     "vapour pressure below zero or above saturation: set to the limit"},
    {Quality::lams_missing, "lams_missing", "no valid airspeed from LAMS",
     "no valid airspeed from LAMS, or its result is outside the plausible range, or its delta-p differs by "
     "more "
     "than three tenths of the dynamic pressure from zero and from that of the model"},
    {Quality::tapered, "tapered", "delta-p tapered at low dynamic pressure",
     "delta-p tapered at low dynamic pressure"},
    {Quality::minimum_applied, "minimum_applied", "delta-p raised to the minimum of the law",
     "delta-p raised to the minimum of the law"},
    {Quality::outside_domain, "outside_domain", "outside the domain of the law, or flaps extended",
     "an input lies outside the domain of the law, a quantity of the domain is missing, the flaps are "
     "extended, the absolute delta-p of the model exceeds 0.6 q in flight, or the noise of an input exceeds "
     "its possible range: no uncertainty; or outside the envelope of a surface only: a larger uncertainty"},
    {Quality::after_gap, "after_gap", "near a gap: too few neighbours for rates of change",
     "near a gap, or missing inputs of an airspeed: effects of rates of change have too few neighbours; in "
     "real time also the first sample after a gap"},
    {Quality::corrected_with_lams, "corrected_with_lams", "corrected with LAMS, not with the model",
     "pressures corrected with LAMS, not with the model"},
    {Quality::defect_exceeds_dynamic_pressure, "defect_exceeds_dynamic_pressure",
     "delta-p too large, as on the ramp: no delta-p",
     "delta-p above the dynamic pressure, or below its negative, as on the ramp: no delta-p"},
    {Quality::filter_window_incomplete, "filter_window_incomplete", "no filtered LAMS temperature",
     "filter window incomplete, or its result is outside the plausible range: no filtered LAMS temperature"},
    {Quality::no_airflow, "no_airflow", "too slow, as on the ramp: no Mach number, no airspeed",
     "dynamic pressure too low to distinguish airflow from noise, as on the ramp: no Mach number, no "
     "airspeed, and, if the measured one is too low, no delta-p without a taper"},
    {Quality::sensor_frozen, "sensor_frozen", "a sensor is frozen: dependent results are wrong",
     "a sensor is frozen, constant for much longer than its noise permits: dependent results are wrong"},
    {Quality::uneven_samples, "uneven_samples", "uneven intervals: effects of rates of change are wrong",
     "sample intervals differ from those of the rate, or the time does not increase: effects of rates of "
     "change are wrong"},
    {Quality::awaiting_later_samples, "awaiting_later_samples",
     "no results yet: the filter needs later samples",
     "no results yet after the start or a gap in real time: the filter needs later samples"},
}};

/// Quality bits of one sample.
class QualityFlags {
 public:
  /// Sets `bit` if the condition holds.
  constexpr void set(bool condition, Quality bit) {
    if (condition) bits_ |= static_cast<std::uint32_t>(bit);
  }
  constexpr void set(Quality bit) { set(true, bit); }
  constexpr bool has(Quality bit) const { return (bits_ & static_cast<std::uint32_t>(bit)) != 0; }
  constexpr std::uint32_t bits() const { return bits_; }
  constexpr void clear() { bits_ = 0; }

 private:
  std::uint32_t bits_ = 0;
};

/// Replacement of `QualityFlags` for computations without flags, such as vector packs and fits.
class NoQualityFlags {
 public:
  template <class Condition>
  constexpr void set(const Condition&, Quality) {}
};

}  // namespace pcor

#pragma once

#include <array>
#include <cstddef>
#include <string_view>

#include <pcor/model/effect.hpp>

namespace pcor {

namespace detail {

constexpr EffectInfo surface_info_of(std::string_view id, std::string_view title, std::string_view family,
                                     std::string_view formula, Quantity angle, std::string_view size,
                                     std::string_view confounders, std::string_view manoeuvre) {
  EffectInfo info;
  info.id = id;
  info.title = title;
  info.family = family;
  info.location = EffectLocation::static_defect;
  info.formula = formula;
  info.needs = {Quantity::dynamic_pressure, angle, Quantity::mach, Quantity::count};
  info.size = size;
  info.confounders = confounders;
  info.manoeuvre = manoeuvre;
  info.source = "tensor product of cubic B-splines with a curvature penalty (Eilers and Marx 1996)";
  return info;
}

}  // namespace detail

/// The surfaces that `pcor add` makes. They are not effects of the catalogue: how many coefficients they have
/// and where their knots are is in the model (`Surface`). A diagnosis does not try them.
inline constexpr std::array<EffectInfo, 2> surface_info{
    detail::surface_info_of(
        "static-surface", "smooth pressure coefficient of attack and Mach number", "attack",
        "dynamic_pressure * Cp(attack_ratio, mach)", Quantity::attack_ratio,
        "tenths of hPa where a law of a few terms was fitted; GOTEX 2004: 0.1 hPa rms",
        "static-alpha, static-alpha-quad, static-qp, static-mach and all that varies with its axes",
        "pitch manoeuvres at several speeds: only what was flown is determined"),
    detail::surface_info_of(
        "static-surface-beta", "smooth pressure coefficient of sideslip and Mach number", "sideslip",
        "dynamic_pressure * Cp(sideslip_ratio, mach)", Quantity::sideslip_ratio, "not measured",
        "static-beta-odd, static-beta-even, static-qp, static-mach and all that varies with its axes",
        "yaw manoeuvres at several speeds: only what was flown is determined")};

/// The surface called `id`; null if there is no such surface.
constexpr const EffectInfo* surface_named(std::string_view id) {
  for (const EffectInfo& info : surface_info) {
    if (info.id == id) return &info;
  }
  return nullptr;
}

}  // namespace pcor

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include <pcor/base/error.hpp>
#include <pcor/effects/static_surface.hpp>
#include <pcor/physics/air_data.hpp>
#include <pcor/roles/add_effects.hpp>
#include "base/quoting.hpp"
#include "roles/recorded_series.hpp"

namespace pcor {

using namespace internal;

namespace {

constexpr double min_mach = 0.18;
constexpr double share_outside = 0.01;  // share beyond either end of an axis
constexpr std::size_t min_samples = 300;

std::vector<double> series_of(const Flight& flight, const ModelDefinition& model, Quantity role) {
  RecordedSeries series = read_role(flight, model, role);
  if (!series.values.empty()) return std::move(series.values);
  throw Error(Error::Code::variable,
              fmt::format("{}: {} is not recorded, and a surface reads it; name its variable in "
                          "[variables] as {}",
                          flight.path().string(), info_of(role).description, info_of(role).name));
}

SurfaceAxis axis_of(Quantity quantity, std::vector<double> values, std::size_t splines) {
  const auto at = [&values](double share) {
    const auto position = static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
    std::nth_element(values.begin(), values.begin() + position, values.end());
    return values[static_cast<std::size_t>(position)];
  };
  const double lower = at(share_outside);
  return {quantity, lower, at(1.0 - share_outside), splines};
}

}  // namespace

ModelEffect surface_over(std::size_t flights, const std::function<const Flight&(std::size_t)>& flight,
                         const ModelDefinition& model, std::string_view id, std::size_t splines) {
  const EffectInfo* const info = surface_named(id);
  if (info == nullptr) throw Error(Error::Code::usage, fmt::format("there is no surface {}", quote(id)));
  const Quantity ratio = info->needs[1];
  const Quantity pressure = ratio == Quantity::attack_ratio ? Quantity::attack_differential_pressure
                                                            : Quantity::sideslip_differential_pressure;
  std::vector<double> ratios;
  std::vector<double> machs;
  for (std::size_t number = 0; number < flights; ++number) {
    const Flight& one = flight(number);
    const std::vector<double> p = series_of(one, model, Quantity::static_pressure);
    const std::vector<double> q = series_of(one, model, Quantity::dynamic_pressure);
    const std::vector<double> radome = series_of(one, model, Quantity::radome_dynamic_pressure);
    const std::vector<double> differential = series_of(one, model, pressure);
    for (std::size_t i = 0; i < p.size(); ++i) {
      const double mach = mach_number(p[i], q[i], dry_air<double>());
      const double of_radome = differential[i] / radome[i];
      if (!(mach >= min_mach) || !std::isfinite(of_radome) || !(radome[i] > 0.0)) continue;
      machs.push_back(mach);
      ratios.push_back(of_radome);
    }
  }
  if (machs.size() < min_samples) {
    throw Error(
        Error::Code::samples,
        fmt::format(
            "surface {}: {} samples have all that it reads above Mach {} ({} expected); give a flight "
            "with more of them",
            id, machs.size(), min_mach, min_samples));
  }
  const std::array<SurfaceAxis, 2> axes{axis_of(ratio, std::move(ratios), splines),
                                        axis_of(Quantity::mach, std::move(machs), splines)};
  for (const SurfaceAxis& axis : axes) {
    if (axis.is_valid()) continue;
    throw Error(
        Error::Code::samples,
        fmt::format("surface {}: {} splines over {} from {:.4g} to {:.4g} are not a valid axis ({} to {} "
                    "splines expected); give a flight with a larger range",
                    id, axis.count, info_of(axis.quantity).name, axis.lower, axis.upper,
                    SurfaceAxis::min_count, SurfaceAxis::max_count));
  }
  return surface_effect(std::string(id), axes);
}

}  // namespace pcor

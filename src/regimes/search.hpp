#pragma once

#include <cmath>
#include <cstddef>
#include <string>
#include <vector>

#include <pcor/regimes/regimes.hpp>

#include "regimes/cells.hpp"
#include "regimes/series.hpp"

namespace pcor::internal {

/// Regime of consecutive cells.
struct Found {
  Regime regime = Regime::count;
  Run run;
  int pair = 0;
  std::string note{};
};

/// Phase of each cell; `Regime::count` if unknown.
std::vector<Regime> phases_of(const Cells& cells, const RegimeCriteria& criteria);

/// Whether the phase is airborne.
constexpr bool is_airborne(Regime phase) {
  return phase == Regime::climb || phase == Regime::descent || phase == Regime::level;
}

/// Cells that are searched for manoeuvres: airborne, or with unknown phase.
std::vector<bool> in_flight(const std::vector<Regime>& phases);

std::vector<Found> find_turns(const Cells& cells, const std::vector<bool>& flying,
                              const RegimeCriteria& criteria);
std::vector<Found> find_circles(const Cells& cells, const std::vector<bool>& flying,
                                const RegimeCriteria& criteria);
std::vector<Found> find_pitch_manoeuvres(const Cells& cells, const std::vector<bool>& flying,
                                         const RegimeCriteria& criteria);
std::vector<Found> find_yaw_manoeuvres(const Cells& cells, const std::vector<bool>& flying,
                                       const RegimeCriteria& criteria);
std::vector<Found> find_speed_runs(const Cells& cells, const std::vector<bool>& flying,
                                   const RegimeCriteria& criteria);

/// `usable` marks the cells that a leg may contain: in flight, and outside other manoeuvres.
std::vector<Found> find_reverse_headings(const Cells& cells, const std::vector<bool>& usable,
                                         const RegimeCriteria& criteria);

std::vector<Found> find_clouds(const Cells& cells, const std::vector<bool>& flying,
                               const RegimeCriteria& criteria);

/// Duration as a number of cells.
inline std::size_t cells_in(double seconds) { return static_cast<std::size_t>(std::lround(seconds)); }

}  // namespace pcor::internal

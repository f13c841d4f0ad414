#pragma once

#include <cmath>
#include <cstddef>
#include <string>
#include <vector>

#include <pcor/regimes/regimes.hpp>

#include "regimes/cells.hpp"
#include "regimes/series.hpp"

namespace pcor::internal {

/// A regime of consecutive cells.
struct Found {
  Regime regime = Regime::count;
  Run run;
  int pair = 0;
  std::string note{};
};

/// The phase of each cell, `Regime::count` where it cannot be told.
std::vector<Regime> phases_of(const Cells& cells, const RegimeCriteria& criteria);

/// Whether that phase is in the air.
constexpr bool is_airborne(Regime phase) {
  return phase == Regime::climb || phase == Regime::descent || phase == Regime::level;
}

/// The cells in which manoeuvres are looked for: in the air, or where the phase cannot be told.
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

/// `usable` are the cells in which a leg may lie: in flight, and in no other manoeuvre.
std::vector<Found> find_reverse_headings(const Cells& cells, const std::vector<bool>& usable,
                                         const RegimeCriteria& criteria);

std::vector<Found> find_clouds(const Cells& cells, const std::vector<bool>& flying,
                               const RegimeCriteria& criteria);

/// A duration as a number of cells.
inline std::size_t cells_in(double seconds) { return static_cast<std::size_t>(std::lround(seconds)); }

}  // namespace pcor::internal

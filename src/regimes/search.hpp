#pragma once

#include <cmath>
#include <cstddef>
#include <string>
#include <vector>

#include <pcor/regimes/regimes.hpp>

#include "regimes/cells.hpp"
#include "regimes/series.hpp"

namespace pcor::internal {

/// Search for the regimes of a flight.
struct Search {
  Cells cells;
  RegimeCriteria criteria;
  std::vector<bool> flying;       ///< cells that are searched for manoeuvres: airborne, or with unknown phase
  std::vector<bool> unassigned;   ///< flying cells outside the regimes that were found before
  std::vector<Interval> found{};  ///< regimes in the order of their detection

  void add(Regime regime, Run run, const std::string& note = "", int pair = 0);
};

/// Phase of each cell; `Regime::count` if unknown.
std::vector<Regime> phases_of(const Cells& cells, const RegimeCriteria& criteria);

void find_turns(Search& search);
void find_circles(Search& search);
void find_pitch_manoeuvres(Search& search);
void find_yaw_manoeuvres(Search& search);
void find_speed_runs(Search& search);

/// The legs contain only cells outside the regimes that were found before.
void find_reverse_headings(Search& search);

/// Duration as a number of cells.
inline std::size_t cells_in(double seconds) { return static_cast<std::size_t>(std::lround(seconds)); }

}  // namespace pcor::internal

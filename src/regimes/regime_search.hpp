#pragma once

#include <cmath>
#include <cstddef>
#include <string>
#include <vector>

#include <pcor/regimes/regimes.hpp>

#include "regimes/series.hpp"

namespace pcor::internal {

/// Motion of a flight as means over cells of one second, for any sampling rate. Every series has one value
/// for each cell, NaN if missing; gaps up to 5 s are interpolated. A gap in the time is kept as cells without
/// values, up to 300 of them, so that memory does not grow with gaps.
struct OneHertzCells {
  std::vector<double> begin;  ///< start time of each cell, s since 1970 UTC, followed by the end time of the
                              ///< last one
  std::vector<double> airspeed;
  std::vector<double> altitude;
  std::vector<double> vertical_speed;  ///< recorded, otherwise from the altitude
  std::vector<double> roll;            ///< recorded, otherwise the roll of a coordinated turn with this
                                       ///< heading rate
  std::vector<double> pitch;
  std::vector<double> heading;  ///< deg, not wrapped: it continues beyond 360
  std::vector<double> sideslip;
  std::vector<double> liquid_water;

  std::size_t count() const { return airspeed.size(); }
};

/// @throws Error as does `find_regimes`
OneHertzCells cells_of(const FlightMotion& motion);

/// Search for the regimes of a flight.
struct RegimeSearch {
  OneHertzCells cells;
  RegimeCriteria criteria;
  std::vector<bool> flying;       ///< cells that are searched for manoeuvres: airborne, or with unknown phase
  std::vector<bool> unassigned;   ///< flying cells outside the regimes that were found before
  std::vector<Interval> found{};  ///< regimes in the order of their detection

  void add(Regime regime, IndexRange run, const std::string& note = "", int pair = 0);
};

/// Phase of each cell; `Regime::count` if unknown.
std::vector<Regime> phases_of(const OneHertzCells& cells, const RegimeCriteria& criteria);

void find_turns(RegimeSearch& search);
void find_circles(RegimeSearch& search);
void find_pitch_manoeuvres(RegimeSearch& search);
void find_yaw_manoeuvres(RegimeSearch& search);
void find_speed_runs(RegimeSearch& search);

/// The legs contain only cells outside the regimes that were found before.
void find_reverse_headings(RegimeSearch& search);

/// Duration as a number of cells.
inline std::size_t cells_in(double seconds) { return static_cast<std::size_t>(std::lround(seconds)); }

}  // namespace pcor::internal

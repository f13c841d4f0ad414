#pragma once

#include <Eigen/Dense>
#include <functional>
#include <string>
#include <vector>

#include <pcor/regimes/regimes.hpp>
#include "campaign/columns.hpp"
#include "campaign/whitened.hpp"

namespace pcor::internal {

/// A regime that some flights flew: the mean of its intervals.
struct FlownRegime {
  Regime regime = Regime::count;
  double duration = 0.0;          ///< s
  Eigen::MatrixXd information{};  ///< products of the whitened columns with each other
  std::string flight{};           ///< name of the flight that flew most of the regime
};

/// Local flight against one of its references.
struct FlightInBins {
  const FlightColumns& columns;
  const Binning& bins;
};

/// Repeatable regimes of all flights: all except ground, take-off and level. Bins of a
/// climb or a descent over which another regime lies, such as a turn, count for that regime alone.
///
/// @param flight gives the flight of an entry of the scores
std::vector<FlownRegime> flown_regimes(const WhitenedSystem& scores,
                                       const std::function<FlightInBins(std::size_t flight)>& flight);

}  // namespace pcor::internal

#pragma once

#include <memory>
#include <set>
#include <string>
#include <vector>

#include <pcor/campaign/flight_set.hpp>
#include "campaign/columns.hpp"

namespace pcor::internal {

/// What unexplained structure may go with: a variable at every record of everything that is analysed, of the
/// own flights of a member of a team.
struct TestedVariable {
  std::string name;
  std::string unit{};
  std::string description{};
  bool in_file = false;
  /// Whether a line in it may be a cause by itself: what is recorded, and the power that the aircraft has.
  bool may_be_cause = false;
  double turn = 0.0;  ///< of an angle that takes all directions, in its unit; 0 for what is none
  /// Whether a curve against it may bend many times, as over heights and speeds it does; of what is rarely
  /// far from its mean, such a curve describes the noise of a few samples.
  bool fine = false;
  std::string sampling{};  ///< how it was brought to one value a record, in words; empty where it has one
  std::vector<std::shared_ptr<const std::vector<double>>> values{};

  std::vector<const double*> pointers() const;
};

/// How the aircraft flew, and products of that.
std::vector<TestedVariable> flown_variables(const std::vector<FlightColumns>& flights);

/// The variables that all files have as time series, without what a simulation holds as the truth.
///
/// Of a variable with several samples a record the mean is taken (of an angle on the circle). What has a
/// value in every so many records only is interpolated in between, an angle held.
/// @param files of which each of `flights` is a part; @param without names that are left out
std::vector<TestedVariable> recorded_variables(const FlightSet& files,
                                               const std::vector<FlightColumns>& flights,
                                               const std::set<std::string>& without);

}  // namespace pcor::internal

#pragma once

#include <memory>
#include <set>
#include <string>
#include <vector>

#include <pcor/campaign/flight_set.hpp>
#include "campaign/columns.hpp"

namespace pcor::internal {

/// Variable that may explain structure, with a value at every analysed record of the local flights of a rank.
struct TestedVariable {
  std::string name;
  std::string unit{};
  std::string description{};
  bool in_file = false;
  /// Whether a line in it may be a cause alone: recorded variables, and the excess power of the aircraft.
  bool may_be_cause = false;
  /// Full turn of an angle that covers all directions, in its unit; 0 for other variables.
  double turn = 0.0;
  /// Whether a curve against the variable may have many bends, as with heights and speeds. With a variable
  /// that is rarely far from its mean, such a curve would describe the noise of a few samples.
  bool fine = false;
  std::string sampling{};  ///< description of the resampling to one value per record; empty if not resampled
  std::vector<std::shared_ptr<const std::vector<double>>> values{};

  /// Description without values, as the first file gives it to all ranks.
  template <class Archive>
  void serialize(Archive& archive) {
    archive(name, unit, description, turn, sampling);
  }
};

/// Motion of the aircraft, and products of motion variables.
std::vector<TestedVariable> quantity_variables(const std::vector<FlightColumns>& flights);

/// Time-series variables present in all files, without the truth of a simulation.
///
/// Variables with several samples per record are averaged (angles on the circle). Variables with a lower rate
/// are interpolated; angles are held.
/// @param files sources of `flights` @param without names to exclude
std::vector<TestedVariable> recorded_variables(const FlightSet& files,
                                               const std::vector<FlightColumns>& flights,
                                               const std::set<std::string>& without);

/// Variables of a flight that are computed, directly or indirectly, from any of `sensors` or from the inputs
/// of these, according to the attribute `Dependencies` of NCAR files ("3 PSXC QCXC ATX": number and names).
/// The sensors and their inputs are excluded. Empty if the file has no such attribute.
std::set<std::string> computed_from(const Flight& flight, const std::set<std::string>& sensors);

}  // namespace pcor::internal

#pragma once

#include <vector>

#include <pcor/campaign/flight_set.hpp>
#include <pcor/diagnose/diagnose.hpp>

namespace pcor::internal {

/// The dates on which a step of an effect is tried: the begins of flights after the first, as the role date
/// has them. Each is a candidate of its own, so that of many flights some are tried that are spread over
/// them, closer to each other at both ends, and where a step is found, those around it.
class StepDates {
 public:
  explicit StepDates(const FlightSet& flights);
  explicit StepDates(std::vector<double> begins);

  /// Those to be tried now, ascending.
  const std::vector<double>& tried() const { return tried_; }

  /// Adds dates that lie nearer to the steps that were found than any that was tried.
  /// @return whether there are any
  bool refine(const std::vector<Finding>& findings);

 private:
  std::vector<double> begins_{};
  std::vector<double> tried_{};
};

/// The dates of steps that effects have, each once, ascending.
std::vector<double> dates_of(const std::vector<ModelEffect>& effects);

}  // namespace pcor::internal

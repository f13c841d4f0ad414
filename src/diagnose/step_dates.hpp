#pragma once

#include <vector>

#include <pcor/campaign/flight_set.hpp>
#include <pcor/diagnose/diagnose.hpp>

namespace pcor::internal {

/// Dates on which a step of an effect is tried: starts of flights after the first, in the unit of the role
/// date. Each date is a separate candidate. If there are many flights, a subset is tried that is denser at
/// both ends, and around any step that is found.
class StepDates {
 public:
  explicit StepDates(const FlightSet& flights);
  explicit StepDates(std::vector<double> begins);

  /// Dates to try now, ascending.
  const std::vector<double>& tried() const { return tried_; }

  /// Adds untried dates closer to the steps that were found.
  /// @return whether any were added
  bool refine(const std::vector<Finding>& findings);

 private:
  std::vector<double> begins_{};
  std::vector<double> tried_{};
};

/// Unique dates of steps in effects, ascending.
std::vector<double> dates_of(const std::vector<ModelEffect>& effects);

}  // namespace pcor::internal

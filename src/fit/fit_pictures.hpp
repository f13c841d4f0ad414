#pragma once

#include <optional>
#include <string>
#include <vector>

#include <pcor/fit/refit.hpp>
#include <pcor/report/report.hpp>

namespace pcor::internal {

/// Fitted coefficients with their errors and previous values, each on a separate scale; empty if nothing was
/// fitted.
std::optional<DotPanel> coefficient_picture(const std::vector<FittedParameter>& parameters,
                                            const std::string& before_is, const std::string& after_is);

/// Adds a sentence to the summary of a report if a held-out part is biased.
void summarise_held_out(Report& report, const std::vector<FlightFit>& flights);

/// Adds the picture of the held-out parts to a report, if there are any.
void add_held_out(Report& report, const std::vector<FlightFit>& flights);

}  // namespace pcor::internal

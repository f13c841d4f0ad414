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

}  // namespace pcor::internal

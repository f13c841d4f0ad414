#pragma once

#include <optional>
#include <string>
#include <vector>

#include <pcor/fit/refit.hpp>
#include <pcor/report/report.hpp>

namespace pcor::internal {

/// The fitted coefficients with their errors beside what they were, each on a scale of its own; none where
/// nothing was fitted.
std::optional<DotPanel> coefficient_picture(const std::vector<FittedParameter>& parameters,
                                            const std::string& before_is, const std::string& after_is);

}  // namespace pcor::internal

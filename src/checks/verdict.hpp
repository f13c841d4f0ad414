#pragma once

#include <string>
#include <vector>

#include <pcor/checks/check.hpp>
#include "numerics/least_squares.hpp"

namespace pcor::internal {

/// Verdict on a number that is zero without errors. `size` is the tolerance.
///
/// Inconsistent: larger than `size` and than three standard errors. Consistent: not larger than `size`, and
/// more than two standard errors below it. Otherwise, and for NaN, inconclusive.
CheckVerdict classify(const Estimate& number, double size);

/// Number with its verdict, unit and description.
TestStatistic test_statistic(const Estimate& number, double size, std::string unit, std::string what);

/// Sets the verdict of a check that was run from several numbers: inconsistent if one is, otherwise
/// inconclusive if one is. The deciding number, with the largest ratio to its tolerance, becomes the key
/// number, and `explanation` states the reason.
void set_verdict(std::vector<TestStatistic> numbers, CheckResult& result);

/// Sets a verdict to inconclusive, for any number, with the given `reason`.
void mark_inconclusive(const std::string& reason, CheckResult& result);

/// Adds a number and its standard error: "offset_k" and "offset_stderr_k" for the name "offset" and the unit
/// "_k".
void add_number(const std::string& name, const std::string& unit, const Estimate& number,
                CheckResult& result);

/// Text like "+0.31 +- 0.04 hPa", so that the numbers of a table have equal decimals.
std::string format_number(const Estimate& number, const std::string& unit, int decimals = 2);

}  // namespace pcor::internal

#pragma once

#include <string>
#include <vector>

#include <pcor/checks/check.hpp>
#include "numerics/least_squares.hpp"

namespace pcor::internal {

/// The verdict on a number that would be zero if all were well. `size` is the smallest one that matters.
///
/// Inconsistent: beyond `size` and beyond three standard errors. Consistent: not beyond `size`, nor within
/// two standard errors of being so. In between, and for what is no number, it cannot be told.
CheckVerdict judge(const Estimated& number, double size);

/// The verdict on two together: inconsistent if one is, else what cannot be told if one cannot.
CheckVerdict together(CheckVerdict a, CheckVerdict b);

/// That number judged, with its unit and what it is in words.
TestStatistic judged(const Estimated& number, double size, std::string unit, std::string what);

/// Gives a check the verdict on some numbers together. The one that decided, of several the one that is
/// largest against what matters, becomes the key number, and `decided` says how it did.
void decide(std::vector<TestStatistic> numbers, CheckResult& result);

/// Takes a verdict back to one that cannot be told, whatever the number, because of `reason`.
void withhold(const std::string& reason, CheckResult& result);

/// "+0.31 +- 0.04 hPa".
std::string with_error(const Estimated& number, const std::string& unit, int digits = 2);

}  // namespace pcor::internal

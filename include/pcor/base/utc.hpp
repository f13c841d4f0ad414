#pragma once

#include <string>

namespace pcor {

/// A moment, seconds since 1970-01-01 00:00:00 UTC, in words; by default "2004-02-18 14:22:00".
/// Fractions of a second are cut off, but for the last
/// hundredth of a millisecond, which is rounding. `pattern` is that of strftime. A moment that is not in the
/// years 0 to 9999, or none at all, is told by its seconds.
std::string utc_text(double seconds, const char* pattern = "%Y-%m-%d %H:%M:%S");

/// The midnight (UTC) at which the day of `seconds` begins, seconds since 1970-01-01 00:00:00 UTC.
double midnight_before(double seconds);

}  // namespace pcor

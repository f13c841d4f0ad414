#pragma once

#include <string>

namespace pcor {

/// UTC time from seconds since 1970-01-01 00:00:00; by default "2004-02-18 14:22:00". Fractions of a second
/// are truncated, except rounding errors of up to 10 us. `pattern` is a strftime format. Times outside the
/// years 0 to 9999, or not finite, are formatted as seconds.
std::string utc_text(double seconds, const char* pattern = "%Y-%m-%d %H:%M:%S");

/// Midnight (UTC) at the start of the day of `seconds`, seconds since 1970-01-01 00:00:00 UTC.
double midnight_before(double seconds);

}  // namespace pcor

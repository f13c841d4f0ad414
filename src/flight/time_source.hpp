#pragma once

#include "flight/flight_file.hpp"

namespace pcor::internal {

/// Time variable of a file: seconds since 1970 UTC are `raw * scale + offset` of a variable over `dimension`.
struct TimeSource {
  int variable = 0;
  int dimension = 0;
  double scale = 1;
  double offset = 0;
};

/// Whether a time, seconds since 1970 UTC, is of the years 1900 to 2199. No other flight is known.
bool is_of_aviation(double time);

/// Whether seconds of the day restart at zero between the times of two records: the second is a day too
/// early.
bool begins_again_at_midnight(const TimeSource& source, double before, double now);

/// Finds the time variable, see Flight. @throws Error if the file has no records or no valid time.
TimeSource find_time(const FlightFile& file);

}  // namespace pcor::internal

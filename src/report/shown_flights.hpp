#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include <pcor/report/report.hpp>

namespace pcor::internal {

/// Maximum number of flights with records in a report: each sample takes about 50 bytes of its page.
constexpr std::size_t max_flights_shown = 16;

/// Flight that may be shown in the pictures of a report.
struct FlightToShow {
  double begin = 0.0;    ///< s since 1970 UTC
  double failure = 0.0;  ///< rms of its residual, hPa; NaN if unknown

  template <class Archive>
  void serialize(Archive& archive) {
    archive(begin, failure);
  }
};

/// Numbers, in increasing order, of the flights that a report shows: all flights, up to `maximum`. Otherwise
/// half are the flights with the largest residual, and half are spread over the time of the others.
std::vector<std::size_t> flights_to_show(const std::vector<FlightToShow>& flights,
                                         std::size_t maximum = max_flights_shown);

/// Keeps the records and intervals of some flights spread over time, up to `maximum`, and adds a note to the
/// summary if these are not all.
void show_flights_over_time(Report& report, std::size_t maximum = max_flights_shown);

/// Note on pictures that do not show all flights, a sentence; empty if they show all.
/// @param which description of the shown flights
std::string format_shown_flights(
    std::size_t shown, std::size_t flights,
    const std::string& which = "the flights with the largest residuals, and others spread over the campaign");

}  // namespace pcor::internal

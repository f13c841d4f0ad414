#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include <pcor/report/report.hpp>

namespace pcor::internal {

/// Of how many flights a report holds the records: each sample is some 50 bytes of its page.
constexpr std::size_t max_flights_shown = 16;

/// A flight, as it may be chosen for the pictures of a report.
struct FlightToShow {
  double begin = 0.0;    ///< s since 1970 UTC
  double failure = 0.0;  ///< rms of its residual, hPa; NaN where it has none

  template <class Archive>
  void serialize(Archive& archive) {
    archive(begin, failure);
  }
};

/// The numbers, in their order, of the flights that a report shows: all of up to `most`. Of more, half are
/// those with the largest residual, and half are spread over the time in which the others were flown.
std::vector<std::size_t> flights_to_show(const std::vector<FlightToShow>& flights,
                                         std::size_t most = max_flights_shown);

/// As `flights_to_show` where nothing says which are the worst: of many those that are spread over time.
/// @param begins of the flights, s since 1970 UTC
std::vector<std::size_t> flights_over_time(const std::vector<double>& begins,
                                           std::size_t most = max_flights_shown);

/// Leaves the records and intervals of `flights_over_time`, and says so in the summary.
void show_flights_over_time(Report& report, std::size_t most = max_flights_shown);

/// What a reader has to know of pictures that do not show all flights, a sentence; empty where they do.
/// @param which the flights that are shown are
std::string shown_text(std::size_t shown, std::size_t flights,
                       const std::string& which =
                           "those with the largest residuals, and others spread over "
                           "the time in which they were flown");

}  // namespace pcor::internal

#pragma once

#include <cstddef>
#include <vector>

namespace pcor::internal {

/// A flight, as it may be chosen for the noise that all share.
struct NoiseFlight {
  double begin = 0.0;    ///< time of its first bin, s since 1970 UTC
  std::size_t bins = 0;  ///< number of bins with a value of its residual

  template <class Archive>
  void serialize(Archive& archive) {
    archive(begin, bins);
  }
};

/// Numbers, in increasing order, of the flights that determine the common part of the noise: all flights with
/// bins, up to `maximum`. If there are more, at most `maximum`, spread over the time in which they were
/// flown, among the flights with at least a quarter of the mean number of bins, which have three quarters of
/// all bins: the choice does not depend on the order of the flights. If no flight has a bin, the first
/// flight.
std::vector<std::size_t> flights_for_noise(const std::vector<NoiseFlight>& flights, std::size_t maximum = 16);

}  // namespace pcor::internal

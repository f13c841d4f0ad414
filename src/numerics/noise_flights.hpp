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

/// Numbers, in increasing order, of the flights that determine the common part of the noise: all flights, up
/// to sixteen. For more flights, at most sixteen, spread over the time in which they were flown, among the
/// flights with a quarter of the median number of bins: the choice does not depend on the order of the
/// flights.
std::vector<std::size_t> flights_for_noise(const std::vector<NoiseFlight>& flights);

}  // namespace pcor::internal

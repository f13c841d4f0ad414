#pragma once

#include <cstddef>
#include <vector>

namespace pcor::internal {

/// A flight, as it may be chosen for the noise that all share.
struct NoiseFlight {
  double begin = 0.0;    ///< of its first bin, s since 1970 UTC
  std::size_t bins = 0;  ///< in which its residual has a value

  template <class Archive>
  void serialize(Archive& archive) {
    archive(begin, bins);
  }
};

/// The numbers, in their order, of the flights from which that part of the noise is found which all flights
/// share: all of up to sixteen. Of more at most sixteen that are spread over the time in which they were
/// flown, of those that have a quarter of the usual number of bins: the choice does not depend on the order
/// of the flights.
std::vector<std::size_t> flights_for_noise(const std::vector<NoiseFlight>& flights);

}  // namespace pcor::internal

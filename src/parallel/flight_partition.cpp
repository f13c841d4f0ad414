#include "parallel/flight_partition.hpp"

#include <numeric>

namespace pcor {

FlightPartition::FlightPartition(std::size_t flights) : comm_(&serial_communicator()), owner_(flights, 0) {}

FlightPartition::FlightPartition(Communicator& comm, const std::vector<std::uint64_t>& sizes)
    : comm_(&comm), owner_(sizes.size(), 0) {
  std::vector<std::size_t> longest_first(sizes.size());
  std::iota(longest_first.begin(), longest_first.end(), std::size_t{0});
  std::stable_sort(longest_first.begin(), longest_first.end(),
                   [&sizes](std::size_t a, std::size_t b) { return sizes[a] > sizes[b]; });
  std::vector<std::uint64_t> load(comm.size(), 0);
  for (const std::size_t flight : longest_first) {
    const auto minimum = std::min_element(load.begin(), load.end());
    owner_[flight] = static_cast<std::size_t>(minimum - load.begin());
    *minimum += std::max<std::uint64_t>(sizes[flight], 1);
  }
}

FlightPartition FlightPartition::of_entries(const std::vector<std::size_t>& flight_of_each) const {
  FlightPartition share = *this;
  share.owner_.clear();
  for (const std::size_t flight : flight_of_each) share.owner_.push_back(owner_[flight]);
  return share;
}

FlightPartition FlightPartition::with(const FlightPartition& more) const {
  FlightPartition share = *this;
  share.owner_.insert(share.owner_.end(), more.owner_.begin(), more.owner_.end());
  return share;
}

FlightPartition FlightPartition::part(std::size_t first, std::size_t count) const {
  std::vector<std::size_t> flights(count);
  std::iota(flights.begin(), flights.end(), first);
  return of_entries(flights);
}

namespace internal {

FlightPartition partition_flights(Communicator& comm, const std::vector<std::filesystem::path>& paths) {
  std::vector<std::uint64_t> sizes;
  std::uint64_t names = paths.size();
  for (const std::filesystem::path& path : paths) {
    names = digest_of(path.string(), names);
    std::error_code unknown;
    const std::uintmax_t size = std::filesystem::file_size(path, unknown);
    sizes.push_back(unknown ? 0 : size);
  }
  if (comm.size() > 1)
    sizes = unpacked<std::vector<std::uint64_t>>(comm.gather(packed(sizes), names).front());
  return {comm, sizes};
}

}  // namespace internal

}  // namespace pcor

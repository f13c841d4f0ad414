#include "parallel/flight_partition.hpp"

#include <deque>
#include <future>
#include <numeric>

namespace pcor {

namespace {

/// Error of one flight.
class FlightError : public Error {
 public:
  FlightError(const Error& error, std::size_t number) : Error(error), flight_(number) {}

  std::size_t flight() const { return flight_; }  ///< its number

 private:
  std::size_t flight_;
};

/// @throws FlightError for an error of the work on a flight
template <class Work>
void attempt_flight(std::size_t flight, const Work& work) {
  try {
    work();
  } catch (const Error& error) {
    throw FlightError(error, flight);
  }
}

}  // namespace

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
  FlightPartition partition = *this;
  partition.owner_.clear();
  for (const std::size_t flight : flight_of_each) partition.owner_.push_back(owner_[flight]);
  return partition;
}

FlightPartition FlightPartition::with(const FlightPartition& more) const {
  FlightPartition partition = *this;
  partition.owner_.insert(partition.owner_.end(), more.owner_.begin(), more.owner_.end());
  return partition;
}

FlightPartition FlightPartition::part(std::size_t first, std::size_t count) const {
  std::vector<std::size_t> flights(count);
  std::iota(flights.begin(), flights.end(), first);
  return of_entries(flights);
}

void FlightPartition::attempt(const std::function<void()>& work) const {
  try {
    work();
  } catch (const FlightError& error) {
    comm_->fail(error, error.flight() + 1);
  } catch (const Error& error) {
    comm_->fail(error, 0);
  }
}

void FlightPartition::visit(std::size_t threads,
                            const std::function<std::function<void()>(std::size_t flight)>& prepare) const {
  std::deque<std::pair<std::size_t, std::future<void>>> working;
  const auto finish_first = [&working] {
    auto [flight, result] = std::move(working.front());
    working.pop_front();
    attempt_flight(flight, [&result = result] { result.get(); });
  };
  const auto policy = threads > 1 ? std::launch::async : std::launch::deferred;
  for (std::size_t flight = 0; flight < flights(); ++flight) {
    if (!is_local(flight)) continue;
    std::function<void()> work;
    try {
      attempt_flight(flight, [&] { work = prepare(flight); });
    } catch (const FlightError&) {
      while (!working.empty()) finish_first();  // an earlier flight fails first
      throw;
    }
    if (working.size() == threads) finish_first();
    working.emplace_back(flight, std::async(policy, std::move(work)));
    if (threads == 1) finish_first();
  }
  while (!working.empty()) finish_first();
}

void FlightPartition::gather(const std::function<std::string(std::size_t)>& bytes_of, std::uint64_t state,
                             const std::function<void(std::size_t, internal::Deserializer&)>& take) const {
  std::string bytes;
  for (std::size_t flight = 0; flight < flights(); ++flight) {
    if (is_local(flight)) bytes += bytes_of(flight);
  }
  const std::vector<std::string> all = comm_->all_gather(bytes, state);
  std::deque<internal::Deserializer> ranks(all.begin(), all.end());
  for (std::size_t flight = 0; flight < flights(); ++flight) take(flight, ranks[owner_[flight]]);
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
    sizes = deserialized<std::vector<std::uint64_t>>(comm.all_gather(serialized(sizes), names).front());
  return {comm, sizes};
}

}  // namespace internal

}  // namespace pcor

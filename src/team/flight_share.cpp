#include "team/flight_share.hpp"

#include <algorithm>
#include <numeric>

namespace pcor::internal {

FlightShare::FlightShare(std::size_t flights) : team_(&alone()), owner_(flights, 0), own_(flights) {}

FlightShare::FlightShare(Team& team, const std::vector<std::uint64_t>& sizes)
    : team_(&team), owner_(sizes.size(), 0) {
  std::vector<std::size_t> longest_first(sizes.size());
  std::iota(longest_first.begin(), longest_first.end(), std::size_t{0});
  std::stable_sort(longest_first.begin(), longest_first.end(),
                   [&sizes](std::size_t a, std::size_t b) { return sizes[a] > sizes[b]; });
  std::vector<std::uint64_t> load(team.size(), 0);
  for (const std::size_t flight : longest_first) {
    const auto least = std::min_element(load.begin(), load.end());
    owner_[flight] = static_cast<std::size_t>(least - load.begin());
    *least += std::max<std::uint64_t>(sizes[flight], 1);
  }
  own_ = static_cast<std::size_t>(std::count(owner_.begin(), owner_.end(), team.rank()));
}

FlightShare FlightShare::of_entries(const std::vector<std::size_t>& flight_of_each) const {
  FlightShare share(flight_of_each.size());
  share.team_ = team_;
  for (std::size_t entry = 0; entry < share.flights(); ++entry)
    share.owner_[entry] = owner_[flight_of_each[entry]];
  share.own_ = static_cast<std::size_t>(std::count(share.owner_.begin(), share.owner_.end(), team_->rank()));
  return share;
}

FlightShare FlightShare::with(const FlightShare& more) const {
  FlightShare share = *this;
  share.owner_.insert(share.owner_.end(), more.owner_.begin(), more.owner_.end());
  share.own_ += more.own_;
  return share;
}

FlightShare FlightShare::part(std::size_t first, std::size_t count) const {
  std::vector<std::size_t> flights(count);
  std::iota(flights.begin(), flights.end(), first);
  return of_entries(flights);
}

FlightShare share_of_flights(Team& team, const std::vector<std::filesystem::path>& paths) {
  std::vector<std::uint64_t> sizes;
  std::uint64_t names = paths.size();
  for (const std::filesystem::path& path : paths) {
    names = digest_of(path.string(), names);
    std::error_code unknown;
    const std::uintmax_t size = std::filesystem::file_size(path, unknown);
    sizes.push_back(unknown ? 0 : size);
  }
  if (team.size() > 1)
    sizes = unpacked<std::vector<std::uint64_t>>(team.gather(packed(sizes), names).front());
  return {team, sizes};
}

}  // namespace pcor::internal

#include "diagnose/flight_files.hpp"

#include <utility>

#include "roles/aircraft_family.hpp"

namespace pcor::internal {

FlightFiles::FlightFiles(Team& team, const std::vector<std::filesystem::path>& paths, TimeStamp time_stamp)
    : share_(share_of_flights(team, paths)), paths_(paths), time_stamp_(time_stamp), kept_(paths.size()) {
  constexpr std::size_t most_kept = 16;
  std::size_t own = 0;
  outlines_ = share_.of_each_flight<FileOutline>([&](std::size_t number) {
    Flight file(paths[number], time_stamp);
    FileOutline outline{file.aircraft(), family_of(file).name, file.time_variable(), file.time().first};
    if (own++ < most_kept) kept_[number].emplace(std::move(file));
    return outline;
  });
}

const Flight& FlightFiles::operator[](std::size_t flight) const {
  if (kept_[flight]) return *kept_[flight];
  if (!last_ || number_of_last_ != flight) {
    last_.reset();
    last_.emplace(paths_[flight], time_stamp_);
    number_of_last_ = flight;
  }
  return *last_;
}

}  // namespace pcor::internal

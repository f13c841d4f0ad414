#include "diagnose/flight_files.hpp"

#include "roles/aircraft_family.hpp"

namespace pcor::internal {

FlightFiles::FlightFiles(Team& team, const std::vector<std::filesystem::path>& paths, TimeStamp time_stamp)
    : share_(share_of_flights(team, paths)), files_(paths.size()) {
  outlines_ = share_.of_each_flight<FileOutline>([&](std::size_t number) {
    const Flight& file = files_[number].emplace(paths[number], time_stamp);
    return FileOutline{file.aircraft(), family_of(file).name, file.time_variable(), file.time().first};
  });
}

}  // namespace pcor::internal

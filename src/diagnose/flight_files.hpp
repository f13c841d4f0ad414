#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <pcor/flight/flight.hpp>
#include "team/flight_share.hpp"

namespace pcor::internal {

/// What all members of a team know of the file of a flight.
struct FileOutline {
  std::string aircraft{};  ///< as the file says; may be empty
  std::string family{};    ///< of its names of variables
  std::string time_variable{};
  double begin = 0.0;  ///< s since 1970 UTC

  template <class Archive>
  void serialize(Archive& archive) {
    archive(aircraft, family, time_variable, begin);
  }
};

/// The files of some flights. Each member of a team has its own open.
class FlightFiles {
 public:
  FlightFiles() = default;  // of no flight

  /// @throws Error that of the first file that cannot be opened, by any member
  FlightFiles(Team& team, const std::vector<std::filesystem::path>& paths, TimeStamp time_stamp);

  const FlightShare& share() const { return share_; }
  std::size_t count() const { return outlines_.size(); }
  /// One of the own files.
  const Flight& operator[](std::size_t flight) const { return *files_[flight]; }
  const std::vector<FileOutline>& outlines() const { return outlines_; }

 private:
  FlightShare share_ = FlightShare(0);
  std::vector<std::optional<Flight>> files_{};
  std::vector<FileOutline> outlines_{};
};

}  // namespace pcor::internal

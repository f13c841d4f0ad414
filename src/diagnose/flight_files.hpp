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

/// The files of some flights. Each member of a team has the first sixteen of its own open, and opens the
/// others where they are asked for: systems limit how many files are open.
class FlightFiles {
 public:
  FlightFiles() = default;  // of no flight

  /// @throws Error that of the first file that cannot be opened, by any member
  FlightFiles(Team& team, const std::vector<std::filesystem::path>& paths, TimeStamp time_stamp);

  const FlightShare& share() const { return share_; }
  std::size_t count() const { return outlines_.size(); }
  /// One of the own files, until another is asked for. @throws Error if it has to be opened and cannot be
  const Flight& operator[](std::size_t flight) const;
  const std::vector<FileOutline>& outlines() const { return outlines_; }

 private:
  FlightShare share_ = FlightShare(0);
  std::vector<std::filesystem::path> paths_{};
  TimeStamp time_stamp_ = TimeStamp::begin;
  std::vector<std::optional<Flight>> kept_{};
  mutable std::optional<Flight> last_{};  // of those that are not kept
  mutable std::size_t number_of_last_ = 0;
  std::vector<FileOutline> outlines_{};
};

}  // namespace pcor::internal

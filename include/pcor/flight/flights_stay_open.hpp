#pragma once

#include <pcor/flight/flight.hpp>

#include <filesystem>
#include <memory>
#include <vector>

namespace pcor {

namespace internal {
class FileState;
}

/// While one lives, flights that are opened by their paths stay open, the first 16 of them: to open one of
/// netCDF-4 takes ten times as long as to read a variable of it, and a fit looks at each several times. There
/// is one at a time, and it is for one thread, as flights are. A file that was replaced or changed meanwhile
/// is opened anew.
class FlightsStayOpen {
 public:
  FlightsStayOpen();
  ~FlightsStayOpen();

  FlightsStayOpen(const FlightsStayOpen&) = delete;
  FlightsStayOpen& operator=(const FlightsStayOpen&) = delete;

 private:
  friend class Flight;

  struct Kept;

  /// What a flight is of that was opened before in the same way; null where there is none.
  static std::shared_ptr<Flight::Implementation> find(const std::filesystem::path& path, TimeStamp stamp);
  static void keep(const Flight& flight);

  std::vector<Kept> kept_;
};

}  // namespace pcor

#include <pcor/flight/flights_stay_open.hpp>

#include "flight/file_state.hpp"

namespace pcor {

namespace {

constexpr std::size_t most = 16;  // open files; HDF5 keeps 5 MB of each

FlightsStayOpen* living = nullptr;

}  // namespace

struct FlightsStayOpen::Kept {
  std::filesystem::path path;
  TimeStamp stamp;
  internal::FileState state;
  std::shared_ptr<Flight::Implementation> flight;
};

FlightsStayOpen::FlightsStayOpen() { living = this; }
FlightsStayOpen::~FlightsStayOpen() { living = nullptr; }

std::shared_ptr<Flight::Implementation> FlightsStayOpen::find(const std::filesystem::path& path,
                                                              TimeStamp stamp) {
  if (living == nullptr) return nullptr;
  for (const Kept& each : living->kept_) {
    if (each.path == path && each.stamp == stamp && each.state == internal::FileState(path))
      return each.flight;
  }
  return nullptr;
}

void FlightsStayOpen::keep(const Flight& flight) {
  if (living == nullptr || living->kept_.size() == most) return;
  living->kept_.push_back(
      {flight.path(), flight.time_stamp(), internal::FileState(flight.path()), flight.implementation_});
}

}  // namespace pcor

#include <pcor/flight/flights_stay_open.hpp>

#include <gmock/gmock.h>

#include <filesystem>
#include <optional>
#include <vector>

#include "support/netcdf_file.hpp"
#include "support/temporary_directory.hpp"

using pcor::Flight;
using pcor::FlightsStayOpen;
using pcor::TimeStamp;
using pcor::test::NetcdfMaker;

namespace {

class FlightsStayOpenTest : public testing::Test {
 protected:
  void make(const std::filesystem::path& path, const std::vector<double>& seconds = {0, 1, 2}) const {
    NetcdfMaker maker(path);
    maker.time(seconds, "seconds since 2004-02-18 00:00:00 +0000");
  }

  // How many files of this folder the process has open.
  std::size_t open_files() const {
    std::size_t count = 0;
    for (const auto& entry : std::filesystem::directory_iterator("/proc/self/fd")) {
      std::error_code gone;
      if (std::filesystem::read_symlink(entry.path(), gone).parent_path() == directory.path()) ++count;
    }
    return count;
  }

  pcor::test::TemporaryDirectory directory;
};

TEST_F(FlightsStayOpenTest, AFlightIsOpenedOnce) {
  make(directory / "a.nc");
  const FlightsStayOpen stay;
  const Flight first(directory / "a.nc");
  const Flight second(directory / "a.nc");
  EXPECT_EQ(&first.file(), &second.file());
  EXPECT_EQ(open_files(), 1U);
}

TEST_F(FlightsStayOpenTest, ItStaysOpenWhenItsFlightGoesAndIsClosedInTheEnd) {
  make(directory / "a.nc");
  std::optional<FlightsStayOpen> stay(std::in_place);
  std::optional<Flight> flight(directory / "a.nc");
  flight.reset();
  EXPECT_EQ(open_files(), 1U);
  stay.reset();
  EXPECT_EQ(open_files(), 0U);
}

TEST_F(FlightsStayOpenTest, WithoutOneEachFlightIsItsOwn) {
  make(directory / "a.nc");
  const Flight first(directory / "a.nc");
  const Flight second(directory / "a.nc");
  EXPECT_NE(&first.file(), &second.file());
}

TEST_F(FlightsStayOpenTest, AFileThatWasReplacedIsOpenedAnew) {
  make(directory / "a.nc");
  const FlightsStayOpen stay;
  EXPECT_EQ(Flight(directory / "a.nc").records(), 3U);
  make(directory / "b.nc", {0, 1, 2, 3, 4});
  std::filesystem::rename(directory / "b.nc", directory / "a.nc");
  EXPECT_EQ(Flight(directory / "a.nc").records(), 5U);
  EXPECT_EQ(Flight(directory / "a.nc").records(), 5U);
}

TEST_F(FlightsStayOpenTest, TheOtherMomentOfARecordIsAnotherFlight) {
  make(directory / "a.nc");
  const FlightsStayOpen stay;
  EXPECT_EQ(Flight(directory / "a.nc").time_stamp(), TimeStamp::begin);
  EXPECT_EQ(Flight(directory / "a.nc", TimeStamp::middle).time_stamp(), TimeStamp::middle);
}

TEST_F(FlightsStayOpenTest, NotMoreThanSixteenStayOpen) {
  const FlightsStayOpen stay;
  for (int i = 0; i < 20; ++i) {
    const std::filesystem::path path = directory / ("flight" + std::to_string(i) + ".nc");
    make(path);
    EXPECT_EQ(Flight(path).records(), 3U);
  }
  EXPECT_EQ(open_files(), 16U);
}

}  // namespace

#include <pcor/campaign/flight_set.hpp>

#include <gmock/gmock.h>
#include <pcor/base/error.hpp>

#include <filesystem>
#include <fstream>
#include <memory>
#include <string>
#include <vector>

#include "support/error_of.hpp"
#include "support/netcdf_file.hpp"
#include "support/short_flight.hpp"
#include "support/synthetic_samples.hpp"

namespace fs = std::filesystem;

namespace pcor {
namespace {

using test::error_of;
using test::IsError;
using test::NetcdfMaker;

void make(const fs::path& path, const std::vector<double>& seconds = {0, 1, 2}) {
  NetcdfMaker maker(path);
  maker.time(seconds, "seconds since 2004-02-18 00:00:00 +0000");
}

class FlightSets : public testing::Test {
 protected:
  /// Number of files of this folder that the process has open.
  std::size_t open_files() const {
    std::size_t count = 0;
    for (const auto& entry : fs::directory_iterator("/proc/self/fd")) {
      std::error_code gone;
      if (fs::read_symlink(entry.path(), gone).parent_path() == directory.path()) ++count;
    }
    return count;
  }

  std::vector<fs::path> make_flights(int count) const {
    std::vector<fs::path> paths;
    for (int i = 0; i < count; ++i) {
      paths.push_back(directory / ("flight" + std::to_string(i) + ".nc"));
      make(paths.back());
    }
    return paths;
  }

  test::TemporaryDirectory directory;
};

TEST_F(FlightSets, OpenFlightIsSharedBySubsets) {
  make(directory / "a.nc");
  make(directory / "b.nc");
  const FlightSet flights{directory / "a.nc", directory / "b.nc"};
  EXPECT_EQ(open_files(), 0U);
  const Flight& first = flights[0];
  EXPECT_EQ(&flights[0], &first);
  EXPECT_EQ(&flights.only(0)[0], &first);
  EXPECT_EQ(&flights.part(0, 1)[0], &first);
  EXPECT_EQ(&flights.part(1, 1).with(flights.part(0, 1))[1], &first);
  EXPECT_EQ(open_files(), 1U);
  EXPECT_EQ(flights.outlines().size(), 2U);
  EXPECT_EQ(open_files(), 2U);
}

TEST_F(FlightSets, AtMostSixteenFilesAreOpen) {
  const std::vector<fs::path> paths = make_flights(20);
  {
    const FlightSet flights(paths);
    for (std::size_t i = 0; i < paths.size(); ++i) EXPECT_EQ(flights[i].path(), paths[i]);
    EXPECT_EQ(open_files(), 16U);
    EXPECT_EQ(flights[0].path(), paths[0]);
    EXPECT_EQ(open_files(), 16U);
  }
  EXPECT_EQ(open_files(), 0U);
}

TEST_F(FlightSets, RefuseAReplacedChangedOrRemovedFile) {
  const auto changes = {
      +[](const fs::path& path) {
        make(path.parent_path() / "other.nc");
        fs::rename(path.parent_path() / "other.nc", path);
      },
      +[](const fs::path& path) { std::ofstream(path, std::ios::app) << "more"; },
      +[](const fs::path& path) { fs::last_write_time(path, fs::file_time_type::clock::now()); },
      +[](const fs::path& path) { fs::remove(path); }};
  for (const auto& change : changes) {
    make(directory / "a.nc");
    const FlightSet flights{directory / "a.nc"};
    EXPECT_EQ(flights[0].records(), 3U);
    flights.require_unchanged();
    change(directory / "a.nc");
    EXPECT_THAT(error_of([&] { flights.require_unchanged(); }),
                IsError(Error::Code::file, (directory / "a.nc").string()));
  }
}

TEST_F(FlightSets, RefuseAFileReplacedWhileClosed) {
  const std::vector<fs::path> paths = make_flights(17);
  const FlightSet flights(paths);
  flights.outlines();  // opens all of them, so the first is closed
  make(directory / "other.nc", {0, 1, 2, 3});
  fs::rename(directory / "other.nc", paths[0]);
  EXPECT_THAT(error_of([&] { flights[0]; }), IsError(Error::Code::file, "flight0.nc"));
}

TEST_F(FlightSets, RefuseADuplicateFlight) {
  make(directory / "a.nc");
  fs::create_symlink(directory / "a.nc", directory / "b.nc");
  const FlightSet flights{directory / "a.nc", directory / "b.nc"};
  EXPECT_THAT(error_of([&] { flights.require_each_once(); }), IsError(Error::Code::usage, "b.nc"));
}

TEST_F(FlightSets, RefuseFlightsOfTwoAircraft) {
  made::Plan plan;
  plan.samples = 60;
  plan.defect = made::equation_18;
  FlightSamples first = made::flight(plan);
  FlightSamples second = first;
  first.aircraft = "N130AR";
  second.aircraft = "N677F";
  const auto shared = [](const FlightSamples& samples) {
    return std::make_shared<const FlightSamples>(samples);
  };
  FlightSet({shared(first), shared(first)}).require_one_aircraft();
  EXPECT_THAT(error_of([&] {
                FlightSet({shared(first), shared(second)}).require_one_aircraft();
              }),
              IsError(Error::Code::usage, "N130AR", "N677F"));
}

TEST_F(FlightSets, KeepSamplesForEachSetOfRoles) {
  const fs::path& path = test::short_flight();
  ModelDefinition model = test::laser_model();
  const FlightSet flights{path};
  const MaskOptions mask;
  const auto samples = [&](const ModelDefinition& of) {
    return flights.samples(0, of, *lams_reference(), mask);
  };
  const auto first = samples(model);
  model.model.effects.front().parameters.front() += 0.001;
  EXPECT_EQ(samples(model), first) << "coefficients change no column";
  ModelDefinition shorter = model;
  shorter.model.effects.erase(shorter.model.effects.begin());
  EXPECT_EQ(samples(shorter), first) << "the remaining effects read the same quantities";
  ModelDefinition other = model;
  other.variables.erase(Quantity::vapor_pressure);
  EXPECT_NE(samples(other), first);
  MaskOptions fast = mask;
  fast.min_airspeed = 90.0;
  EXPECT_NE(flights.samples(0, model, *lams_reference(), fast), first);
  EXPECT_NE(flights.samples(0, model, *pressure_reference("PS_A"), mask), first);
  MaskOptions without_a_part = mask;
  without_a_part.excluded_times = {{first->time.front(), first->time.front() + 60.0, ""}};
  EXPECT_EQ(flights.samples(0, model, *lams_reference(), without_a_part), samples(model))
      << "excluded times change the mask only";
  const FlightSet forgetful({path}, {TimestampAlignment::begin, &serial_communicator(), 0});
  EXPECT_NE(forgetful.samples(0, model, *lams_reference(), mask),
            forgetful.samples(0, model, *lams_reference(), mask));
}

// The samples of a model without the domain were given to the model with it.
TEST_F(FlightSets, SamplesContainTheQuantitiesOfTheDomain) {
  ModelDefinition model = test::laser_model();
  model.variables[Quantity::roll] = "ROLL";
  const FlightSet flights{test::short_flight()};
  const auto has_roll = [&] {
    return flights.samples(0, model, *lams_reference(), {})->model.find(Quantity::roll) != nullptr;
  };
  EXPECT_FALSE(has_roll());
  model.model.domain.push_back({"roll", -20.0, 20.0});
  EXPECT_TRUE(has_roll());
}

}  // namespace
}  // namespace pcor

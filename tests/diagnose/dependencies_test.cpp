// Statements of files about the inputs of their computed variables.
#include "diagnose/dependencies.hpp"

#include <gmock/gmock.h>

#include "support/netcdf_file.hpp"
#include "support/temporary_directory.hpp"

using pcor::Flight;
using pcor::internal::computed_from;
using pcor::test::NetcdfMaker;
using pcor::test::TemporaryDirectory;
using testing::ElementsAre;
using testing::IsEmpty;

namespace {

/// A flight whose variables have these attributes `Dependencies`; an empty text gives no attribute.
Flight flight_of(const TemporaryDirectory& directory,
                 const std::vector<std::pair<std::string, std::string>>& dependencies) {
  const std::filesystem::path path = directory / "flight.nc";
  {
    NetcdfMaker file(path);
    file.time({0, 1, 2});
    for (const auto& [name, text] : dependencies) {
      const int variable = file.series(name, "hPa", {1, 2, 3});
      if (!text.empty()) file.text(variable, "Dependencies", text);
    }
  }
  return Flight(path);
}

TEST(ComputedFrom, FollowsChainsOfDependencies) {
  const TemporaryDirectory directory;
  // As in the files of NCAR: the temperature that is corrected by the pressures, and what is made of it.
  const Flight flight = flight_of(directory, {{"PSFD", ""},
                                              {"QCF", ""},
                                              {"TTRR", ""},
                                              {"PSXC", "1 PSFD"},
                                              {"QCXC", "1 QCF"},
                                              {"ATX", "3 TTRR PSXC QCXC"},
                                              {"THETA", "2 ATX PSXC"},
                                              {"ENGTRQ", "0"},
                                              {"GGALTC", "1 GGALT"}});
  EXPECT_THAT(computed_from(flight, {"PSFD", "QCF"}), ElementsAre("ATX", "PSXC", "QCXC", "THETA"));
  EXPECT_THAT(computed_from(flight, {"TTRR"}), ElementsAre("ATX", "THETA"));
  EXPECT_THAT(computed_from(flight, {"VLAMS"}), IsEmpty());
}

// A residual against a corrected pressure is measured with the sensors of that pressure.
TEST(ComputedFrom, IncludesVariablesFromTheSameSensors) {
  const TemporaryDirectory directory;
  const Flight flight = flight_of(directory, {{"PSFD", ""}, {"PSXC", "1 PSFD"}, {"PALT", "1 PSFD"}});
  EXPECT_THAT(computed_from(flight, {"PSXC"}), ElementsAre("PALT"));
}

TEST(ComputedFrom, CircularDependenciesEnd) {
  const TemporaryDirectory directory;
  const Flight flight = flight_of(directory, {{"PSFD", ""}, {"LATC", "2 LONC PSFD"}, {"LONC", "1 LATC"}});
  EXPECT_THAT(computed_from(flight, {"PSFD"}), ElementsAre("LATC", "LONC"));
}

}  // namespace

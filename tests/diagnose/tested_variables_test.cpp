// Variables for the test of unexplained structure, brought to one value a record, and statements of files
// about the inputs of their computed variables.
#include "diagnose/tested_variables.hpp"

#include <gmock/gmock.h>

#include <cmath>

#include "numerics/missing.hpp"
#include "support/netcdf_file.hpp"
#include "support/temporary_directory.hpp"

namespace pcor::internal {
namespace {

constexpr std::size_t records = 60;

class RecordedVariables : public testing::Test {
 protected:
  /// Tested values of the variable V of a flight with no other variables.
  TestedVariable read(const std::string& units, const std::vector<double>& values, int rate = 1,
                      const std::vector<double>& circle = {}) {
    const std::filesystem::path path = directory_ / "flight.nc";
    {
      test::NetcdfMaker file(path);
      std::vector<double> time(records);
      for (std::size_t i = 0; i < records; ++i) time[i] = static_cast<double>(i);
      file.time(time);
      const int variable = file.series("V", units, values, rate);
      if (!circle.empty()) file.numbers(variable, "modulus_range", NC_FLOAT, circle);
    }
    const FlightSet files{path};
    const FlightColumns flight;
    // The same flight twice, as two references see it.
    std::vector<TestedVariable> all = recorded_variables(files, {flight, flight}, {"Time"});
    EXPECT_EQ(all.size(), 1U);
    EXPECT_EQ(all.front().values.size(), 2U);
    EXPECT_EQ(all.front().values[0], all.front().values[1]);
    return all.front();
  }

 private:
  test::TemporaryDirectory directory_;
};

TEST_F(RecordedVariables, HigherRatesAreAveraged) {
  std::vector<double> values(5 * records);
  for (std::size_t i = 0; i < values.size(); ++i) values[i] = static_cast<double>(i);
  const TestedVariable variable = read("percent", values, 5);
  EXPECT_EQ(variable.values[0]->at(1), 7.0);
  EXPECT_THAT(variable.sampling, testing::HasSubstr("means of 5 samples"));
}

TEST_F(RecordedVariables, LowerRatesAreInterpolated) {
  std::vector<double> values(records, nan);
  for (std::size_t i = 0; i < records; i += 10) values[i] = static_cast<double>(i);
  const TestedVariable variable = read("percent", values);
  EXPECT_NEAR(variable.values[0]->at(37), 37.0, 1e-5);  // floats in the file
  EXPECT_TRUE(std::isnan(variable.values[0]->at(55)));  // after the last
  EXPECT_THAT(variable.sampling, testing::HasSubstr("one value in 10 records, interpolated"));
}

// Spellings of degrees of a temperature and of an angular rate; the values are not angles, which are held.
TEST_F(RecordedVariables, DegreesOfOtherQuantitiesAreInterpolated) {
  std::vector<double> values(records, nan);
  for (std::size_t i = 0; i < records; i += 10) values[i] = 4.0 * static_cast<double>(i);
  for (const char* const unit : {"degC", "degree_Celsius", "degrees_C", "degF", "deg/s"}) {
    const TestedVariable variable = read(unit, values);
    EXPECT_NEAR(variable.values[0]->at(37), 148.0, 1e-4) << unit;  // floats in the file
    EXPECT_THAT(variable.sampling, testing::HasSubstr("interpolated")) << unit;
    EXPECT_EQ(variable.turn, 0.0) << unit;
  }
  EXPECT_THAT(read("degrees_true", values).sampling, testing::HasSubstr("held"));
}

TEST_F(RecordedVariables, GapsAreKept) {
  std::vector<double> values(records, 1.0);
  for (std::size_t i = 20; i < 55; ++i) values[i] = nan;
  const TestedVariable variable = read("percent", values);
  EXPECT_TRUE(std::isnan(variable.values[0]->at(30)));
  EXPECT_EQ(variable.sampling, "");
}

TEST_F(RecordedVariables, VariablesThatCoverTheCircleAreAngles) {
  std::vector<double> heading(records);
  std::vector<double> attack(records);
  for (std::size_t i = 0; i < records; ++i) {
    heading[i] = std::fmod(20.0 * static_cast<double>(i), 360.0);
    attack[i] = 0.1 * static_cast<double>(i);
  }
  EXPECT_EQ(read("degree_T", heading).turn, 360.0);
  EXPECT_EQ(read("degree", attack).turn, 0.0);
  for (const char* const unit : {"percent", "radian", "1"}) EXPECT_EQ(read(unit, heading).turn, 0.0) << unit;
  for (double& value : heading) value /= 15.0;
  EXPECT_EQ(read("hours", heading, 1, {0.0, 24.0}).turn, 24.0);
}

/// A flight whose variables have these attributes `Dependencies`; an empty text gives no attribute.
Flight flight_of(const test::TemporaryDirectory& directory,
                 const std::vector<std::pair<std::string, std::string>>& dependencies) {
  const std::filesystem::path path = directory / "flight.nc";
  {
    test::NetcdfMaker file(path);
    file.time({0, 1, 2});
    for (const auto& [name, text] : dependencies) {
      const int variable = file.series(name, "hPa", {1, 2, 3});
      if (!text.empty()) file.text(variable, "Dependencies", text);
    }
  }
  return Flight(path);
}

TEST(ComputedFrom, FollowsChainsOfDependencies) {
  const test::TemporaryDirectory directory;
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
  EXPECT_THAT(computed_from(flight, {"PSFD", "QCF"}), testing::ElementsAre("ATX", "PSXC", "QCXC", "THETA"));
  EXPECT_THAT(computed_from(flight, {"TTRR"}), testing::ElementsAre("ATX", "THETA"));
  EXPECT_THAT(computed_from(flight, {"VLAMS"}), testing::IsEmpty());
}

// A residual against a corrected pressure is measured with the sensors of that pressure.
TEST(ComputedFrom, IncludesVariablesFromTheSameSensors) {
  const test::TemporaryDirectory directory;
  const Flight flight = flight_of(directory, {{"PSFD", ""}, {"PSXC", "1 PSFD"}, {"PALT", "1 PSFD"}});
  EXPECT_THAT(computed_from(flight, {"PSXC"}), testing::ElementsAre("PALT"));
}

TEST(ComputedFrom, CircularDependenciesEnd) {
  const test::TemporaryDirectory directory;
  const Flight flight = flight_of(directory, {{"PSFD", ""}, {"LATC", "2 LONC PSFD"}, {"LONC", "1 LATC"}});
  EXPECT_THAT(computed_from(flight, {"PSFD"}), testing::ElementsAre("LATC", "LONC"));
}

}  // namespace
}  // namespace pcor::internal

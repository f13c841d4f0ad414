#include <pcor/inspect/inspect.hpp>

#include <gmock/gmock.h>
#include <pcor/base/error.hpp>
#include <pcor/simulate/simulate.hpp>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <string>
#include <variant>
#include <vector>

#include "support/netcdf_file.hpp"
#include "support/says.hpp"
#include "support/temporary_directory.hpp"

namespace {

using pcor::InspectedRole;
using pcor::Inspection;
using pcor::MissingRole;
using testing::AllOf;
using testing::Contains;
using testing::ElementsAre;
using testing::Field;
using testing::IsEmpty;
using testing::Not;

const std::filesystem::path data = std::filesystem::path(PCOR_SOURCE_DIR) / "data";

testing::Matcher<const InspectedRole&> role(const std::string& name, const std::string& variable) {
  return AllOf(Field(&InspectedRole::role, name), Field(&InspectedRole::variable, variable));
}

/// A C-130 of one hour whose static pressure is constant, with the given further variables.
std::filesystem::path flight_with(const pcor::test::TemporaryDirectory& folder,
                                  const std::vector<std::pair<std::string, std::string>>& variables) {
  const std::filesystem::path path = folder / "flight.nc";
  pcor::test::NetcdfMaker maker(path);
  maker.text(NC_GLOBAL, "Platform", "N130AR");
  maker.time(pcor::test::sequence(0, 60));
  for (const auto& [name, unit] : variables)
    maker.series(name, unit, pcor::test::sequence(name[0] == 'P' ? 700.0 : 60.0, 60));
  return path;
}

}  // namespace

TEST(Inspect, FindsVariablesAndRegimesOfASimulatedFlight) {
  const pcor::test::TemporaryDirectory folder;
  pcor::simulate_flight(pcor::read_scenario(data / "scenarios" / "c130-short.toml"), folder / "flight.nc");
  const Inspection inspection = pcor::inspect_flight(folder / "flight.nc");
  EXPECT_THAT(inspection.roles, Contains(role("static_pressure", "PSFD")));
  EXPECT_THAT(inspection.roles, Contains(role("dynamic_pressure", "QCF")));
  EXPECT_THAT(inspection.problems, IsEmpty());
  EXPECT_THAT(inspection.frozen, IsEmpty());
  EXPECT_THAT(inspection.references, ElementsAre("lams"));
  // The scenario has one pitch and one yaw manoeuvre.
  for (const pcor::Regime regime : {pcor::Regime::pitch_manoeuvre, pcor::Regime::yaw_manoeuvre})
    EXPECT_THAT(inspection.intervals, Contains(Field(&pcor::Interval::regime, regime)));
  ASSERT_TRUE(inspection.model.has_value());
  EXPECT_EQ(inspection.model->variables.at(pcor::Quantity::static_pressure), "PSFD");
}

// The advice ended with a model of zeros and an output that it did not change.
TEST(Inspect, WarnsIfNothingDeterminesTheLevel) {
  const pcor::test::TemporaryDirectory folder;
  const auto is_warned = [&](std::vector<std::pair<std::string, std::string>> variables) {
    const Inspection inspection = pcor::inspect_flight(flight_with(folder, variables));
    return std::count_if(inspection.notes.begin(), inspection.notes.end(), [](const pcor::Note& note) {
      return note.severity == pcor::Severity::warning &&
             note.text.find("level of delta-p") != std::string::npos;
    });
  };
  EXPECT_EQ(is_warned({{"PSFD", "hPa"}, {"QCF", "hPa"}}), 1);
  EXPECT_EQ(is_warned({{"PSFD", "hPa"}, {"QCF", "hPa"}, {"PS_A", "hPa"}}), 0);
  EXPECT_EQ(is_warned({{"PSFD", "hPa"}, {"QCF", "hPa"}, {"VLAMS", "m/s"}}), 0);
}

TEST(Inspect, MissingRoleStatesSearchedNamesAndConsequence) {
  const pcor::test::TemporaryDirectory folder;
  const Inspection inspection = pcor::inspect_flight(flight_with(folder, {{"PSFD", "hPa"}, {"QCF", "hPa"}}));
  const auto is = [](const char* name) { return Field(&MissingRole::role, name); };
  ASSERT_THAT(inspection.missing, Contains(is("recovery_temperature")));
  for (const MissingRole& missing : inspection.missing) {
    if (missing.role != "recovery_temperature") continue;
    EXPECT_THAT(missing.searched_names, Contains("TTX"));
    EXPECT_THAT(missing.cost, Not(IsEmpty()));
  }
  EXPECT_THAT(inspection.missing, Not(Contains(is("static_pressure"))));
  EXPECT_THAT(inspection.missing, Not(Contains(is("date")))) << "it is that of the records";
}

TEST(Inspect, ComponentsReplaceTheGroundSpeed) {
  const pcor::test::TemporaryDirectory folder;
  const auto is = [](const char* name) { return Field(&MissingRole::role, name); };
  EXPECT_THAT(pcor::inspect_flight(flight_with(folder, {{"PSFD", "hPa"}, {"QCF", "hPa"}})).missing,
              Contains(is("ground_speed")));
  const auto path =
      flight_with(folder, {{"PSFD", "hPa"}, {"QCF", "hPa"}, {"GGVEW", "m/s"}, {"GGVNS", "m/s"}});
  EXPECT_THAT(pcor::inspect_flight(path).missing, Not(Contains(is("ground_speed"))));
}

TEST(Inspect, RoleThatTheModelDoesNotReadHasARemark) {
  const pcor::test::TemporaryDirectory folder;
  const Inspection inspection = pcor::inspect_flight(
      flight_with(folder, {{"PSFD", "hPa"}, {"QCF", "hPa"}, {"TTX", "degC"}, {"ATX", "degC"}}));
  ASSERT_TRUE(inspection.model.has_value());
  EXPECT_EQ(inspection.model->variables.count(pcor::Quantity::ambient_temperature), 0U);
  EXPECT_THAT(inspection.roles, Contains(AllOf(role("ambient_temperature", "ATX"),
                                               Field(&InspectedRole::caveat, testing::HasSubstr("TTX")))));
}

TEST(Inspect, FrostPointIsReadWithoutAnotherHumidity) {
  const pcor::test::TemporaryDirectory folder;
  std::vector<std::pair<std::string, std::string>> variables{
      {"PSFD", "hPa"}, {"QCF", "hPa"}, {"frost_point", "degF"}};
  const Inspection alone = pcor::inspect_flight(flight_with(folder, variables));
  ASSERT_TRUE(alone.model.has_value());
  EXPECT_EQ(alone.model->variable_of(pcor::Quantity::frost_point), "frost_point");
  EXPECT_TRUE(alone.model->model.moist);
  variables.emplace_back("dew_point", "degF");
  const Inspection both = pcor::inspect_flight(flight_with(folder, variables));
  ASSERT_TRUE(both.model.has_value());
  EXPECT_EQ(both.model->variable_of(pcor::Quantity::dew_point), "dew_point");
  EXPECT_EQ(both.model->variable_of(pcor::Quantity::frost_point), "");
  EXPECT_THAT(both.roles, Contains(AllOf(role("frost_point", "frost_point"),
                                         Field(&InspectedRole::caveat, testing::HasSubstr("dew_point")))));
}

TEST(Inspect, ReportBeginsWithWarningsAndRoles) {
  const pcor::test::TemporaryDirectory folder;
  pcor::simulate_flight(pcor::read_scenario(data / "scenarios" / "c130-short.toml"), folder / "flight.nc");
  Inspection inspection = pcor::inspect_flight(folder / "flight.nc");
  inspection.notes = {pcor::warning_note("7 samples are wrong"), "another note"};
  const pcor::Report report = pcor::inspection_report({inspection});
  EXPECT_THAT(report.summary, ElementsAre(testing::HasSubstr("7 samples")));
  const auto first = [&report](auto is) {
    return std::find_if(report.items.begin(), report.items.end(), is) - report.items.begin();
  };
  EXPECT_LT(first([](const auto& item) { return std::holds_alternative<pcor::ReportTable>(item); }),
            first([](const auto& item) { return std::holds_alternative<pcor::TimePanel>(item); }));
}

TEST(Inspect, FlightWithoutPressuresHasNoModelAndTheReason) {
  const pcor::test::TemporaryDirectory folder;
  const Inspection inspection = pcor::inspect_flight(flight_with(folder, {{"GGALT", "m"}}));
  EXPECT_FALSE(inspection.model.has_value());
  EXPECT_THAT(inspection.why_no_model, Not(IsEmpty()));
  EXPECT_THAT(inspection.intervals, IsEmpty());
}

TEST(Inspect, UnreadableModelFileIsReportedAndOthersAreUsed) {
  const pcor::test::TemporaryDirectory folder;
  std::ofstream(folder / "broken.toml") << "not a model";
  const Inspection inspection = pcor::inspect_flight(
      flight_with(folder, {{"PSFD", "hPa"}, {"QCF", "hPa"}, {"ADIFR", "hPa"}, {"QCR", "hPa"}}),
      {folder / "broken.toml", data / "models" / "c130-psfd-eq18.toml"});
  EXPECT_THAT(inspection.notes, Contains(pcor::test::Says("broken.toml")));
  ASSERT_EQ(inspection.laws.size(), 1U);
  EXPECT_EQ(inspection.laws.front().path.filename(), "c130-psfd-eq18.toml");
}

TEST(Inspect, RefusesAFileThatIsNotAFlight) {
  const pcor::test::TemporaryDirectory folder;
  std::ofstream(folder / "text.nc") << "text";
  try {
    pcor::inspect_flight(folder / "text.nc");
    FAIL() << "no error";
  } catch (const pcor::Error& error) {
    EXPECT_EQ(error.code(), pcor::Error::Code::file);
  }
}

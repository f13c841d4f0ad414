// A second file format: the content of a flight does not depend on its storage.
#include "flight/flight_file.hpp"

#include <gmock/gmock.h>
#include <pcor/flight/flight_writer.hpp>

#include <algorithm>

#include "support/temporary_directory.hpp"
#include "support/values_of.hpp"

using pcor::Flight;
using pcor::FlightFile;
using pcor::FlightWriter;
using pcor::RecordBlock;
using pcor::test::values_of;
using testing::ElementsAre;
using testing::IsNan;

namespace {

TEST(NcattedName, MatchesThatVariableOnly) {
  using pcor::internal::ncatted_name;
  EXPECT_EQ(ncatted_name("PSFD_2-a b"), "PSFD_2-a b");
  EXPECT_EQ(ncatted_name("P.A"), "^P\\.A$");
  EXPECT_EQ(ncatted_name("O<P>"), "^O<P>$") << "an escaped < is the begin of a word";
  EXPECT_EQ(ncatted_name("E[1]+\\"), "^E\\[1\\]\\+\\\\$");
}

/// Three records over (Time) and (Time, sps2), in memory.
class MemoryFile final : public FlightFile {
 public:
  struct Variable {
    std::string name;
    std::string units;
    std::vector<double> values;
  };

  const std::filesystem::path& path() const override { return path_; }
  int variable_count() const override { return static_cast<int>(variables_.size()); }
  std::string variable_name(int variable) const override { return at(variable).name; }
  std::vector<int> dimensions_of(int variable) const override {
    return at(variable).values.size() == 3 ? std::vector<int>{0} : std::vector<int>{0, 1};
  }
  std::string dimension_name(int dimension) const override { return dimension == 0 ? "Time" : "sps2"; }
  std::size_t dimension_length(int dimension) const override { return dimension == 0 ? 3 : 2; }
  std::vector<std::string> attribute_names(int variable) const override {
    return variable == whole_file ? std::vector<std::string>{} : std::vector<std::string>{"units"};
  }
  std::string text_attribute(int variable, const std::string& name) const override {
    return variable != whole_file && name == "units" ? at(variable).units : "";
  }
  std::vector<double> number_attribute(int, const std::string&) const override { return {}; }
  std::vector<double> missing_values(int) const override { return {-1.0}; }
  std::array<double, 2> valid_range(int) const override { return {-1000.0, 1e10}; }
  void read(int variable, RecordBlock records, double* out) const override {
    ++requests_;
    const std::size_t rate = at(variable).values.size() / 3;
    std::copy_n(at(variable).values.begin() + static_cast<std::ptrdiff_t>(records.first * rate),
                records.count * rate, out);
  }
  int requests() const { return requests_; }

 private:
  const Variable& at(int variable) const { return variables_.at(static_cast<std::size_t>(variable)); }

  mutable int requests_ = 0;
  std::filesystem::path path_{"memory"};
  std::vector<Variable> variables_{
      {"Time", "seconds since 2004-02-18 00:00:00 +0000", {60.0, 61.0, 62.0}},
      {"PSFD", "mb", {700.0, 700.1, 700.2, -1.0, 700.4, 700.5}},
      {"QCF", "hPa", {60.0, 61.0, 62.0}},
  };
};

TEST(FlightFile, AnyFormatIsReadAsAFlight) {
  const Flight flight(std::make_unique<MemoryFile>(), pcor::TimestampAlignment::begin);
  EXPECT_EQ(flight.records(), 3U);
  EXPECT_EQ(flight.time().first, 1077062460.0);
  EXPECT_EQ(flight.variable("PSFD").rate, 2);
  EXPECT_THAT(values_of(flight, "PSFD"), ElementsAre(700.0, 700.1, 700.2, IsNan(), 700.4, 700.5));
}

TEST(FlightFile, RepeatedReadMakesNoRequest) {
  auto file = std::make_unique<MemoryFile>();
  const MemoryFile& memory = *file;
  const Flight flight(std::move(file), pcor::TimestampAlignment::begin);
  const std::vector<double> first = values_of(flight, "PSFD");
  const int requests = memory.requests();
  EXPECT_THAT(values_of(flight, "PSFD"), testing::Pointwise(testing::NanSensitiveDoubleEq(), first));
  EXPECT_EQ(memory.requests(), requests);
  values_of(flight, "QCF");
  EXPECT_EQ(memory.requests(), requests + 1);
}

TEST(FlightFile, AnyFormatIsCopiedToNetcdf) {
  const pcor::test::TemporaryDirectory directory;
  const std::filesystem::path output = directory.path() / "out.nc";
  const Flight flight(std::make_unique<MemoryFile>(), pcor::TimestampAlignment::begin);
  FlightWriter writer(output, flight, {});
  for (const std::string& name : flight.variables()) {
    if (name != flight.time_variable()) writer.copy(name);
  }
  writer.finish();
  const Flight copied(output);
  EXPECT_EQ(copied.time().first, flight.time().first);
  EXPECT_EQ(copied.variable("PSFD").units, "mbar");
  for (const char* name : {"PSFD", "QCF"}) {
    EXPECT_THAT(values_of(copied, name),
                testing::Pointwise(testing::NanSensitiveDoubleEq(), values_of(flight, name)));
  }
}

}  // namespace

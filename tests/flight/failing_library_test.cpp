#include <gmock/gmock.h>
#include <netcdf.h>
#include <pcor/flight/flight.hpp>

#include <filesystem>
#include <new>
#include <string>

#include <pcor/base/error.hpp>
#include "flight/netcdf_file.hpp"
#include "support/of_library.hpp"
#include "support/short_flight.hpp"

using pcor::test::of_library;

namespace {

/// Simulated return code of the netCDF library for one attribute or variable; NC_NOERR: the real result.
int answer = NC_NOERR;
std::string asked_for;

bool fails(const char* name) { return answer != NC_NOERR && asked_for == name; }

}  // namespace

// These functions replace the functions of the library.
extern "C" {

int nc_inq_att(int file, int variable, const char* name, nc_type* type, std::size_t* length) {
  return fails(name) ? answer : of_library(&nc_inq_att, "nc_inq_att")(file, variable, name, type, length);
}

int nc_inq_varid(int file, const char* name, int* variable) {
  return fails(name) ? answer : of_library(&nc_inq_varid, "nc_inq_varid")(file, name, variable);
}
}

namespace pcor::internal {
namespace {

class FailingLibrary : public testing::Test {
 protected:
  ~FailingLibrary() override { answer = NC_NOERR; }

  static void fail(const char* name, int status) {
    asked_for = name;
    answer = status;
  }

  const std::filesystem::path flight_ = test::short_flight();  // made while nothing fails
};

// As if they were not there, numbers would come without their scale, or a variable would be left out.
TEST_F(FailingLibrary, FailureIsNotReportedAsAbsentAttribute) {
  for (const char* const name : {"scale_factor", "add_offset", "_FillValue", "valid_range", "units"}) {
    fail(name, NC_EHDFERR);
    EXPECT_THROW(Flight(flight_).variable("PSFD"), Error) << name;
    fail(name, NC_ENOMEM);
    EXPECT_THROW(Flight(flight_).variable("PSFD"), std::bad_alloc) << name;
    fail(name, NC_ENOTATT);
    EXPECT_NO_THROW(Flight(flight_).variable("PSFD")) << name;
  }
}

TEST_F(FailingLibrary, UnreadableAttributeErrorStatesRemedy) {
  fail("units", NC_EATTMETA);
  try {
    Flight(flight_).variable("PSFD");
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), Error::Code::file);
  }
}

TEST_F(FailingLibrary, FailureIsNotReportedAsAbsentVariable) {
  const NetcdfFile file(flight_);
  EXPECT_TRUE(file.find_variable("PSFD"));
  fail("PSFD", NC_EHDFERR);
  EXPECT_THROW(file.find_variable("PSFD"), Error);
  fail("PSFD", NC_ENOMEM);
  EXPECT_THROW(file.find_variable("PSFD"), std::bad_alloc);
  fail("PSFD", NC_ENOTVAR);
  EXPECT_FALSE(file.find_variable("PSFD"));
  // Text attributes without valid names follow the same rule.
  for (const std::string& word : {std::string(300, 'x'), std::string("a/b"), std::string("\xff")}) {
    EXPECT_FALSE(file.find_variable(word)) << word;
    EXPECT_FALSE(file.find_attribute(NC_GLOBAL, word)) << word;
  }
}

}  // namespace
}  // namespace pcor::internal

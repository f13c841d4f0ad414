#include "flight/netcdf_file.hpp"

#include <gmock/gmock.h>
#include <netcdf.h>

#include <numeric>
#include <vector>

#include "flight/classic_netcdf.hpp"
#include "support/temporary_directory.hpp"

namespace pcor::internal {
namespace {

/// A classic file with (Time, wide), (Time) and one more of both; values count up through each variable.
void write_classic(const std::filesystem::path& path, std::size_t records, std::size_t wide) {
  int file = 0, time = 0, width = 0;
  ASSERT_EQ(nc_create(path.c_str(), NC_64BIT_OFFSET, &file), NC_NOERR);
  nc_def_dim(file, "Time", NC_UNLIMITED, &time);
  nc_def_dim(file, "wide", wide, &width);
  const int over_both[] = {time, width};
  std::vector<int> variables(4);
  nc_def_var(file, "wide-1", NC_DOUBLE, 2, over_both, &variables[0]);
  nc_def_var(file, "narrow-1", NC_DOUBLE, 1, over_both, &variables[1]);
  nc_def_var(file, "wide-2", NC_DOUBLE, 2, over_both, &variables[2]);
  nc_def_var(file, "narrow-2", NC_DOUBLE, 1, over_both, &variables[3]);
  nc_enddef(file);
  for (std::size_t v = 0; v < variables.size(); ++v) {
    const std::size_t each = v % 2 == 0 ? wide : 1;
    std::vector<double> values(records * each);
    std::iota(values.begin(), values.end(), 1e6 * static_cast<double>(v));
    const std::size_t start[] = {0, 0};
    const std::size_t count[] = {records, each};
    nc_put_vara_double(file, variables[v], start, count, values.data());
  }
  ASSERT_EQ(nc_close(file), NC_NOERR);
}

class RecordsOfAClassicFile : public testing::TestWithParam<std::size_t> {};

// Small ones are read through a large buffer, large ones are brought into memory and read in small pieces,
// and the longest are not.
TEST_P(RecordsOfAClassicFile, BlocksAreReadInAnyOrder) {
  constexpr std::size_t records = 7;
  const std::size_t wide = GetParam();
  const test::TemporaryDirectory directory;
  const std::filesystem::path path = directory / "classic.nc";
  write_classic(path, records, wide);
  const auto layout = layout_of_classic(path);
  ASSERT_TRUE(layout);
  EXPECT_EQ(layout->records_begin + records * layout->record_bytes, std::filesystem::file_size(path));
  const NetcdfFile file(path);
  for (const RecordBlock block : {RecordBlock{4, 2}, {0, 3}, {6, 1}, {0, records}, {2, 0}, {1, 5}}) {
    for (int variable = 0; variable < 4; ++variable) {
      const std::size_t each = variable % 2 == 0 ? wide : 1;
      std::vector<double> expected(block.count * each);
      std::iota(expected.begin(), expected.end(), 1e6 * variable + static_cast<double>(block.first * each));
      std::vector<double> found(expected.size());
      file.read(variable, block, found.data());
      EXPECT_EQ(found, expected) << variable << " from " << block.first;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(OfAnySize, RecordsOfAClassicFile, testing::Values(1, 300, 3000, 40000, 200000));

}  // namespace
}  // namespace pcor::internal

#include "flight/file_state.hpp"

#include <gtest/gtest.h>

#include <fstream>

#include "support/temporary_directory.hpp"

namespace pcor::internal {
namespace {

TEST(FileState, IsEqualForAnUnchangedFile) {
  const test::TemporaryDirectory directory;
  const std::filesystem::path path = directory / "flight.nc";
  const FileState absent(path);
  std::ofstream(path) << "a flight";
  const FileState before(path);
  EXPECT_NE(absent, before);
  EXPECT_EQ(FileState(path), before);
  std::ofstream(directory / "copy.nc") << "a flight";
  EXPECT_NE(FileState(directory / "copy.nc"), before);
}

TEST(FileState, DiffersAfterOldTimesAreRestored) {
  const test::TemporaryDirectory directory;
  const std::filesystem::path path = directory / "flight.nc";
  std::ofstream(path) << "a flight";
  const auto modified = std::filesystem::last_write_time(path);
  const FileState before(path);
  // Clocks of file systems go in steps of some milliseconds.
  while (FileState(path) == before) {
    std::ofstream(path) << "b flight";
    std::filesystem::last_write_time(path, modified);
  }
  EXPECT_EQ(std::filesystem::last_write_time(path), modified);
  EXPECT_EQ(std::filesystem::file_size(path), 8U);
}

}  // namespace
}  // namespace pcor::internal

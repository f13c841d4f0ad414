#include <pcor/base/atomic_file.hpp>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <pcor/base/error.hpp>

#include <filesystem>
#include <fstream>
#include <set>
#include <string>

#include "support/error_of.hpp"
#include "support/temporary_directory.hpp"

namespace pcor {
namespace {

using testing::IsEmpty;
using testing::UnorderedElementsAre;

std::set<std::string> names_in(const test::TemporaryDirectory& directory) {
  std::set<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(directory.path()))
    names.insert(entry.path().filename().string());
  return names;
}

void write(const std::filesystem::path& path) {
  AtomicFile file(path);
  std::ofstream(file.path()) << "new";
  file.commit();
}

TEST(OutputTransaction, FilesAppearTogether) {
  const test::TemporaryDirectory directory;
  OutputTransaction together;
  write(directory / "model");
  write(directory / "report");
  EXPECT_FALSE(std::filesystem::exists(directory / "model"));
  together.appear();
  EXPECT_THAT(names_in(directory), UnorderedElementsAre("model", "report"));
}

TEST(OutputTransaction, FailureRemovesItsFiles) {
  const test::TemporaryDirectory directory;
  {
    const OutputTransaction together;
    write(directory / "model");
    write(directory / "report");
    EXPECT_EQ(names_in(directory).size(), 2U);
  }
  EXPECT_THAT(names_in(directory), IsEmpty());
  write(directory / "model");
  EXPECT_THAT(names_in(directory), UnorderedElementsAre("model"));
}

TEST(OutputTransaction, InnerTransactionJoinsOuterTransaction) {
  const test::TemporaryDirectory directory;
  OutputTransaction whole;
  {
    OutputTransaction part;
    write(directory / "figure");
    part.appear();
  }
  write(directory / "model");
  EXPECT_FALSE(std::filesystem::exists(directory / "figure"));
  whole.appear();
  EXPECT_THAT(names_in(directory), UnorderedElementsAre("figure", "model"));
}

}  // namespace
}  // namespace pcor

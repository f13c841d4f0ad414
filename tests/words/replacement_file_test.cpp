#include <pcor/words/replacement_file.hpp>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <set>
#include <string>

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
  ReplacementFile file(path);
  std::ofstream(file.path()) << "new";
  file.commit();
}

TEST(OutputsTogether, AppearAtOnce) {
  const test::TemporaryDirectory directory;
  OutputsTogether together;
  write(directory / "model");
  write(directory / "report");
  EXPECT_FALSE(std::filesystem::exists(directory / "model"));
  together.appear();
  EXPECT_THAT(names_in(directory), UnorderedElementsAre("model", "report"));
}

TEST(OutputsTogether, DoNotAppearAfterAFailure) {
  const test::TemporaryDirectory directory;
  {
    const OutputsTogether together;
    write(directory / "model");
    write(directory / "report");
    EXPECT_EQ(names_in(directory).size(), 2U);
  }
  EXPECT_THAT(names_in(directory), IsEmpty());
  write(directory / "model");
  EXPECT_THAT(names_in(directory), UnorderedElementsAre("model"));
}

}  // namespace
}  // namespace pcor

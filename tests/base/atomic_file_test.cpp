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

TEST(OutputTransaction, FailureRemovesCreatedFolders) {
  const test::TemporaryDirectory directory;
  std::filesystem::create_directory(directory / "old");
  {
    OutputTransaction together;
    together.make_folder(directory / "old");
    together.make_folder(directory / "new" / "of" / "new");
    write(directory / "new" / "of" / "new" / "figure");
  }
  EXPECT_THAT(names_in(directory), UnorderedElementsAre("old"));
  OutputTransaction together;
  together.make_folder(directory / "new" / "of");
  write(directory / "new" / "of" / "figure");
  together.appear();
  EXPECT_TRUE(std::filesystem::exists(directory / "new" / "of" / "figure"));
}

TEST(OutputTransaction, FolderAtPathOfFileIsRejected) {
  const test::TemporaryDirectory directory;
  write(directory / "file");
  OutputTransaction together;
  EXPECT_THAT(test::error_of([&] { together.make_folder(directory / "file" / "new"); }),
              test::IsError(Error::Code::output, (directory / "file").string()));
}

TEST(OutputTransaction, OldFilesAreRemovedWhenNewFilesAppear) {
  const test::TemporaryDirectory directory;
  write(directory / "earlier");
  {
    OutputTransaction together;
    together.remove(directory / "earlier");
    write(directory / "new");
  }
  EXPECT_THAT(names_in(directory), UnorderedElementsAre("earlier"));
  OutputTransaction together;
  together.remove(directory / "earlier");
  write(directory / "new");
  together.appear();
  EXPECT_THAT(names_in(directory), UnorderedElementsAre("new"));
}

}  // namespace
}  // namespace pcor

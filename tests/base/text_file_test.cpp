#include "base/text_file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <sys/stat.h>

#include <filesystem>
#include <fstream>
#include <string>

#include <pcor/base/error.hpp>

#include "support/error_of.hpp"
#include "support/temporary_directory.hpp"

namespace pcor::internal {
namespace {

TEST(TextFile, ContentIsReadUnchanged) {
  const test::TemporaryDirectory directory;
  const std::string text{"a\r\nb\0c\n", 7};
  std::ofstream(directory / "text", std::ios::binary) << text;
  EXPECT_EQ(text_of_file(directory / "text", "a text"), text);
}

TEST(TextFile, ErrorNamesAnAbsentFile) {
  const test::TemporaryDirectory directory;
  EXPECT_THAT(test::error_of([&] { text_of_file(directory / "no\nfile", "a model file"); }),
              test::IsError(Error::Code::file, "no\\x0afile", "a model file"));
  EXPECT_THAT(test::error_of([&] { text_of_file(directory / "", "a model file"); }),
              test::IsError(Error::Code::file, directory.path().string(), "a model file"));
}

// A device may never end, and a pipe may have no writer.
TEST(TextFile, RejectsDevicesPipesAndLargeFiles) {
  const test::TemporaryDirectory directory;
  ASSERT_EQ(mkfifo((directory / "pipe").c_str(), 0600), 0);
  for (const std::filesystem::path& path : {std::filesystem::path("/dev/zero"), directory / "pipe"}) {
    EXPECT_THAT(test::error_of([&] { text_of_file(path, "a model file"); }),
                test::IsError(Error::Code::file, path.string(), "a model file"));
  }
  std::ofstream(directory / "large") << "x";
  std::filesystem::resize_file(directory / "large", (16U << 20U) + 1);
  EXPECT_THAT(test::error_of([&] { text_of_file(directory / "large", "a model file"); }),
              test::IsError(Error::Code::file, "16 MB"));
}

}  // namespace
}  // namespace pcor::internal

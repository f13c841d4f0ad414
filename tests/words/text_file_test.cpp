#include "words/text_file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <string>

#include <pcor/words/error.hpp>

#include "support/temporary_directory.hpp"

namespace pcor::internal {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::ThrowsMessage;

TEST(TextFile, IsReadToTheByte) {
  const test::TemporaryDirectory directory;
  const std::string text{"a\r\nb\0c\n", 7};
  std::ofstream(directory / "text", std::ios::binary) << text;
  EXPECT_EQ(text_of_file(directory / "text", "a text"), text);
}

TEST(TextFile, IsRefusedByNameWhereThereIsNone) {
  const test::TemporaryDirectory directory;
  EXPECT_THAT([&] { text_of_file(directory / "no\nfile", "a model file"); },
              ThrowsMessage<Error>(
                  AllOf(HasSubstr("no\\x0afile: there is no such file"), HasSubstr("a model file"))));
  EXPECT_THAT([&] { text_of_file(directory / "", "a model file"); },
              ThrowsMessage<Error>(HasSubstr("is a directory; give the path of a model file")));
}

}  // namespace
}  // namespace pcor::internal

#include "base/quoting.hpp"

#include <gtest/gtest.h>

#include <string>

#include <pcor/base/message.hpp>

namespace pcor::internal {
namespace {

TEST(OneLine, EscapesControlCharacters) {
  EXPECT_EQ(one_line("a\nb\x1b[31mc\x7f"), "a\\x0ab\\x1b[31mc\\x7f");
  EXPECT_EQ(one_line("\xc2\x9b"
                     "31m"),
            "\\xc2\\x9b31m")
      << "an escape sequence of one character";
  EXPECT_EQ(one_line(std::string("a\0b", 3)), "a\\x00b");
  EXPECT_EQ(one_line("\u2028a\u202eb\u2066c\u200f"),
            "\\xe2\\x80\\xa8a\\xe2\\x80\\xaeb\\xe2\\x81\\xa6c\\xe2\\x80\\x8f");
  EXPECT_EQ(one_line("\u2013\u2026\u2032\u2070"), "\u2013\u2026\u2032\u2070");
}

TEST(OneLine, IsTheSameInPieces) {
  static std::string line;
  put_sanitized("a\nb\xff\u20ac", [](std::string_view piece) { line += piece; });
  EXPECT_EQ(line, "a\\x0ab\\xff\u20ac");
}

TEST(OneLine, KeepsValidUtf8AndEscapesInvalidBytes) {
  EXPECT_EQ(one_line("\u00b5m\u00b3 \u20ac \U0001f6e9"), "\u00b5m\u00b3 \u20ac \U0001f6e9");
  EXPECT_EQ(one_line("\xe2\x82"), "\\xe2\\x82") << "a truncated character";
  EXPECT_EQ(one_line("\xc0\x80\xff"), "\\xc0\\x80\\xff");
}

TEST(Shortened, CutsBetweenLetters) {
  EXPECT_EQ(shortened("abc", 3), "abc");
  EXPECT_EQ(shortened("abcd", 3), "abc... (4 characters)");
  EXPECT_EQ(shortened("\u20ac\u20ac\u20ac", 2), "\u20ac\u20ac... (3 characters)");
}

TEST(InQuotes, QuotedTextIsLimitedInLength) {
  EXPECT_EQ(quote("QCF"), "'QCF'");
  EXPECT_EQ(quote(std::string(1000000, 'x')), "'" + std::string(100, 'x') + "... (1000000 characters)'");
}

}  // namespace
}  // namespace pcor::internal

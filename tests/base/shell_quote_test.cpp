#include <gtest/gtest.h>
#include <pcor/base/shell_quote.hpp>

#include <cstdio>
#include <string>

namespace pcor {
namespace {

/// Arguments that a shell reads from the text of a command.
std::string output_of(const std::string& command) {
  std::FILE* const pipe = popen(command.c_str(), "r");
  std::string text;
  for (int letter = 0; (letter = std::fgetc(pipe)) != EOF;) text += static_cast<char>(letter);
  pclose(pipe);
  return text;
}

TEST(ShellWord, ShellRestoresTheOriginalText) {
  for (const std::string word :
       {"rf01.nc", "", " ", "it's mine.toml", "$(date) `date` $HOME", "a\\b\"c", "*?[a]~", "'", "''",
        "two\nlines", "-m", "a;b|c&d>e", "k * (ENGTRQ - 50)", "#", "!x"})
    EXPECT_EQ(output_of("printf %s " + shell_quote(word)), word);
}

TEST(ShellWord, SafeTextIsNotQuoted) {
  EXPECT_EQ(shell_quote("static-qp.a2=0.03,x:/y@%+_"), "static-qp.a2=0.03,x:/y@%+_");
}

}  // namespace
}  // namespace pcor

#include <pcor/model/quality.hpp>

#include <gmock/gmock.h>

#include <set>
#include <string>

namespace {

using pcor::quality_info;
using pcor::QualityFlags;
using pcor::QualityInfo;

std::uint32_t bits_of(const QualityInfo& info) { return static_cast<std::uint32_t>(info.bit); }

TEST(QualityInfo, BitsAreConsecutiveFromTheLowest) {
  for (std::size_t i = 0; i < quality_info.size(); ++i) EXPECT_EQ(bits_of(quality_info[i]), 1U << i);
}

// A netCDF flag variable of type int, and a float of a host that has no integers, hold them all.
TEST(QualityInfo, AllBitsFitIntoAFloat) { EXPECT_LE(quality_info.size(), 24U); }

// The CF conventions, sec. 3.5: words of letters, digits and _ - . + @, separated by blanks.
TEST(QualityInfo, NamesAreValidFlagMeanings) {
  std::set<std::string> names;
  for (const QualityInfo& info : quality_info) {
    EXPECT_THAT(std::string(info.name), testing::MatchesRegex("[a-z][a-z0-9_]*"));
    EXPECT_TRUE(names.insert(std::string(info.name)).second) << info.name << " twice";
    EXPECT_FALSE(info.meaning.empty()) << info.name;
    EXPECT_FALSE(info.brief.empty()) << info.name;
    EXPECT_LE(info.brief.size(), 55U) << info.name << ": a line of process has 100 characters";
  }
}

TEST(QualityFlags, BitsAreIndependent) {
  for (const QualityInfo& set : quality_info) {
    QualityFlags flags;
    flags.set(set.bit);
    EXPECT_EQ(flags.bits(), bits_of(set));
    for (const QualityInfo& other : quality_info) EXPECT_EQ(flags.has(other.bit), set.bit == other.bit);
  }
}

TEST(QualityFlags, FalseConditionDoesNotClearABit) {
  const pcor::Quality bit = pcor::Quality::tapered;
  QualityFlags flags;
  flags.set(false, bit);
  EXPECT_FALSE(flags.has(bit));
  flags.set(true, bit);
  flags.set(false, bit);
  EXPECT_TRUE(flags.has(bit));
  flags.clear();
  EXPECT_EQ(flags.bits(), 0U);
}

}  // namespace

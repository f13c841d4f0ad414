#include <pcor/model/quality.hpp>

#include <gmock/gmock.h>

#include <set>
#include <string>

namespace {

using pcor::quality_facts;
using pcor::QualityFacts;
using pcor::QualityFlags;

std::uint32_t bits_of(const QualityFacts& facts) { return static_cast<std::uint32_t>(facts.bit); }

TEST(QualityFacts, HasOneBitForEachFromTheLowest) {
  for (std::size_t i = 0; i < quality_facts.size(); ++i) EXPECT_EQ(bits_of(quality_facts[i]), 1U << i);
}

// A netCDF flag variable of type int, and a float of a host that has no integers, hold them all.
TEST(QualityFacts, FitsAFloat) { EXPECT_LE(quality_facts.size(), 24U); }

// The CF conventions, sec. 3.5: words of letters, digits and _ - . + @, separated by blanks.
TEST(QualityFacts, HasNamesThatAreFlagMeanings) {
  std::set<std::string> names;
  for (const QualityFacts& facts : quality_facts) {
    EXPECT_THAT(std::string(facts.name), testing::MatchesRegex("[a-z][a-z0-9_]*"));
    EXPECT_TRUE(names.insert(std::string(facts.name)).second) << facts.name << " twice";
    EXPECT_FALSE(facts.meaning.empty()) << facts.name;
  }
}

TEST(QualityFlags, KeepsEachBitApart) {
  for (const QualityFacts& set : quality_facts) {
    QualityFlags flags;
    flags.set(set.bit);
    EXPECT_EQ(flags.bits(), bits_of(set));
    for (const QualityFacts& other : quality_facts) EXPECT_EQ(flags.has(other.bit), set.bit == other.bit);
  }
}

TEST(QualityFlags, IsSetWhereTheConditionHoldsAndStaysSet) {
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

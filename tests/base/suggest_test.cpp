#include <gmock/gmock.h>
#include <pcor/base/suggest.hpp>

using pcor::did_you_mean;
using pcor::suggest;
using testing::ElementsAre;
using testing::IsEmpty;

TEST(Suggest, OffersSimilarVariablesOfTheFile) {
  EXPECT_THAT(suggest("QCF", {"PSFD", "QCX", "TASX", "QCR", "QCFR", "GGALT"}),
              ElementsAre("QCFR", "QCR", "QCX"));
}

TEST(Suggest, IgnoresCase) { EXPECT_THAT(suggest("psfd", {"QCF", "PSFD"}), ElementsAre("PSFD")); }

TEST(Suggest, CountsASwapAsOneChange) {
  EXPECT_THAT(suggest("imrpove", {"refit", "improve", "compare"}), ElementsAre("improve"));
}

TEST(Suggest, PrefixSuggestsTheLongName) {
  EXPECT_THAT(suggest("temp", {"simulate", "temperature"}), ElementsAre("temperature"));
}

TEST(Suggest, PartSuggestsTheLongName) {
  EXPECT_THAT(suggest("psfrd", {"c130-psfd-2014", "c130-psfrd-2003", "gv-psf-2014"}),
              ElementsAre("c130-psfrd-2003"));
}

TEST(Suggest, EquallyCloseNamesPreferCommonPrefix) {
  EXPECT_THAT(suggest("static-mach4", {"xtatic-mach4", "static-mach3"}),
              ElementsAre("static-mach3", "xtatic-mach4"));
}

TEST(Suggest, OffersOnlyCloseNames) {
  EXPECT_THAT(suggest("TASX", {"GGALT", "QCF"}), IsEmpty());
  EXPECT_THAT(suggest("", {"A", "B"}), IsEmpty());
  EXPECT_THAT(suggest("A", {}), IsEmpty());
  EXPECT_THAT(suggest(std::string(257, 'A'), {std::string(256, 'A')}), IsEmpty());
}

TEST(Suggest, NumberOfSuggestionsIsLimited) {
  EXPECT_THAT(suggest("QC", {"QCA", "QCB", "QCC", "QCD"}), ElementsAre("QCA", "QCB", "QCC"));
}

TEST(DidYouMean, JoinsSuggestionsWithOr) {
  EXPECT_EQ(did_you_mean("QCF", {"QCFR"}), "did you mean QCFR?");
  EXPECT_EQ(did_you_mean("QCF", {"QCFR", "QCR"}), "did you mean QCFR or QCR?");
  EXPECT_EQ(did_you_mean("QCF", {"QCFR", "QCR", "QCX"}), "did you mean QCFR, QCR or QCX?");
  EXPECT_EQ(did_you_mean("QCF", {"TASX"}), "");
}

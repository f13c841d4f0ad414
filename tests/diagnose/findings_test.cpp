#include "diagnose/findings.hpp"

#include <gmock/gmock.h>

#include <tuple>

using pcor::Diagnosis;
using pcor::Finding;

namespace {

/// One finding. @param gain decrease of chi2 of held-out parts, with a standard error of 10
Diagnosis with_finding(const char* effect, double relative_size, double gain) {
  Diagnosis diagnosis;
  Finding& finding = diagnosis.findings.emplace_back();
  finding.effect.id = effect;
  finding.relative_size = relative_size;
  finding.chi2_reduction = gain;
  finding.chi2_reduction_error = 10.0;
  return diagnosis;
}

}  // namespace

TEST(RivalBySize, EffectOfImpossibleSizeHasAnUnknownErrorAsRival) {
  for (const auto& [relative_size, gain, is_questioned] :
       {std::tuple{19.0, 10.0, false}, {21.0, 10.0, true}, {98.0, 29.0, true}, {98.0, 31.0, false}}) {
    Diagnosis diagnosis = with_finding("flaps-gear", relative_size, gain);
    pcor::internal::add_rival_by_size(diagnosis);
    EXPECT_EQ(diagnosis.findings[0].rival.empty(), !is_questioned) << relative_size << ' ' << gain;
    EXPECT_EQ(diagnosis.notes.empty(), !is_questioned);
  }
}

// A wind that depends on the place is the same in held-out parts.
TEST(RivalByAtmosphere, EffectOfImpossibleSizeMayBeTheAtmosphereEvenIfItPredicts) {
  for (const auto& [relative_size, gain, is_questioned] :
       {std::tuple{19.0, 31.0, false}, {21.0, 31.0, true}, {1.0, 29.0, true}}) {
    Diagnosis diagnosis = with_finding("qcf-gain", relative_size, gain);
    pcor::internal::add_rival_by_atmosphere(diagnosis);
    EXPECT_EQ(diagnosis.findings[0].rival, is_questioned ? "the atmosphere" : "")
        << relative_size << ' ' << gain;
    EXPECT_EQ(diagnosis.notes.empty(), !is_questioned);
  }
}

// A load factor of 4.4 +- 0.2 hPa per g by GPS heights of a real flight: the held-out rms increased from
// 0.274 to 0.301 hPa.
TEST(RivalByAtmosphere, EffectThatIncreasesTheHeldOutRmsMayBeTheAtmosphere) {
  for (const auto& [after, is_questioned] : {std::pair{0.301, true}, {0.278, false}}) {
    Diagnosis diagnosis = with_finding("load-factor", 4.0, 400.0);
    diagnosis.findings[0].rms_before = 0.274;
    diagnosis.findings[0].rms_after = after;
    pcor::internal::add_rival_by_atmosphere(diagnosis);
    EXPECT_EQ(diagnosis.findings[0].rival, is_questioned ? "the atmosphere" : "") << after;
  }
}

TEST(RivalBySize, KnownRivalIsKept) {
  Diagnosis diagnosis;
  diagnosis.findings.emplace_back().relative_size = 50.0;
  diagnosis.findings[0].rival = "the atmosphere";
  pcor::internal::add_rival_by_size(diagnosis);
  EXPECT_EQ(diagnosis.findings[0].rival, "the atmosphere");
}

// GOTEX rf06 with the fitted law of 2003: static-alpha of 0.17 hPa in a residual of 0.13 hPa.
TEST(WarningByRefit, LargeEffectThatARefitDoesNotRemoveGetsAWarning) {
  for (const auto& [rms, before, after, is_questioned] :
       {std::tuple{0.171, 0.150, 0.149, true},
        {0.171, 0.200, 0.104, false},  // all is removed
        {2.6, 1.9, 0.5, false},        // most is removed
        {0.04, 0.05, 0.05, false},     // small
        {0.06, 0.15, 0.15, false},
        {0.04, 0.153, 0.157, true}}) {  // larger than without it
    Diagnosis diagnosis = with_finding("static-alpha", 1.0, 50.0);
    diagnosis.findings[0].rms = rms;
    diagnosis.findings[0].rms_before = before;
    diagnosis.findings[0].rms_after = after;
    pcor::internal::warn_by_refit(diagnosis);
    EXPECT_EQ(diagnosis.notes.empty(), !is_questioned) << rms << ' ' << before << ' ' << after;
  }
}

// Effects that are tested on the samples with flaps extended.
#include "diagnose/flaps.hpp"

#include <gmock/gmock.h>

#include <memory>
#include <string>
#include <vector>

#include "numerics/missing.hpp"

namespace pcor::internal {
namespace {

/// Candidates with one column each, on a flight of 100 samples with flaps extended.
std::vector<std::string> tested_of(const std::vector<std::string>& effects) {
  constexpr std::size_t samples = 100;
  CandidateSet set;
  for (const std::string& id : effects) {
    Candidate& candidate = set.candidates.emplace_back();
    candidate.id = id;
    candidate.effect = neutral_effect(id);
    candidate.tested.resize(1);
  }
  FlightColumns flight;
  flight.samples = std::make_shared<const FlightSamples>();
  flight.given.assign(samples, nan);
  flight.flaps_out.assign(samples, 0.1);
  flight.candidates = Eigen::MatrixXf::Ones(samples, static_cast<Eigen::Index>(effects.size()));
  std::vector<std::string> tested;
  for (const Candidate& candidate : find_flaps_candidates(set, {FlightPartition(1), {flight}}).candidates)
    tested.push_back(candidate.id);
  return tested;
}

// The confounders of flaps-gear are static-alpha-quad, ground-effect and pcor-regime.
TEST(FlapsCandidates, RivalsAreTheConfoundersAlone) {
  EXPECT_THAT(tested_of({"static-alpha", "static-alpha-quad", "static-lag", "flaps-gear", "ground-effect"}),
              testing::ElementsAre("static-alpha-quad", "flaps-gear", "ground-effect"));
}

TEST(FlapsCandidates, NoEffectOfFlapsGivesNoTest) {
  EXPECT_THAT(tested_of({"static-alpha-quad", "ground-effect"}), testing::IsEmpty());
}

}  // namespace
}  // namespace pcor::internal

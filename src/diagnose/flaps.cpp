#include "diagnose/flaps.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <pcor/effects/catalogue.hpp>
#include "diagnose/findings.hpp"
#include "numerics/missing.hpp"
#include "numerics/triangular_factor.hpp"
#include "residuals/masks.hpp"

namespace pcor::internal {
namespace {

constexpr std::string_view flaps_effect = "flaps-gear";
constexpr std::size_t fewest_samples = 60;

bool looks_like_flaps(const ModelEffect& effect) {
  if (effect.is_formula()) return false;
  const auto& facts = effect_facts[effect_named(effect.id)];
  const auto& flaps = effect_facts[effect_named(flaps_effect)];
  return facts.look_alikes.find(flaps_effect) != std::string_view::npos ||
         flaps.look_alikes.find(effect.id) != std::string_view::npos;
}

/// The residual of all samples, those with flaps out too.
std::vector<double> all_given(const FlightColumns& flight) {
  std::vector<double> given = flight.given;
  for (std::size_t i = 0; i < given.size(); ++i) {
    if (!std::isnan(flight.flaps_out[i])) given[i] = flight.flaps_out[i];
  }
  return given;
}

/// Whether columns have a value at every sample, and say something.
bool can_be_tested(const std::vector<FlightColumns>& flights, Eigen::Index first, Eigen::Index count) {
  bool varies = false;
  for (const FlightColumns& flight : flights) {
    if (flight.reference != 0) continue;
    const std::vector<double> given = all_given(flight);
    for (std::size_t i = 0; i < given.size(); ++i) {
      if (std::isnan(given[i])) continue;
      const auto values = flight.candidates.row(as_index(i)).segment(first, count);
      if (!values.allFinite()) return false;
      varies = varies || values.cwiseAbs().maxCoeff() > 0.0F;
    }
  }
  return varies;
}

/// The flights as the test sees them: what was found is part of the model.
std::vector<FlightColumns> flights_of(const Analysis& analysis, const FlapsCandidates& flaps) {
  std::vector<FlightColumns> flights;
  for (std::size_t f = 0; f < analysis.flights().size(); ++f) {
    const FlightColumns& from = analysis.flights()[f];
    FlightColumns& flight = flights.emplace_back();
    flight.samples = from.samples;
    flight.mask = from.mask;
    flight.given = all_given(from);
    flight.residual = flight.given;
    flight.base = from.base;
    for (const std::size_t group : analysis.result().chosen) {
      const ColumnGroup& columns = analysis.groups()[group];
      const Eigen::Index before = flight.base.cols();
      flight.base.conservativeResize(Eigen::NoChange, before + columns.count);
      flight.base.rightCols(columns.count) = from.candidates.middleCols(columns.first, columns.count);
    }
    flight.candidates = flaps.columns[f];
  }
  return flights;
}

}  // namespace

FlapsCandidates find_flaps_candidates(const CandidateSet& set, const std::vector<FlightColumns>& flights) {
  FlapsCandidates flaps;
  std::size_t samples = 0;
  for (const FlightColumns& flight : flights) {
    if (flight.reference != 0) continue;
    samples += static_cast<std::size_t>(std::count_if(flight.flaps_out.begin(), flight.flaps_out.end(),
                                                      [](double x) { return !std::isnan(x); }));
  }
  if (samples < fewest_samples) return flaps;
  std::vector<Eigen::Index> kept;
  Eigen::Index first = 0;
  for (const Candidate& candidate : set.candidates) {
    const Eigen::Index count = as_index(candidate.tested.size());
    const bool reads = reads_flaps(candidate.effect, flights.front().samples->flaps_variable);
    if ((reads || looks_like_flaps(candidate.effect)) && can_be_tested(flights, first, count)) {
      for (Eigen::Index k = 0; k < count; ++k) kept.push_back(first + k);
      flaps.candidates.push_back(candidate);
      flaps.reads_flaps.push_back(reads);
    }
    first += count;
  }
  if (std::find(flaps.reads_flaps.begin(), flaps.reads_flaps.end(), true) == flaps.reads_flaps.end())
    return {};
  for (const FlightColumns& flight : flights) flaps.columns.emplace_back(flight.candidates(Eigen::all, kept));
  return flaps;
}

void diagnose_flaps(const Analysis& analysis, const FlapsCandidates& flaps, std::vector<ColumnGroup> groups,
                    std::uint64_t seed, Diagnosis& diagnosis) {
  const Analysis test(flights_of(analysis, flaps), std::move(groups), seed);
  const std::vector<std::size_t>& chosen = test.result().chosen;
  const std::vector<Finding> findings = findings_of(test, flaps.candidates);
  Eigen::VectorXd estimate;
  Eigen::MatrixXd covariance;
  test.search().fit(chosen, estimate, covariance);
  std::vector<std::string> tested;
  for (std::size_t i = 0; i < flaps.candidates.size(); ++i) {
    if (flaps.reads_flaps[i] && !flaps.candidates[i].is_variant)
      tested.push_back(flaps.candidates[i].effect.id);
  }
  const auto is_tested = [&tested](const std::string& effect) {
    return std::find(tested.begin(), tested.end(), effect) != tested.end();
  };
  for (std::size_t i = 0; i < chosen.size(); ++i) {
    if (!flaps.reads_flaps[chosen[i]]) continue;
    Finding& finding = diagnosis.findings.emplace_back(findings[i]);
    if (!finding.aliases.empty() && !finding.effect.is_formula()) {
      finding.advice.manoeuvre = effect_facts[effect_named(finding.effect.id)].manoeuvre;
      finding.advice.sentence = "fly this: " + finding.advice.manoeuvre;
    }
    for (std::size_t f = 0; f < diagnosis.flights.size(); ++f) {
      FlightDiagnosis& flight = diagnosis.flights[f];
      flight.added.push_back(test.added_by(f, chosen, i, estimate));
      flight.evidence.push_back(evidence_along(test, f)[i]);
    }
  }
  for (UpperLimit& limit : limits_of(test, flaps.candidates, findings)) {
    if (is_tested(limit.effect)) diagnosis.limits.push_back(std::move(limit));
  }
  std::vector<NotTestable>& others = diagnosis.not_testable;
  others.erase(std::remove_if(others.begin(), others.end(),
                              [&](const NotTestable& effect) { return is_tested(effect.effect); }),
               others.end());
  diagnosis.candidates += tested.size();
}

}  // namespace pcor::internal

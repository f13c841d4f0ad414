#include "diagnose/flaps.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <string_view>
#include <utility>

#include <pcor/effects/catalogue.hpp>
#include "diagnose/findings.hpp"
#include "diagnose/separation.hpp"
#include "numerics/missing.hpp"
#include "residuals/masks.hpp"

namespace pcor::internal {
namespace {

constexpr std::string_view flaps_effect = "flaps-gear";
constexpr std::size_t min_with_flaps_out = 60;  // samples

/// Whether the confounders of an effect, a list of ids, include an effect.
bool has_confounder(const EffectInfo& effect, std::string_view id) {
  return fmt::format(", {},", effect.confounders).find(fmt::format(", {},", id)) != std::string::npos;
}

bool looks_like_flaps(const ModelEffect& effect) {
  if (effect.is_formula()) return false;
  return has_confounder(*effect_named(effect.id), flaps_effect) ||
         has_confounder(*effect_named(flaps_effect), effect.id);
}

/// Residual of all samples, including those with flaps extended.
std::vector<double> all_given(const FlightColumns& flight) {
  std::vector<double> given = flight.given;
  for (std::size_t i = 0; i < given.size(); ++i) {
    if (!std::isnan(flight.flaps_out[i])) given[i] = flight.flaps_out[i];
  }
  return given;
}

/// Flights as input of the test; the findings are part of the model.
PartitionedColumns flights_of(const Analysis& analysis, const FlapsCandidates& flaps) {
  std::vector<FlightColumns> flights;
  for (std::size_t f = 0; f < analysis.flights().size(); ++f) {
    const FlightColumns& from = analysis.flights()[f];
    FlightColumns& flight = flights.emplace_back();
    flight.file = from.file;
    flight.samples = from.samples;
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
  return {analysis.partition(), std::move(flights)};
}

}  // namespace

FlapsCandidates find_flaps_candidates(const CandidateSet& set, const PartitionedColumns& columns) {
  FlapsCandidates flaps;
  const std::vector<FlightColumns>& flights = columns.flights;
  const auto samples = columns.partition.all_reduce_flights<std::size_t>([&](std::size_t f) {
    const auto is_out = [](double x) { return !std::isnan(x); };
    const auto out = std::count_if(flights[f].flaps_out.begin(), flights[f].flaps_out.end(), is_out);
    return flights[f].reference == 0 ? static_cast<std::size_t>(out) : 0U;
  });
  if (samples < min_with_flaps_out) return flaps;
  const auto reads = [&flights](const Candidate& candidate) {
    return reads_flaps(candidate.effect, flights.front().samples->flaps_variable);
  };
  const std::vector<ColumnGroup> groups = groups_of(set, set.candidates);
  const std::vector<std::string> problems = problems_of(columns, groups, [](const FlightColumns& flight) {
    return flight.reference == 0 ? all_given(flight) : std::vector<double>();
  });
  std::vector<Eigen::Index> kept;
  for (std::size_t c = 0; c < groups.size(); ++c) {
    const Candidate& candidate = set.candidates[c];
    const bool reads_them = reads(candidate);
    if (!problems[c].empty() || !(reads_them || looks_like_flaps(candidate.effect))) continue;
    flaps.candidates.push_back(candidate);
    flaps.reads_flaps.push_back(reads_them);
    for (const Eigen::Index column : indices_of(groups[c], 0)) kept.push_back(column);
  }
  if (std::count(flaps.reads_flaps.begin(), flaps.reads_flaps.end(), true) == 0) return {};
  for (const FlightColumns& flight : flights) flaps.columns.emplace_back(flight.candidates(Eigen::all, kept));
  return flaps;
}

void diagnose_flaps(const Analysis& analysis, const References& references, const FlapsCandidates& flaps,
                    std::vector<ColumnGroup> groups, Diagnosis& diagnosis) {
  const Analysis test(flights_of(analysis, flaps), std::move(groups));
  const std::vector<std::size_t>& chosen = test.result().chosen;
  const std::vector<Finding> findings = findings_of(test, references, flaps.candidates);
  const std::vector<Eigen::VectorXd> evidence = evidence_of_findings(test);
  const Eigen::VectorXd coefficients = test.coefficients(chosen);
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
    if (!finding.aliases.empty()) finding.advice.sentence = general_advice(finding.id(), finding.effect);
    for (std::size_t f = 0; f < diagnosis.flights.size(); ++f) {
      if (!test.partition().is_local(f)) continue;
      FlightDiagnosis& flight = diagnosis.flights[f];
      flight.added.push_back(test.added_by(f, chosen[i], coefficients));
      flight.evidence.push_back(evidence_along(test, f, evidence[i]));
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

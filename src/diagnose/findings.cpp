#include "diagnose/findings.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>

#include <pcor/effects/catalogue.hpp>
#include "campaign/gps_rows.hpp"
#include "diagnose/events.hpp"
#include "diagnose/finding_page.hpp"
#include "diagnose/rms.hpp"
#include "diagnose/separation.hpp"
#include "numerics/decompositions.hpp"
#include "numerics/missing.hpp"
#include "numerics/triangular_factor.hpp"
#include "residuals/parameter_dependent_columns.hpp"

namespace pcor::internal {
namespace {

constexpr double two_sided_95 = 1.959963984540054;  // standard deviations of a normal distribution
constexpr double alias_margin =
    9.0;  // chi2 of three standard deviations: a rival exceeds the true effect with probability 0.13 %
constexpr std::size_t most_evidence = 6;

/// Parameters that these flights determine; the model's coefficients imitate the others.
std::vector<CoefficientEstimate> estimates_of(const Candidate& candidate,
                                              const std::vector<Eigen::Index>& identifiable,
                                              const Eigen::VectorXd& values,
                                              const Eigen::MatrixXd& covariance) {
  std::vector<CoefficientEstimate> estimates;
  for (const Eigen::Index k : identifiable) {
    const CandidateParameter& parameter = candidate.tested[static_cast<std::size_t>(k)];
    estimates.push_back({parameter.name, parameter.unit, values[k],
                         std::sqrt(std::max(0.0, covariance(k, k))), parameter.typical});
  }
  return estimates;
}

/// The effect of a candidate with estimated coefficients.
ModelEffect with_estimate(const Candidate& candidate, const Eigen::VectorXd& estimate) {
  ModelEffect effect = candidate.effect;
  for (std::size_t k = 0; k < candidate.tested.size(); ++k)
    effect.parameters[candidate.tested[k].index] += estimate[as_index(k)];
  return effect;
}

/// Parameters that these flights do not determine.
std::vector<std::string> undetermined_parameters(const Candidate& candidate,
                                                 const std::vector<Eigen::Index>& identifiable) {
  std::vector<std::string> held;
  for (std::size_t k = 0; k < candidate.tested.size(); ++k) {
    if (std::find(identifiable.begin(), identifiable.end(), as_index(k)) == identifiable.end())
      held.push_back(candidate.tested[k].name);
  }
  return held;
}

bool is_one_of(const std::string& effect, const std::vector<std::size_t>& chosen,
               const std::vector<Candidate>& candidates) {
  return std::any_of(chosen.begin(), chosen.end(),
                     [&](std::size_t group) { return candidates[group].id == effect; });
}

/// Loss of likelihood if one effect of the chosen set is replaced by another.
struct Rival {
  std::size_t group;
  double decrease;  ///< decrease of the logarithm of the marginal likelihood, in the shapes of the catalogue
  double decrease_if_uncertain;  ///< the same if the shape of the chosen effect is uncertain, for both
};

/// Part of an effect's chi2 in references where a rival differs from it: the effect's contribution against
/// each reference before absorption by the base, weighted by the share of the difference of the two fits. At
/// most the effect's chi2.
///
/// The error of an effect's shape can favour a rival only against a reference in which the two differ; equal
/// contributions favour neither.
///
/// @param others remaining effects in both fits
double chi2_where_they_differ(const Analysis& analysis, const std::vector<std::size_t>& others,
                              std::size_t effect, std::size_t rival) {
  const double whole = analysis.search().score(effect, others).chi2;
  const Eigen::VectorXd fitted = analysis.coefficients(set_with(others, effect));
  const Eigen::VectorXd difference = fitted - analysis.coefficients(set_with(others, rival));
  const std::vector<Eigen::Index> indices = indices_of(analysis.groups()[effect], analysis.base());
  using Squares = std::array<double, 2>;  // squares of the contribution and of the difference
  const auto of_flights = analysis.whole_partition().all_gather_flights<Squares>([&](std::size_t f) {
    const auto columns = analysis.scores().rows[f].leftCols(difference.size());
    return Squares{(columns(Eigen::all, indices) * fitted(indices)).squaredNorm(),
                   (columns * difference).squaredNorm()};
  });
  std::map<std::size_t, Squares> against;  // keyed by reference
  double differences = 0.0;
  for (std::size_t f = 0; f < of_flights.size(); ++f) {
    Squares& sums = against[analysis.flight(f).reference];
    for (const std::size_t k : {0U, 1U}) sums[k] += of_flights[f][k];
    differences += of_flights[f][1];
  }
  if (!(differences > 0.0)) return whole;
  double chi2 = 0.0;
  for (const auto& [reference, sums] : against) chi2 += sums[0] * sums[1] / differences;
  return std::min(chi2, whole);
}

/// Groups that may replace a chosen one: for a strong effect also some that fit better, because its shape is
/// uncertain.
std::vector<Rival> rivals_of(const Analysis& analysis, const std::vector<Candidate>& candidates,
                             std::size_t winner, const std::vector<std::size_t>& chosen) {
  constexpr double uncertainty_of_shape = 0.1;  // relative error of the shapes in the catalogue
  const EffectSearch& search = analysis.search();
  const auto margin = [](double chi2) {
    return 0.5 * (alias_margin + uncertainty_of_shape * uncertainty_of_shape * chi2);
  };
  const double widest = margin(search.score(winner, chosen).chi2);
  const std::vector<std::size_t> others = set_without(chosen, winner);
  // A rival does not explain what another finding explains by its uncertain shape.
  const double best = search.evidence(chosen, others);
  const double best_uncertain = search.evidence(chosen);
  std::vector<Rival> rivals;
  for (std::size_t g = 0; g < candidates.size(); ++g) {
    if (g == winner || search.is_absorbed(g) || is_one_of(candidates[g].id, others, candidates)) continue;
    if (!search.score(g, others).possible) continue;
    const std::vector<std::size_t> instead = set_with(others, g);
    const double decrease = best - search.evidence(instead, others);
    if (decrease < widest && decrease < margin(chi2_where_they_differ(analysis, others, winner, g)))
      rivals.push_back({g, decrease, best_uncertain - search.evidence(instead, chosen)});
  }
  return rivals;
}

std::vector<Alias> aliases_of(const Analysis& analysis, const std::vector<Candidate>& candidates,
                              std::size_t winner, const std::vector<std::size_t>& chosen,
                              std::vector<Rival> rivals) {
  const EffectSearch& search = analysis.search();
  const GroupScore best = search.score(winner, chosen);
  const std::vector<std::size_t> others = set_without(chosen, winner);
  const double noisier = search.variance(others) / search.variance(chosen);
  std::sort(rivals.begin(), rivals.end(),
            [](const Rival& a, const Rival& b) { return a.decrease < b.decrease; });
  std::vector<Alias> aliases;
  std::set<std::string> seen{candidates[winner].id};
  for (const Rival& rival : rivals) {
    const std::size_t g = rival.group;
    if (!seen.insert(candidates[g].id).second) continue;  // the best shape represents an effect
    const GroupScore score = search.score(g, others);
    Alias alias;
    alias.candidate = g;
    alias.effect = candidates[g].id;
    alias.title = candidates[g].title;
    alias.correction = with_estimate(candidates[g], score.estimate);
    alias.fixed = undetermined_parameters(candidates[g], search.identifiable(g));
    alias.is_shared = candidates[g].is_shared;
    alias.correlation = search.correlation(winner, g, others);
    // Each direction explains one unit of noise.
    alias.chi2_difference =
        (best.chi2 - score.chi2) * noisier - (best.degrees_of_freedom - score.degrees_of_freedom);
    alias.estimates =
        estimates_of(candidates[g], search.identifiable(g), score.estimate,
                     score.covariance * (search.variance(set_with(others, g)) / search.variance(others)));
    const CoefficientEstimate& first = alias.estimates.front();
    if (first.typical != 0.0) alias.relative_size = first.value / first.typical;
    aliases.push_back(std::move(alias));
  }
  return aliases;
}

/// Contribution of an effect on a flight.
struct Added {
  SquareSum sum{};
  double worst = 0.0;  // signed, hPa
  double worst_time = 0.0;

  template <class Archive>
  void serialize(Archive& archive) {
    archive(sum, worst, worst_time);
  }
};

/// Rms that the model does not absorb, and extreme, over all used records: against the first reference or,
/// for an effect on another system, against the references that see it; and the largest rms against a single
/// reference. The fraction that the model does not absorb is that of all references together.
/// @param coefficients of all columns @param effect_coefficients those of the effect
void set_contributions(const Analysis& analysis, const References& references, std::size_t group,
                       const Eigen::VectorXd& coefficients, const Eigen::VectorXd& effect_coefficients,
                       const Candidate& candidate, Finding& finding) {
  const auto of_flights = analysis.whole_partition().all_gather_flights<Added>([&](std::size_t f) {
    Added of_flight;
    const std::vector<double> added = analysis.added_by(f, group, coefficients);
    for (const std::size_t record : analysis.bins(f).records()) {
      of_flight.sum.add(added[record]);
      if (std::abs(added[record]) <= std::abs(of_flight.worst)) continue;
      of_flight.worst = added[record];
      of_flight.worst_time = analysis.flight(f).samples->time[record];
    }
    return of_flight;
  });
  SquareSum sum;
  std::vector<SquareSum> sums(analysis.reference_count());
  for (std::size_t f = 0; f < of_flights.size(); ++f) {
    const std::size_t reference = analysis.flight(f).reference;
    sums[reference] += of_flights[f].sum;
    if (!candidate.is_measured_by(reference)) continue;
    sum += of_flights[f].sum;
    if (std::abs(of_flights[f].worst) <= std::abs(finding.worst)) continue;
    finding.worst = of_flights[f].worst;
    finding.worst_flight = analysis.flight(f).samples->name;
    finding.worst_time = of_flights[f].worst_time;
  }
  const double fraction = std::sqrt(analysis.search().remaining(group, effect_coefficients));
  finding.rms = fraction * sum.rms();
  for (std::size_t r = 0; r < sums.size(); ++r) {
    const double rms = fraction * sums[r].rms();
    if ((r > 0 && gps_kind(*references[r])) || !(rms > finding.largest_rms)) continue;
    finding.largest_rms = rms;
    finding.largest_reference = r == 0 ? "" : references[r]->name();
  }
}

/// Description of the tried shape; empty for the shape of the catalogue.
std::string shape_of(const Candidate& candidate) {
  if (!candidate.is_variant) return "";
  if (candidate.is_shared) return "alike on the other system";
  if (candidate.memory != 0.0 && memory_of(candidate.effect).of == Quantity::airspeed_rate)
    return fmt::format("mean rate over {:g} s", candidate.memory);
  const Scaling& scaling = candidate.effect.scaling;
  if (!scaling.is_none())
    return fmt::format("times p^{} q^{}", scaling.static_pressure, scaling.dynamic_pressure);
  const EffectInfo& info = *effect_named(candidate.effect.id);
  std::string text;
  for (std::size_t i = 0; i < info.parameter_count(); ++i) {
    if (!info.parameters[i].shape) continue;
    const std::string_view unit = info.parameters[i].unit;
    text += fmt::format("{}{} = {:g}{}{}", text.empty() ? "" : ", ", info.parameters[i].name,
                        candidate.effect.parameters[i], unit == "1" ? "" : " ", unit == "1" ? "" : unit);
  }
  return text;
}

std::string component_of(const Candidate& candidate) {
  if (candidate.is_of_reference()) return "other-system";
  const EffectInfo* const info = effect_named(candidate.effect.id);
  return std::string(info != nullptr ? pcor::component_of(*info)
                                     : info_of(candidate.effect.location).component);
}

/// Family, locations, shapes, size and probability of a finding; equal prior odds for all rivals.
void set_alternatives(const std::vector<Candidate>& candidates, std::size_t winner,
                      const std::vector<Rival>& rivals, Finding& finding) {
  const Candidate& winning = candidates[winner];
  if (const EffectInfo* const info = effect_named(winning.effect.id))
    finding.family = std::string(info->family);
  finding.shape = shape_of(winning);
  finding.components = {component_of(winning)};
  // Whether the shapes of the catalogue are exact is unknown: both assumptions count the same.
  std::map<std::string, Eigen::Array2d> weights{{winning.id, Eigen::Array2d::Ones()}};
  for (const Rival& rival : rivals) {
    const Candidate& candidate = candidates[rival.group];
    if (candidate.id == winning.id) finding.variants.push_back(shape_of(candidate));
    const std::string component = component_of(candidate);
    if (std::find(finding.components.begin(), finding.components.end(), component) ==
        finding.components.end())
      finding.components.push_back(component);
    Eigen::Array2d& weight = weights.try_emplace(candidate.id, Eigen::Array2d::Zero()).first->second;
    weight = weight.max(Eigen::Array2d(std::exp(-rival.decrease), std::exp(-rival.decrease_if_uncertain)));
  }
  Eigen::Array2d sum = Eigen::Array2d::Zero();
  for (const auto& [id, weight] : weights) sum += weight;
  const auto probability_of = [&](const std::string& id) { return (weights.at(id) / sum).mean(); };
  finding.probability = probability_of(winning.id);
  for (Alias& alias : finding.aliases) alias.probability = probability_of(alias.effect);
  for (const CoefficientEstimate& estimate : finding.estimates) {
    if (estimate.typical != 0.0)
      finding.relative_size = std::max(finding.relative_size, std::abs(estimate.value / estimate.typical));
  }
}

/// Rms over all samples, hPa, of a column of a candidate times a coefficient. @param column of all
/// candidates'
double rms_of_column(const Analysis& analysis, const Candidate& candidate, Eigen::Index column,
                     double coefficient) {
  return analysis.whole_partition()
      .all_reduce_flights<SquareSum>([&](std::size_t f) {
        const FlightColumns& flight = analysis.flight(f);
        SquareSum sum;
        if (!candidate.is_measured_by(flight.reference)) return sum;
        for (std::size_t i = 0; i < flight.given.size(); ++i) {
          if (!std::isnan(flight.given[i]))
            sum.add(coefficient * static_cast<double>(flight.candidates(as_index(i), column)));
        }
        return sum;
      })
      .rms();
}

}  // namespace

std::vector<Finding> findings_of(const Analysis& analysis, const References& references,
                                 const std::vector<Candidate>& candidates) {
  const std::vector<std::size_t>& chosen = analysis.result().chosen;
  const auto [estimate, covariance] = analysis.search().fit(chosen);
  const Eigen::VectorXd coefficients = analysis.coefficients(chosen, estimate);
  const HeldOut with_all = chosen.empty() ? HeldOut{} : analysis.held_out(chosen);
  const std::vector<Eigen::VectorXd> evidence_of_each = evidence_of_findings(analysis);
  std::vector<Finding> findings;
  Eigen::Index position = analysis.base();
  for (std::size_t i = 0; i < chosen.size(); ++i) {
    const std::size_t group = chosen[i];
    const Candidate& candidate = candidates[group];
    const Eigen::Index count = as_index(candidate.tested.size());
    const Eigen::VectorXd effect_coefficients = estimate.segment(position, count);
    Finding finding;
    finding.effect = with_estimate(candidate, effect_coefficients);
    finding.of_reference = candidate.is_of_reference();
    finding.is_shared = candidate.is_shared;
    finding.system = candidate.system;
    finding.title = candidate.title;
    const std::vector<Eigen::Index>& identifiable = analysis.search().identifiable(group);
    finding.estimates = estimates_of(candidate, identifiable, effect_coefficients,
                                     covariance.block(position, position, count, count));
    finding.fixed = undetermined_parameters(candidate, identifiable);
    set_contributions(analysis, references, group, coefficients, effect_coefficients, candidate, finding);
    position += count;
    const std::vector<std::size_t> without = set_without(chosen, group);
    // In units of the noise with the effect: the score of the search has the noise without it.
    finding.chi2 = analysis.search().score(group, chosen).chi2 * analysis.search().variance(without) /
                   analysis.search().variance(chosen);
    finding.p_value = analysis.result().p_values[i];
    const HeldOut without_it = analysis.held_out(without);
    finding.rms_before = without_it.rms;
    finding.rms_after = with_all.rms;
    finding.chi2_reduction = (without_it.chi2 - with_all.chi2).sum();
    finding.chi2_reduction_error = (without_it.chi2 - with_all.chi2).norm();
    const Eigen::VectorXd& evidence = evidence_of_each[i];
    std::vector<Evidence> events = events_of(analysis, evidence);
    finding.events = count_of(events);
    std::sort(events.begin(), events.end(),
              [](const Evidence& a, const Evidence& b) { return a.share > b.share; });
    events.resize(std::min(events.size(), most_evidence));
    for (Evidence& event : events) event.share /= evidence.cwiseMax(0.0).sum();
    finding.evidence = std::move(events);
    const std::vector<Rival> rivals = rivals_of(analysis, candidates, group, chosen);
    finding.aliases = aliases_of(analysis, candidates, group, chosen, rivals);
    set_alternatives(candidates, group, rivals, finding);
    findings.push_back(std::move(finding));
  }
  return findings;
}

void advise(const Analysis& analysis, const std::vector<Candidate>& candidates,
            std::vector<Finding>& findings) {
  if (std::all_of(findings.begin(), findings.end(),
                  [](const Finding& finding) { return finding.aliases.empty(); }))
    return;
  const std::vector<RegimeStatistics> regimes =
      regime_statistics(analysis.scores(), [&analysis](std::size_t f) {
        return FlightInBins{analysis.flight(f), analysis.bins(f)};
      });
  const Eigen::Index columns = analysis.scores().columns();
  const Eigen::MatrixXd now = analysis.scores().information.topLeftCorner(columns, columns);
  const double variance = analysis.search().variance(analysis.result().chosen);
  for (std::size_t i = 0; i < findings.size(); ++i) {
    Finding& finding = findings[i];
    if (finding.aliases.empty()) continue;
    const std::size_t winner = analysis.result().chosen[i];
    SeparationProblem rivalry{now, variance, indices_of(analysis.groups()[winner], analysis.base()), {}, {}};
    const Candidate& found = candidates[winner];
    rivalry.size.resize(as_index(found.tested.size()));
    for (std::size_t k = 0; k < found.tested.size(); ++k) {
      const std::size_t position = found.tested[k].index;
      rivalry.size[as_index(k)] = finding.effect.parameters[position] - found.effect.parameters[position];
    }
    std::vector<std::string> rivals;
    for (const Alias& alias : finding.aliases) {
      rivals.push_back(alias.effect);
      std::vector<std::size_t> instead = analysis.result().chosen;
      instead[i] = alias.candidate;
      rivalry.rests.push_back(indices_of(instead, analysis.groups(), analysis.base()));
    }
    const Plan best = best_plan(regimes, rivalry);
    finding.advice = advice_of(best, finding.id(), finding.effect, rivals);
  }
}

std::vector<Eigen::VectorXd> evidence_of_findings(const Analysis& analysis) {
  const EffectSearch& search = analysis.search();
  const std::vector<std::size_t>& chosen = analysis.result().chosen;
  const double variance = search.variance(chosen);
  std::vector<Eigen::VectorXd> evidence;
  for (const std::size_t group : chosen) {
    // Rows that only this group could explain, times the remaining residual.
    const std::vector<Eigen::VectorXd> rows = search.rows_after(group, chosen);
    const std::vector<Eigen::VectorXd> residuals = search.residuals_after(set_without(chosen, group));
    evidence.push_back(analysis.scores().by_minutes(
        [&](std::size_t f) { return rows[f].cwiseProduct(residuals[f]) / variance; }));
  }
  return evidence;
}

std::vector<double> evidence_along(const Analysis& analysis, std::size_t flight,
                                   const Eigen::VectorXd& evidence) {
  const Binning& bins = analysis.bins(flight);
  std::vector<double> series(analysis.flights()[flight].given.size(), nan);
  for (std::size_t k = 0; k < bins.records().size(); ++k) {
    const auto bin = static_cast<std::size_t>(bins.bins()[k]);
    series[bins.records()[k]] = evidence[analysis.scores().block[flight][bin]];
  }
  return series;
}

std::vector<AbsorbedEffect> absorbed_of(const Analysis& analysis, const std::vector<Candidate>& candidates,
                                        const std::vector<BaseCoefficient>& base) {
  constexpr double notable = 0.1;  // fraction of the effect's rms
  std::vector<AbsorbedEffect> absorbed;
  for (std::size_t g = 0; g < candidates.size(); ++g) {
    if (!analysis.search().is_absorbed(g) || candidates[g].is_variant || base.empty()) continue;
    AbsorbedEffect effect{candidates[g].id, candidates[g].title, {}, analysis.search().remaining(g)};
    // Coefficients with large columns in the fit to the effect's columns.
    const Eigen::MatrixXd& information = analysis.scores().information;
    const Eigen::Index column = analysis.base() + analysis.groups()[g].first;
    const Eigen::MatrixXd normal = information.topLeftCorner(analysis.base(), analysis.base());
    const Eigen::VectorXd solution =
        least_norm_solution(normal, information.col(column).head(analysis.base()));
    for (Eigen::Index b = 0; b < analysis.base(); ++b) {
      const double size = std::abs(solution[b]) * std::sqrt(normal(b, b));
      if (size > notable * std::sqrt(information(column, column)))
        effect.by.push_back(base[static_cast<std::size_t>(b)].name);
    }
    absorbed.push_back(std::move(effect));
  }
  return absorbed;
}

std::vector<UpperLimit> limits_of(const Analysis& analysis, const std::vector<Candidate>& candidates,
                                  const std::vector<Finding>& findings) {
  const std::vector<std::size_t>& chosen = analysis.result().chosen;
  const EffectSearch& search = analysis.search();
  std::vector<UpperLimit> limits;
  for (std::size_t g = 0; g < candidates.size(); ++g) {
    if (search.is_absorbed(g) || candidates[g].is_variant) continue;
    if (is_one_of(candidates[g].id, chosen, candidates)) continue;
    const auto is_alias = [&](const Finding& finding) {
      return std::any_of(finding.aliases.begin(), finding.aliases.end(),
                         [&](const Alias& alias) { return alias.effect == candidates[g].id; });
    };
    if (std::any_of(findings.begin(), findings.end(), is_alias)) continue;
    const GroupScore score = search.score(g, chosen);
    if (score.degrees_of_freedom == 0.0) continue;
    UpperLimit limit{candidates[g].id, candidates[g].title,
                     estimates_of(candidates[g], search.identifiable(g), score.estimate, score.covariance)};
    const ColumnGroup& group = analysis.groups()[g];
    bool seen = false;  // any coefficient determined better than by its bounds
    for (std::size_t k = 0; k < limit.estimates.size(); ++k) {
      const CoefficientEstimate& estimate = limit.estimates[k];
      const Eigen::Index column = search.identifiable(g)[k];
      const Bounds& bounds = group.bounds[static_cast<std::size_t>(column)];
      const double largest = std::max(std::abs(bounds.lower), std::abs(bounds.upper));
      const double statistical = std::abs(estimate.value) + two_sided_95 * estimate.standard_error;
      limit.limits.push_back(std::min(statistical, largest));
      seen = seen || statistical < largest;
      if (estimate.typical != 0.0)
        limit.chi2_at_usual_size =
            std::fmax(limit.chi2_at_usual_size, std::pow(estimate.typical / estimate.standard_error, 2));
      // The part of the coefficient at its limit that the base does not absorb.
      const double remaining = search.remaining(g, Eigen::VectorXd::Unit(group.count, column));
      const double rms = rms_of_column(analysis, candidates[g], group.first + column, limit.limits.back());
      limit.rms = std::max(limit.rms, std::sqrt(remaining) * rms);
    }
    if (!seen) limit.note = "not detectable on these flights, even at its largest possible size";
    if (!score.possible) {
      limit.note = "the size needed to explain the residual is impossible or has a more likely cause";
    }
    limits.push_back(std::move(limit));
  }
  std::sort(limits.begin(), limits.end(),
            [](const UpperLimit& a, const UpperLimit& b) { return a.rms > b.rms; });
  return limits;
}

void add_rival_by_size(Diagnosis& diagnosis) {
  for (Finding& finding : diagnosis.findings) {
    if (!is_of_impossible_size(finding) || !finding.rival.empty() || predicts_held_out_parts(finding))
      continue;
    finding.rival = "an unknown error";
    diagnosis.notes.push_back(warning_note(fmt::format(
        "look for a wrong entry or unit in the model or another cause first: {} is {} times its usual size; "
        "decrease of chi2 of held-out parts {:.0f} +- {:.0f}, not significant",
        finding.id(), report::ratio_text(finding.relative_size), finding.chi2_reduction,
        finding.chi2_reduction_error)));
  }
}

void warn_by_refit(Diagnosis& diagnosis) {
  constexpr double min_rms = 0.05;  // hPa, noise of a static pressure
  for (const Finding& finding : diagnosis.findings) {
    const double removed = finding.rms_before * finding.rms_before - finding.rms_after * finding.rms_after;
    const bool is_large = finding.rms > std::max(min_rms, 0.5 * finding.rms_before);
    const bool remains =
        removed < 0.5 * finding.rms * finding.rms && finding.rms_after > 0.8 * finding.rms_before;
    const bool is_worse = finding.rms_after > finding.rms_before;
    if (!is_worse && !(is_large && remains)) continue;
    diagnosis.notes.push_back(warning_note(
        fmt::format("confirm {} of {:.3f} hPa with a further reference or flights: a refit with it {} the "
                    "held-out rms from {:.3f} to {:.3f} hPa{}",
                    finding.id(), finding.rms, is_worse ? "increases" : "changes", finding.rms_before,
                    finding.rms_after, is_worse ? "" : " only, so slow variations contradict its size")));
  }
}

void add_rival_by_atmosphere(Diagnosis& diagnosis) {
  constexpr double min_increase = 1.02;
  for (Finding& finding : diagnosis.findings) {
    const bool is_impossible = is_of_impossible_size(finding);
    const bool is_worse = finding.rms_after > min_increase * finding.rms_before;
    if (predicts_held_out_parts(finding) && !is_impossible && !is_worse) continue;
    finding.rival = "the atmosphere";
    diagnosis.notes.push_back(warning_note(fmt::format(
        "confirm {} with a laser or a second system: variations of the atmosphere may be the cause{}{}; "
        "decrease of chi2 of held-out parts {:.0f} +- {:.0f}",
        finding.id(),
        is_impossible
            ? fmt::format("; its size is {} times the usual one", report::ratio_text(finding.relative_size))
            : "",
        is_worse ? fmt::format("; the effect increases the held-out rms from {:.3f} to {:.3f} hPa",
                               finding.rms_before, finding.rms_after)
                 : "",
        finding.chi2_reduction, finding.chi2_reduction_error)));
  }
}

}  // namespace pcor::internal

#include "diagnose/advice.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include <pcor/effects/catalogue.hpp>
#include "diagnose/manoeuvres.hpp"
#include "numerics/decompositions.hpp"
#include "numerics/median.hpp"
#include "numerics/triangular_factor.hpp"

namespace pcor::internal {
namespace {

constexpr double margin = 9.0;  // of chi2, as for aliases
constexpr double enough_power = 0.95;
constexpr double some_power = 0.5;
constexpr int most_repeats = 4;
constexpr double seconds_per_minute = 60.0;

/// A manoeuvre, and what it would add to the sums over base and candidates.
struct Prospect {
  Manoeuvre manoeuvre;
  Eigen::MatrixXd information;
};

std::vector<Prospect> prospects_of(const Analysis& analysis, const CandidateSet& set, const ModelFile& model,
                                   const MaskOptions& mask) {
  std::vector<std::shared_ptr<const FlightSamples>> flights;
  for (const FlightColumns& flight : analysis.flights()) flights.push_back(flight.samples);
  MaskOptions all = mask;
  all.exclude.clear();
  all.intervals.reset();
  std::vector<double> levels;
  NoiseModel noise = analysis.noise();
  for (const Eigen::VectorXd& level : noise.level)
    levels.insert(levels.end(), level.data(), level.data() + level.size());
  const double usual_level = median(levels);

  std::vector<Prospect> prospects;
  for (Manoeuvre& manoeuvre : standard_manoeuvres(flights)) {
    const FlightColumns columns = find_columns(manoeuvre.samples, model, set, 0, all, 1.0);
    const Binning bins(columns.given, columns.samples->time, columns.samples->step);
    if (bins.size() == 0) continue;
    const Eigen::MatrixXd binned = binned_columns(columns, bins);
    if (!binned.allFinite()) continue;
    noise.level = {Eigen::VectorXd::Constant(binned.rows(), usual_level)};
    const Eigen::MatrixXd white = whitened(binned, bins, noise, 0);
    prospects.push_back({std::move(manoeuvre), white.transpose() * white});
  }
  return prospects;
}

/// What of an effect, at its estimated size, base and a rival cannot imitate, in units of the noise.
double distinct(const Eigen::MatrixXd& information, const std::vector<Eigen::Index>& rest,
                const std::vector<Eigen::Index>& own, const Eigen::VectorXd& size) {
  const Eigen::MatrixXd normal = information(rest, rest);
  const Eigen::VectorXd scale = normal.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
  const SymmetricEigen solver = symmetric_eigen(scale.asDiagonal() * normal * scale.asDiagonal());
  const Eigen::VectorXd across = information(rest, own) * size;
  const Eigen::VectorXd turned = solver.eigenvectors().transpose() * (scale.asDiagonal() * across);
  double imitated = 0.0;
  for (Eigen::Index k = 0; k < turned.size(); ++k) {
    if (solver.eigenvalues()[k] > 1e-9) imitated += turned[k] * turned[k] / solver.eigenvalues()[k];
  }
  return std::max(0.0, size.dot(information(own, own) * size) - imitated);
}

double power_of(double distinct) {
  if (!(distinct > 0.0)) return 0.0;
  return 0.5 * std::erfc((margin - distinct) / (2.0 * std::sqrt(distinct)) / std::sqrt(2.0));
}

std::size_t number_of(const std::vector<Candidate>& candidates, const std::string& effect) {
  const auto found = std::find_if(candidates.begin(), candidates.end(),
                                  [&](const Candidate& candidate) { return candidate.id == effect; });
  return static_cast<std::size_t>(found - candidates.begin());
}

std::vector<Eigen::Index> places_of(const ColumnGroup& group, Eigen::Index base) {
  std::vector<Eigen::Index> places(static_cast<std::size_t>(group.count));
  std::iota(places.begin(), places.end(), base + group.first);
  return places;
}

/// The best of the manoeuvres, flown so many times.
struct Plan {
  const Manoeuvre* manoeuvre = nullptr;
  int repeats = 1;
  double power = 0.0;
};

std::string rivals_text(const Finding& finding) {
  std::vector<std::string> names;
  for (const Alias& alias : finding.aliases) names.push_back(alias.effect);
  if (names.size() == 1) return names.front();
  const std::string last = names.back();
  names.pop_back();
  return fmt::format("{} and {}", fmt::join(names, ", "), last);
}

std::string sentence_of(const Plan& plan, const Finding& finding) {
  const std::string rivals = rivals_text(finding);
  if (plan.manoeuvre == nullptr || plan.power < some_power) {
    const std::size_t place = effect_named(finding.effect.id);
    const std::string hint = place == catalogue_size ? std::string("a second sensor would have to")
                                                     : fmt::format("what separates it in general: {}",
                                                                   effect_facts[place].manoeuvre);
    return fmt::format(
        "no manoeuvre that this aircraft flies would tell {} from {} at the size found, with this reference "
        "alone; {}",
        finding.id(), rivals, hint);
  }
  const std::string times = plan.repeats == 1 ? "" : fmt::format(" {} times", plan.repeats);
  return fmt::format(
      "fly this: {}{} ({}; {:.0f} min): it would tell {} from {} with a probability of {:.0f} %",
      plan.manoeuvre->name, times, plan.manoeuvre->how,
      std::max(1.0, plan.repeats * plan.manoeuvre->duration / seconds_per_minute), finding.id(), rivals,
      std::min(99.0, 100.0 * plan.power));
}

}  // namespace

void advise(const Analysis& analysis, const CandidateSet& set, const ModelFile& model,
            const MaskOptions& mask, std::vector<Finding>& findings) {
  const bool any = std::any_of(findings.begin(), findings.end(),
                               [](const Finding& finding) { return !finding.aliases.empty(); });
  if (!any) return;
  const std::vector<Prospect> prospects = prospects_of(analysis, set, model, mask);
  const Eigen::Index columns = analysis.scores().columns();
  const Eigen::MatrixXd now = analysis.scores().information.topLeftCorner(columns, columns);
  const double variance = analysis.search().variance(analysis.result().chosen);
  for (std::size_t i = 0; i < findings.size(); ++i) {
    Finding& finding = findings[i];
    if (finding.aliases.empty()) continue;
    const std::size_t winner = analysis.result().chosen[i];
    const std::vector<Eigen::Index> own = places_of(analysis.groups()[winner], analysis.base());
    const Candidate& found = set.candidates[winner];
    Eigen::VectorXd size(as_index(found.tested.size()));
    for (std::size_t k = 0; k < found.tested.size(); ++k) {
      const std::size_t place = found.tested[k].place;
      size[as_index(k)] = finding.effect.parameters[place] - found.effect.parameters[place];
    }
    std::vector<Eigen::Index> beside(static_cast<std::size_t>(analysis.base()));
    std::iota(beside.begin(), beside.end(), Eigen::Index{0});
    for (const std::size_t other : analysis.result().chosen) {
      if (other == winner) continue;
      for (const Eigen::Index place : places_of(analysis.groups()[other], analysis.base()))
        beside.push_back(place);
    }
    Plan best;
    for (int repeats = 1; repeats <= most_repeats && best.power < enough_power; ++repeats) {
      for (const Prospect& prospect : prospects) {
        const Eigen::MatrixXd then = now + static_cast<double>(repeats) * prospect.information;
        double power = 1.0;
        for (const Alias& alias : finding.aliases) {
          std::vector<Eigen::Index> rest = beside;
          const std::size_t rival = number_of(set.candidates, alias.effect);
          for (const Eigen::Index place : places_of(analysis.groups()[rival], analysis.base()))
            rest.push_back(place);
          power = std::min(power, power_of(distinct(then, rest, own, size) / variance));
        }
        if (power > best.power) best = {&prospect.manoeuvre, repeats, power};
      }
    }
    finding.advice.sentence = sentence_of(best, finding);
    finding.advice.power = best.power;
    if (best.manoeuvre == nullptr || best.power < some_power) continue;
    finding.advice.manoeuvre = best.manoeuvre->name;
    finding.advice.duration = best.repeats * best.manoeuvre->duration;
  }
}

}  // namespace pcor::internal

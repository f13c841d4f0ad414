#include "diagnose/separation.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include <pcor/effects/catalogue.hpp>
#include "campaign/columns.hpp"
#include "numerics/decompositions.hpp"
#include "numerics/triangular_factor.hpp"

namespace pcor::internal {
namespace {

constexpr double margin = 9.0;  // of chi2, as for aliases
constexpr double enough_power = 0.95;
constexpr double some_power = 0.5;
constexpr int most_repeats = 4;
constexpr double seconds_per_minute = 60.0;

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

}  // namespace

std::vector<Prospect> prospects_of(const std::vector<std::shared_ptr<const FlightSamples>>& flights,
                                   NoiseModel noise, double usual_level, const CandidateSet& set,
                                   const ModelFile& model, const MaskOptions& mask) {
  MaskOptions all = mask;
  all.exclude.clear();
  all.intervals.reset();
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

bool Plan::helps() const { return manoeuvre != nullptr && power >= some_power; }

double Plan::duration() const { return repeats * manoeuvre->duration; }

Plan best_plan(const std::vector<Prospect>& prospects, const Rivalry& rivalry) {
  Plan best;
  for (int repeats = 1; repeats <= most_repeats && best.power < enough_power; ++repeats) {
    for (const Prospect& prospect : prospects) {
      const Eigen::MatrixXd then = rivalry.information + static_cast<double>(repeats) * prospect.information;
      double power = 1.0;
      for (const std::vector<Eigen::Index>& rest : rivalry.rests)
        power = std::min(power, power_of(distinct(then, rest, rivalry.own, rivalry.size) / rivalry.variance));
      if (power > best.power) best = {&prospect.manoeuvre, repeats, power};
    }
  }
  return best;
}

std::string text_of(const Plan& plan, const std::string& id, const ModelEffect& effect,
                    const std::vector<std::string>& rivals) {
  std::string names = rivals.front();
  if (rivals.size() > 1)
    names = fmt::format("{} and {}", fmt::join(rivals.begin(), rivals.end() - 1, ", "), rivals.back());
  if (!plan.helps()) {
    const std::size_t place = effect_named(effect.id);
    const std::string hint = place == catalogue_size ? std::string("a second sensor would have to")
                                                     : fmt::format("what separates it in general: {}",
                                                                   effect_facts[place].manoeuvre);
    return fmt::format(
        "no manoeuvre that this aircraft flies would tell {} from {} at the size found, with this reference "
        "alone; {}",
        id, names, hint);
  }
  const std::string times = plan.repeats == 1 ? "" : fmt::format(" {} times", plan.repeats);
  return fmt::format(
      "fly this: {}{} ({}; {:.0f} min): it would tell {} from {} with a probability of {:.0f} %",
      plan.manoeuvre->name, times, plan.manoeuvre->how, std::max(1.0, plan.duration() / seconds_per_minute),
      id, names, std::min(99.0, 100.0 * plan.power));
}

std::vector<double> levels_of(const NoiseModel& noise) {
  std::vector<double> levels;
  for (const Eigen::VectorXd& level : noise.level)
    levels.insert(levels.end(), level.data(), level.data() + level.size());
  return levels;
}

std::vector<Eigen::Index> places_of(const ColumnGroup& group, Eigen::Index base) {
  std::vector<Eigen::Index> places(static_cast<std::size_t>(group.count));
  std::iota(places.begin(), places.end(), base + group.first);
  return places;
}

}  // namespace pcor::internal

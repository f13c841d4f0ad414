#include "diagnose/separation.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include <pcor/effects/catalogue.hpp>
#include "base/phrasing.hpp"
#include "parallel/serialization.hpp"

namespace pcor::internal {
namespace {

/// All intervals of a regime.
struct RegimeSum {
  Eigen::MatrixXd information{};
  double intervals = 0.0;
  double duration = 0.0;  ///< s
  std::string flight{};
  double longest = 0.0;  ///< duration on that flight, s

  RegimeSum& operator+=(const RegimeSum& other) {
    if (other.information.size() == 0) return *this;
    if (information.size() == 0) return *this = other;
    information += other.information;
    intervals += other.intervals;
    duration += other.duration;
    if (other.longest > longest) {
      flight = other.flight;
      longest = other.longest;
    }
    return *this;
  }

  template <class Archive>
  void serialize(Archive& archive) {
    archive(information, intervals, duration, flight, longest);
  }
};

/// Whether a pilot can repeat the regime. Events on a level leg other than level flight cannot be repeated.
bool can_be_repeated(Regime regime) { return regime >= Regime::climb && regime != Regime::level; }

RegimeSum sum_of(Regime regime, const WhitenedSystem& scores, std::size_t number,
                 const FlightInBins& flight) {
  const Eigen::MatrixXd& rows = scores.rows[number];
  constexpr auto phases = static_cast<std::size_t>(Regime::level) + 1;
  const FlightSamples& samples = *flight.columns.samples;
  const std::vector<double>& time = flight.bins.time();
  const std::vector<RegimeSet> regimes = regimes_of_samples(time, samples.intervals);
  RegimeSum sum;
  for (const Interval& interval : samples.intervals) {
    if (interval.regime != regime) continue;
    std::vector<Eigen::Index> indices;
    double within = 0.0;
    for (Eigen::Index row = 0; row < rows.rows(); ++row) {
      const auto i = static_cast<std::size_t>(scores.bin_of(number, row));
      if (time[i] < interval.begin || time[i] >= interval.end) continue;
      within += 1.0;
      if (!is_phase(regime) || (regimes[i] >> phases).none()) indices.push_back(row);
    }
    if (indices.empty()) continue;
    const Eigen::MatrixXd columns = rows(indices, Eigen::seqN(0, rows.cols() - 1));
    RegimeSum part{columns.transpose() * columns};
    if (flight.columns.reference == 0) {  // an interval counts once for all references
      part.intervals = 1.0;
      part.duration = (interval.end - interval.begin) * static_cast<double>(indices.size()) / within;
    }
    sum += part;
  }
  sum.flight = samples.name;
  sum.longest = sum.duration;
  return sum;
}

constexpr double margin = 9.0;  // chi2, as for aliases
constexpr double enough_power = 0.95;
constexpr int max_repeats = 4;
constexpr double seconds_per_minute = 60.0;

/// Minimum over all rivals of the part of an effect at its estimated size that base and rival cannot imitate,
/// in units of the noise.
double min_distinct(const SeparationProblem& rivalry, const Eigen::MatrixXd& information) {
  double minimum = std::numeric_limits<double>::infinity();
  for (const std::vector<Eigen::Index>& rest : rivalry.rests)
    minimum = std::min(minimum,
                       distinct_squares(information, rest, rivalry.columns, rivalry.size) / rivalry.variance);
  return minimum;
}

double power_of(double distinct) {
  if (!(distinct > 0.0)) return 0.0;
  return 0.5 * std::erfc((margin - distinct) / (2.0 * std::sqrt(distinct)) / std::sqrt(2.0));
}

bool is_better(const Plan& one, const Plan& other) {
  if (one.power >= enough_power && other.power >= enough_power) return one.gain > other.gain;
  return one.power > other.power;
}

/// Text for users, e.g. "2 more yaw manoeuvres".
std::string intervals_text(Regime regime, int count) {
  const bool is_leg = regime == Regime::reverse_heading || regime == Regime::cloud;
  return fmt::format("{} more {}{}{}", count, info_of(regime).name, is_leg ? " leg" : "",
                     count == 1 ? "" : "s");
}

}  // namespace

std::vector<RegimeStatistics> regime_statistics(
    const WhitenedSystem& scores, const std::function<FlightInBins(std::size_t flight)>& flight) {
  std::vector<RegimeStatistics> regimes;
  for (std::size_t r = 0; r < regime_count; ++r) {
    const auto regime = static_cast<Regime>(r);
    if (!can_be_repeated(regime)) continue;
    auto sum = scores.partition.all_reduce_flights<RegimeSum>(
        [&](std::size_t f) { return sum_of(regime, scores, f, flight(f)); });
    if (sum.intervals == 0.0) continue;
    regimes.push_back(
        {regime, sum.duration / sum.intervals, sum.information / sum.intervals, std::move(sum.flight)});
  }
  return regimes;
}

Plan best_plan(const std::vector<RegimeStatistics>& regimes, const SeparationProblem& rivalry) {
  const double now = min_distinct(rivalry, rivalry.information);
  Plan best;
  for (const RegimeStatistics& regime : regimes) {
    Plan plan{&regime};
    while (plan.repeats < max_repeats && plan.power < enough_power) {
      ++plan.repeats;
      const double then = min_distinct(rivalry, rivalry.information + plan.repeats * regime.information);
      plan.power = power_of(then);
      plan.gain = (then - now) / plan.duration();
    }
    if (is_better(plan, best)) best = plan;
  }
  return 1.0 - best.power <= 0.5 * (1.0 - power_of(now)) ? best : Plan{};
}

Advice advice_of(const Plan& plan, const std::string& id, const ModelEffect& effect,
                 const std::vector<std::string>& rivals) {
  const std::string names = join_list(rivals);
  if (plan.regime == nullptr) {
    const auto effect_of = [](const std::string& name) { return name.substr(name.rfind(':') + 1); };
    const bool is_of_either_system = std::any_of(rivals.begin(), rivals.end(), [&](const std::string& rival) {
      return effect_of(rival) == effect_of(id);
    });
    const std::string general =
        is_of_either_system ? "a further --reference (lams, wind or height) shows which system has the error"
                            : general_advice(id, effect);
    return {fmt::format("no regime of these flights would separate {} from {} if repeated up to {} times{}{}",
                        id, names, max_repeats, general.empty() ? "" : "; ", general)};
  }
  const bool is_one = plan.repeats == 1;
  const Regime regime = plan.regime->regime;
  return {fmt::format("fly {} of {:.1f} min{} as on {}: probability {:.0f} % that {} {} from {}",
                      intervals_text(regime, plan.repeats), plan.regime->duration / seconds_per_minute,
                      is_one ? "" : " each", plan.regime->flight, std::min(99.0, 100.0 * plan.power),
                      is_one ? "it separates" : "they separate", id, names),
          std::string(info_of(regime).name), plan.duration(), plan.power};
}

std::string general_advice(const std::string& id, const ModelEffect& effect) {
  const EffectInfo* const info = effect_named(effect.id);
  if (info == nullptr) return "";
  return fmt::format("manoeuvres that separate {} in general: {}", id, info->manoeuvre);
}

}  // namespace pcor::internal

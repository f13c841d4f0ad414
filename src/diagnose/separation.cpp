#include "diagnose/separation.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include <pcor/effects/catalogue.hpp>
#include "base/phrasing.hpp"

namespace pcor::internal {
namespace {

constexpr double margin = 9.0;  // chi2, as for aliases
constexpr double enough_power = 0.95;
constexpr int max_repeats = 4;
constexpr double seconds_per_minute = 60.0;

/// Minimum over all rivals of the part of an effect at its estimated size that base and rival cannot imitate,
/// in units of the noise.
double min_distinct(const SeparationProblem& rivalry, const Eigen::MatrixXd& information) {
  double minimum = std::numeric_limits<double>::infinity();
  for (const std::vector<Eigen::Index>& rest : rivalry.rests)
    minimum =
        std::min(minimum, distinct_squares(information, rest, rivalry.own, rivalry.size) / rivalry.variance);
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

Plan best_plan(const std::vector<FlownRegime>& regimes, const SeparationProblem& rivalry) {
  const double now = min_distinct(rivalry, rivalry.information);
  Plan best;
  for (const FlownRegime& regime : regimes) {
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

std::string text_of(const Plan& plan, const std::string& id, const ModelEffect& effect,
                    const std::vector<std::string>& rivals) {
  const std::string names = join_list(rivals);
  if (plan.regime == nullptr) {
    const std::string general = general_advice(id, effect);
    return fmt::format("no regime of these flights would separate {} from {} if repeated up to {} times{}{}",
                       id, names, max_repeats, general.empty() ? "" : "; ", general);
  }
  const bool is_one = plan.repeats == 1;
  return fmt::format("fly {} of {:.1f} min{} as on {}: probability {:.0f} % that {} {} from {}",
                     intervals_text(plan.regime->regime, plan.repeats),
                     plan.regime->duration / seconds_per_minute, is_one ? "" : " each", plan.regime->flight,
                     std::min(99.0, 100.0 * plan.power), is_one ? "it separates" : "they separate", id,
                     names);
}

std::string general_advice(const std::string& id, const ModelEffect& effect) {
  const EffectInfo* const info = effect_named(effect.id);
  if (info == nullptr) return "";
  return fmt::format("manoeuvres that separate {} in general: {}", id, info->manoeuvre);
}

bool is_separated(const SeparationProblem& rivalry) {
  return power_of(min_distinct(rivalry, rivalry.information)) >= enough_power;
}

}  // namespace pcor::internal

#include "diagnose/step_dates.hpp"

#include <algorithm>
#include <cstddef>
#include <iterator>
#include <string>
#include <utility>

#include <pcor/effects/catalogue.hpp>
#include <pcor/units/units.hpp>

namespace pcor::internal {
namespace {

constexpr std::ptrdiff_t max_dates = 32;

/// Equidistant dates in a range.
void add_some(std::vector<double>& tried, std::vector<double>::const_iterator first,
              std::vector<double>::const_iterator last) {
  const std::ptrdiff_t count = last - first;
  const std::ptrdiff_t some = std::min(count, max_dates);
  for (std::ptrdiff_t k = 0; k < some; ++k) tried.push_back(first[(2 * k + 1) * count / (2 * some)]);
}

std::vector<double> begins_of(const FlightSet& flights) {
  const UnitConversion to_date =
      UnitConversion::between("seconds since 1970-01-01", std::string(info_of(Quantity::date).unit), {});
  std::vector<double> begins;
  for (const FlightOutline& file : flights.outlines()) begins.push_back(to_date(file.begin));
  return begins;
}

void put_in_order(std::vector<double>& dates) {
  std::sort(dates.begin(), dates.end());
  dates.erase(std::unique(dates.begin(), dates.end()), dates.end());
}

}  // namespace

StepDates::StepDates(std::vector<double> begins) : begins_(std::move(begins)) {
  put_in_order(begins_);
  if (!begins_.empty()) begins_.erase(begins_.begin());
  add_some(tried_, begins_.begin(), begins_.end());
  // Few flights before or after a step: a date far from the step would leave little.
  const std::size_t half_a_distance = begins_.size() / (2 * max_dates);
  for (std::size_t few = 1; few < half_a_distance; few *= 2) {
    tried_.push_back(begins_[few - 1]);
    tried_.push_back(begins_[begins_.size() - few]);
  }
  put_in_order(tried_);
}

StepDates::StepDates(const FlightSet& flights) : StepDates(begins_of(flights)) {}

bool StepDates::refine(const std::vector<Finding>& findings) {
  std::vector<ModelEffect> effects;
  for (const Finding& finding : findings) {
    if (!finding.of_reference)
      effects.push_back(finding.effect);  // a step on a reference is tried on one date
  }
  std::vector<double> tried = tried_;
  for (const double date : dates_of(effects)) {
    const auto after = std::upper_bound(tried_.begin(), tried_.end(), date);
    const auto at = std::lower_bound(tried_.begin(), tried_.end(), date);
    const auto first = at == tried_.begin()
                           ? begins_.cbegin()
                           : std::upper_bound(begins_.cbegin(), begins_.cend(), *std::prev(at));
    const auto last =
        after == tried_.end() ? begins_.cend() : std::lower_bound(begins_.cbegin(), begins_.cend(), *after);
    add_some(tried, first, last);
  }
  put_in_order(tried);
  const bool is_finer = tried.size() > tried_.size();
  tried_ = std::move(tried);
  return is_finer;
}

std::vector<double> dates_of(const std::vector<ModelEffect>& effects) {
  std::vector<double> dates;
  for (const ModelEffect& effect : effects) {
    const EffectInfo* const info = effect.is_formula() ? nullptr : effect_named(effect.id);
    if (info == nullptr || info->needs[0] != Quantity::date) continue;
    dates.push_back(effect.parameters[1]);
  }
  put_in_order(dates);
  return dates;
}

}  // namespace pcor::internal

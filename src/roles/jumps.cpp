#include "roles/jumps.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include <pcor/base/utc.hpp>
#include "numerics/median.hpp"
#include "numerics/missing.hpp"

namespace pcor::internal {
namespace {

constexpr double longest = 60.0;  // s from a jump to the jump back
constexpr double deviations = 8.0;
constexpr std::size_t around = 7;  // samples on either side

/// Difference of the rate at each sample (since the previous one) from the median rate of its neighbours.
std::vector<double> departures(const std::vector<double>& values, const std::vector<double>& time) {
  std::vector<double> rates(values.size(), nan);
  for (std::size_t i = 1; i < values.size(); ++i)
    rates[i] = (values[i] - values[i - 1]) / (time[i] - time[i - 1]);
  std::vector<double> departure(values.size(), nan);
  for (std::size_t i = 1; i < values.size(); ++i) {
    const auto from = rates.begin() + static_cast<std::ptrdiff_t>(i - std::min(i, around));
    const auto to = rates.begin() + static_cast<std::ptrdiff_t>(std::min(i + around + 1, values.size()));
    departure[i] = rates[i] - median({from, to});
  }
  return departure;
}

}  // namespace

std::vector<Jump> find_jumps(const std::vector<double>& values, const std::vector<double>& time,
                             double min_rate) {
  const std::vector<double> departure = departures(values, time);
  std::vector<double> sizes;
  for (const double each : departure) sizes.push_back(std::abs(each));
  const double limit = std::max(min_rate, deviations * deviation_of_median * median(sizes));
  std::vector<Jump> jumps;
  for (std::size_t i = 1; i < values.size(); ++i) {
    if (!(sizes[i] > limit)) continue;
    // The last jump of the fault, and what lies between.
    std::size_t back = i;
    double sum = departure[i] * (time[i] - time[i - 1]);
    for (std::size_t j = i + 1; j < values.size() && time[j] - time[i] <= longest; ++j) {
      if (!(sizes[j] > limit)) continue;
      sum += departure[j] * (time[j] - time[j - 1]);
      back = j;
      if (std::abs(sum) < min_rate) break;
    }
    if (back == i) continue;
    Jump jump{i, back - i, 0.0};
    const double slope = (values[back] - values[i - 1]) / (time[back] - time[i - 1]);
    for (std::size_t k = i; k < back; ++k) {
      const double line = values[i - 1] + slope * (time[k] - time[i - 1]);
      jump.size = std::max(jump.size, std::abs(values[k] - line));
    }
    jumps.push_back(jump);
    i = back;
  }
  return jumps;
}

void mask(const std::vector<Jump>& jumps, std::vector<double>& values) {
  for (const Jump& jump : jumps)
    std::fill_n(values.begin() + static_cast<std::ptrdiff_t>(jump.first), jump.count, nan);
}

std::string format_jump(const std::string& variable, const Jump& jump, const std::vector<double>& time,
                        const std::string& unit) {
  return fmt::format("{} jumps by up to {:.0f} {} from {} to {} UTC ({} samples)", variable, jump.size, unit,
                     utc_text(time[jump.first]), utc_text(time[jump.first + jump.count - 1], "%H:%M:%S"),
                     jump.count);
}

}  // namespace pcor::internal

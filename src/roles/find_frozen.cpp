#include "roles/find_frozen.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include <pcor/base/utc.hpp>
#include <pcor/realtime/frozen_watch.hpp>
#include "numerics/median.hpp"
#include "numerics/missing.hpp"
#include "roles/recorded_series.hpp"

namespace pcor::internal {
namespace {

constexpr std::size_t min_samples = 20;
constexpr std::size_t min_runs = 50;         // minimum number of runs to estimate their usual length
constexpr std::size_t neighbours = 20;       // runs on either side
constexpr std::size_t longest_excluded = 2;  // number of neighbours
constexpr double min_over_near = 20.0;       // ratio of a frozen run to the mean length of its neighbours
constexpr double min_over_median = 5.0;      // ratio to the median, if the series is noisy around the run
constexpr double min_over_90th = 10.0;       // ratio to the 90th percentile, otherwise
constexpr double noisy = 3.0;                // second difference, in steps of resolution
constexpr std::size_t noise_window = 300;    // samples on either side
constexpr std::size_t max_listed = 3;        // segments in a text

/// Consecutive equal values, with missing ones between them.
struct Run {
  Segment segment;
  std::size_t length = 0;  ///< number of values that are not missing
};

std::vector<Run> runs_of(const std::vector<double>& values, const std::vector<bool>& used) {
  std::vector<Run> runs;
  double last = nan;
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (!used[i]) last = nan;
    if (!used[i] || std::isnan(values[i])) continue;
    if (values[i] != last) runs.push_back({{i, 0}});
    last = values[i];
    runs.back().segment.count = i + 1 - runs.back().segment.first;
    ++runs.back().length;
  }
  return runs;
}

/// Smallest step of a series: its resolution.
double smallest_step(const std::vector<double>& values) {
  double resolution = infinity;
  for (std::size_t i = 1; i < values.size(); ++i) {
    const double step = std::abs(values[i] - values[i - 1]);
    if (step > 0.0) resolution = std::min(resolution, step);
  }
  return resolution;
}

/// Whether the noise from sample to sample exceeds the resolution; true if there are too few samples.
bool is_noisy(const std::vector<double>& values, std::size_t first, std::size_t end, double resolution) {
  std::vector<double> bends;
  for (std::size_t i = first + 2; i < end; ++i) {
    const double before = values[i - 1] - values[i - 2];
    const double now = values[i] - values[i - 1];
    const double bend = std::abs(now - before);
    if ((before != 0.0 || now != 0.0) && !std::isnan(bend)) bends.push_back(bend);
  }
  return bends.empty() || median(std::move(bends)) >= noisy * resolution;
}

/// True if the series is noisy before and after the run.
bool is_noisy_around(const std::vector<double>& values, const Segment& run, double resolution) {
  const std::size_t after = run.first + run.count;
  return is_noisy(values, run.first - std::min(run.first, noise_window), run.first, resolution) &&
         is_noisy(values, after, std::min(after + noise_window, values.size()), resolution);
}

/// Quantile of run lengths, each run weighted by its number of samples. @param part 0 to 1
double length_quantile(const std::vector<Run>& runs, double part) {
  std::vector<std::size_t> lengths;
  std::size_t samples = 0;
  for (const Run& run : runs) {
    lengths.push_back(run.length);
    samples += run.length;
  }
  std::sort(lengths.begin(), lengths.end());
  double within = 0.0;
  for (const std::size_t length : lengths) {
    within += static_cast<double>(length);
    if (within >= part * static_cast<double>(samples)) return static_cast<double>(length);
  }
  return 0.0;
}

/// Mean length of the neighbouring runs, without the longest ones.
double mean_length_near(const std::vector<Run>& runs, std::size_t run) {
  std::vector<std::size_t> lengths;
  const std::size_t end = std::min(run + neighbours + 1, runs.size());
  for (std::size_t i = run - std::min(run, neighbours); i < end; ++i) {
    if (i != run) lengths.push_back(runs[i].length);
  }
  std::sort(lengths.begin(), lengths.end());
  lengths.resize(lengths.size() - std::min(longest_excluded, lengths.size() - 1));
  double sum = 0.0;
  for (const std::size_t length : lengths) sum += static_cast<double>(length);
  return sum / static_cast<double>(lengths.size());
}

/// True for the sensors that a sample loop watches.
bool is_watched(Quantity quantity) {
  return std::find(always_varying.begin(), always_varying.end(), quantity) != always_varying.end();
}

}  // namespace

std::vector<Segment> find_frozen(const std::vector<double>& values, const std::vector<bool>& used,
                                 bool always_varies) {
  const std::vector<Run> runs = runs_of(values, used);
  std::vector<Segment> frozen;
  const auto same = [&](const Run& run) {
    return values[run.segment.first] == values[runs.front().segment.first];
  };
  if (always_varies && std::all_of(runs.begin(), runs.end(), same)) {
    for (const Run& run : runs) frozen.push_back(run.segment);
    return frozen;
  }
  if (runs.size() < min_runs) return {};
  const auto is_long = [](const Run& run) { return run.length >= min_samples; };
  if (std::none_of(runs.begin(), runs.end(), is_long)) return {};
  const double resolution = smallest_step(values);
  const double median_length = length_quantile(runs, 0.5);
  const double length_90th = length_quantile(runs, 0.9);
  for (std::size_t i = 0; i < runs.size(); ++i) {
    const Segment& segment = runs[i].segment;
    if (!is_long(runs[i])) continue;
    const auto length = static_cast<double>(runs[i].length);
    const double minimum = is_noisy_around(values, segment, resolution) ? min_over_median * median_length
                                                                        : min_over_90th * length_90th;
    if (length >= minimum && length >= min_over_near * mean_length_near(runs, i)) frozen.push_back(segment);
  }
  return frozen;
}

std::vector<Segment> find_frozen(Quantity quantity, const std::vector<double>& values,
                                 const std::vector<bool>& flying) {
  constexpr std::ptrdiff_t min_flown = 300;
  const bool always_varies = is_watched(quantity) || quantity == Quantity::corrected_static_pressure;
  std::vector<Segment> frozen = find_frozen(
      values, flying, always_varies && std::count(flying.begin(), flying.end(), true) >= min_flown);
  if (quantity == Quantity::liquid_water) {
    const auto is_zero = [&values](const Segment& span) { return values[span.first] == 0.0; };
    frozen.erase(std::remove_if(frozen.begin(), frozen.end(), is_zero), frozen.end());
  }
  return frozen;
}

std::vector<Segment> find_frozen(const Flight& flight, const std::string& variable, Quantity quantity,
                                 const std::vector<double>& means, const std::vector<bool>& flying) {
  std::vector<Segment> frozen = find_frozen(quantity, means, flying);
  const int rate = flight.variable(variable).rate;
  if (rate == 1 || !is_watched(quantity)) return frozen;
  std::vector<bool> marked(means.size());
  const auto mark = [&marked](std::size_t first, std::size_t end) {
    std::fill(marked.begin() + static_cast<std::ptrdiff_t>(first),
              marked.begin() + static_cast<std::ptrdiff_t>(end), true);
  };
  for (const Segment& span : frozen) mark(span.first, span.first + span.count);
  const std::vector<double> values = read_values(flight, variable, {}, rate).values;
  SteadyValue watch(rate, infinity);
  double last = nan;
  std::size_t first = 0;  // record of the first sample with this value that is not marked
  for (std::size_t i = 0; i < values.size(); ++i) {
    const std::size_t record = i / static_cast<std::size_t>(rate);
    if (!flying[record]) {
      watch.end();
      last = nan;
    } else if (!std::isnan(values[i])) {
      if (values[i] != last) first = record;
      last = values[i];
      if (!watch(last)) continue;
      mark(first, record + 1);
      first = record;
    }
  }
  frozen.clear();
  for (const Run& run : runs_of(std::vector<double>(means.size()), marked)) frozen.push_back(run.segment);
  return frozen;
}

std::vector<bool> in_flight(const std::vector<double>& speed, double minimum) {
  std::vector<bool> flying;
  for (const double value : speed)
    flying.push_back(is_missing(value) ? !flying.empty() && flying.back() : value >= minimum);
  return flying;
}

std::string frozen_text(const std::string& variable, Quantity quantity, const std::vector<double>& values,
                        const std::vector<double>& time, const std::vector<Segment>& frozen) {
  std::vector<std::string> spans;
  const std::string unit(index(quantity) < quantity_count ? info_of(quantity).unit : "");
  for (const Segment& span : frozen) {
    if (spans.size() == max_listed) break;
    const auto first = values.begin() + static_cast<std::ptrdiff_t>(span.first);
    const double value = median({first, first + static_cast<std::ptrdiff_t>(span.count)});
    spans.push_back(fmt::format("at {:.6g}{} from {} to {} UTC ({} record{})", value,
                                unit.empty() || unit == "1" ? "" : " " + unit, utc_text(time[span.first]),
                                utc_text(time[span.first + span.count - 1], "%H:%M:%S"), span.count,
                                span.count == 1 ? "" : "s"));
  }
  return fmt::format(
      "{} is frozen, {}{}", variable, fmt::join(spans, ", "),
      frozen.size() > max_listed ? fmt::format(" and {} more segments", frozen.size() - max_listed) : "");
}

}  // namespace pcor::internal

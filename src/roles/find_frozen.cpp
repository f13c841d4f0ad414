#include "roles/find_frozen.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include <pcor/base/utc.hpp>
#include <pcor/realtime/frozen_watch.hpp>
#include "numerics/median.hpp"
#include "numerics/missing.hpp"
#include "roles/recorded_series.hpp"

namespace pcor::internal {
namespace {

constexpr std::size_t min_samples = 20;
constexpr std::size_t min_runs = 50;         // minimum number of runs to estimate their usual length
constexpr std::size_t min_flown = 300;       // samples of a flight, or of a run, if few runs are known
constexpr std::size_t neighbours = 20;       // runs on either side
constexpr std::size_t longest_excluded = 2;  // number of neighbours
constexpr std::ptrdiff_t max_similar = 10;   // faults of half the length and more in a flight
constexpr double min_over_near = 20.0;       // ratio of a frozen run to the mean length of its neighbours
constexpr double min_over_median = 5.0;      // ratio to the median, if the series is noisy around the run
constexpr double min_over_90th = 10.0;       // ratio to the 90th percentile, otherwise
constexpr double noisy = 3.0;                // second difference, in steps of resolution
constexpr std::size_t noise_window = 300;    // samples on either side
constexpr std::size_t max_listed = 3;        // segments in a text

/// Consecutive equal values, with missing ones between them.
struct ConstantRun {
  Segment segment;
  std::size_t length = 0;  ///< number of values that are not missing
};

std::vector<ConstantRun> runs_of(const std::vector<double>& values, const std::vector<bool>& used) {
  std::vector<ConstantRun> runs;
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

/// Quantile of the lengths below a limit, each weighted by its number of samples; 0 without such lengths.
/// @param sorted lengths of runs @param part 0 to 1
double length_quantile(const std::vector<std::size_t>& sorted, std::size_t limit, double part) {
  const auto end = std::lower_bound(sorted.begin(), sorted.end(), limit);
  const auto samples = static_cast<double>(std::accumulate(sorted.begin(), end, std::size_t{0}));
  double within = 0.0;
  for (auto each = sorted.begin(); each != end; ++each) {
    within += static_cast<double>(*each);
    if (within >= part * samples) return static_cast<double>(*each);
  }
  return 0.0;
}

/// Extends a run to adjacent samples of the same value that are not used, as on the ground.
Segment with_unused(Segment run, const std::vector<double>& values) {
  const double value = values[run.first];
  std::size_t end = run.first + run.count;
  while (run.first > 0 && values[run.first - 1] == value) --run.first;
  while (end < values.size() && values[end] == value) ++end;
  run.count = end - run.first;
  return run;
}

/// Mean length of the neighbouring runs, without the longest ones.
double mean_length_near(const std::vector<ConstantRun>& runs, std::size_t run) {
  std::vector<std::size_t> lengths;
  const std::size_t end = std::min(run + neighbours + 1, runs.size());
  for (std::size_t i = run - std::min(run, neighbours); i < end; ++i) {
    if (i != run) lengths.push_back(runs[i].length);
  }
  std::sort(lengths.begin(), lengths.end());
  lengths.resize(lengths.size() - std::min(longest_excluded, lengths.size() - 1));
  const auto sum = std::accumulate(lengths.begin(), lengths.end(), std::size_t{0});
  return static_cast<double>(sum) / static_cast<double>(lengths.size());
}

/// Segments in order. Runs of the same value with only ground samples between them are one segment.
std::vector<Segment> each_once(std::vector<Segment> segments) {
  std::sort(segments.begin(), segments.end(),
            [](const Segment& a, const Segment& b) { return a.first < b.first; });
  const auto are_same = [](const Segment& a, const Segment& b) { return a.first == b.first; };
  segments.erase(std::unique(segments.begin(), segments.end(), are_same), segments.end());
  return segments;
}

/// True if two means of records in flight, one after the other without missing ones, are equal. A sensor
/// with one value for five seconds has such means; reading all its samples takes longer.
bool has_equal_means(const std::vector<double>& means, const std::vector<bool>& flying) {
  constexpr double rounding = 1e-12;  // relative; means of one value over different numbers of samples
  double last = nan;
  for (std::size_t i = 0; i < means.size(); ++i) {
    if (flying[i] && std::abs(means[i] - last) <= rounding * std::abs(last)) return true;
    if (!flying[i] || !std::isnan(means[i])) last = flying[i] ? means[i] : nan;
  }
  return false;
}

/// True for the sensors that a sample loop watches.
bool is_watched(Quantity quantity) {
  return std::find(always_varying.begin(), always_varying.end(), quantity) != always_varying.end();
}

}  // namespace

std::vector<Segment> find_frozen(const std::vector<double>& values, const std::vector<bool>& used,
                                 bool always_varies) {
  const std::vector<ConstantRun> runs = runs_of(values, used);
  std::vector<Segment> frozen;
  const auto same = [&](const ConstantRun& run) {
    return values[run.segment.first] == values[runs.front().segment.first];
  };
  if (always_varies && std::all_of(runs.begin(), runs.end(), same)) {
    for (const ConstantRun& run : runs) frozen.push_back(with_unused(run.segment, values));
    return each_once(std::move(frozen));
  }
  if (runs.size() < 2) return {};
  // Few runs do not show the usual length; a sensor that always varies is frozen after minutes.
  const bool are_few = runs.size() < min_runs;
  if (are_few && !always_varies) return {};
  const std::size_t shortest = are_few ? min_flown : min_samples;
  const double resolution = smallest_step(values);
  std::vector<std::size_t> order(runs.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return std::pair(runs[a].length, a) < std::pair(runs[b].length, b);
  });
  std::vector<std::size_t> all;
  for (const std::size_t i : order) all.push_back(runs[i].length);
  std::vector<std::size_t> usual;  // runs that are not frozen
  for (const std::size_t i : order) {
    const std::size_t length = runs[i].length;
    const auto is_frozen = [&] {
      if (length < shortest) return false;
      const bool is_noisy = is_noisy_around(values, runs[i].segment, resolution);
      const auto similar = all.end() - std::lower_bound(all.begin(), all.end(), length / 2);
      if (always_varies && !is_noisy && similar > max_similar) return false;  // calm air
      const double factor = is_noisy ? min_over_median : min_over_90th;
      const double part = is_noisy ? 0.5 : 0.9;
      // Flaps stay extended several times; several long runs of a sensor that always varies are faults.
      const double expected = always_varies ? length_quantile(usual, length / 2, part)
                                            : length_quantile(all, all.back() + 1, part);
      return static_cast<double>(length) >=
             std::max(factor * expected, min_over_near * mean_length_near(runs, i));
    };
    if (is_frozen())
      frozen.push_back(with_unused(runs[i].segment, values));
    else
      usual.push_back(length);
  }
  return each_once(std::move(frozen));
}

std::vector<Segment> find_frozen(Quantity quantity, const std::vector<double>& values,
                                 const std::vector<bool>& flying) {
  const bool always_varies = is_watched(quantity) || quantity == Quantity::corrected_static_pressure;
  std::vector<Segment> frozen = find_frozen(values, flying,
                                            always_varies && std::count(flying.begin(), flying.end(), true) >=
                                                                 static_cast<std::ptrdiff_t>(min_flown));
  if (quantity == Quantity::liquid_water) {
    const auto is_zero = [&values](const Segment& span) { return values[span.first] == 0.0; };
    frozen.erase(std::remove_if(frozen.begin(), frozen.end(), is_zero), frozen.end());
  }
  return frozen;
}

std::vector<Segment> find_frozen(const Flight& flight, const std::string& variable, Quantity quantity,
                                 const std::vector<double>& means, const std::vector<bool>& flying) {
  std::vector<Segment> frozen = find_frozen(quantity, means, flying);
  // Other quantities may be computed from several variables.
  const int rate = is_watched(quantity) ? flight.variable(variable).rate : 1;
  if (rate == 1 || !has_equal_means(means, flying)) return frozen;
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
  for (const ConstantRun& run : runs_of(std::vector<double>(means.size()), marked))
    frozen.push_back(run.segment);
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
      "{} is frozen {}{}", variable, fmt::join(spans, "; "),
      frozen.size() > max_listed ? fmt::format("; and {} more segments", frozen.size() - max_listed) : "");
}

}  // namespace pcor::internal

#include "residuals/time_spans.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cstddef>

#include <pcor/base/utc.hpp>
#include "regimes/series.hpp"

namespace pcor::internal {

std::vector<Segment> marked_segments(const std::vector<bool>& marked, std::size_t max_gap) {
  std::vector<Segment> segments;
  const std::vector<Run> runs = runs_where(marked.size(), [&](std::size_t i) { return marked[i]; });
  for (const Run& run : bridged(runs, max_gap)) segments.push_back({run.first, run.length()});
  return segments;
}

std::string times_of(const std::vector<Segment>& segments, const std::vector<double>& time) {
  constexpr std::size_t max_spans = 6;
  constexpr const char* clock = "%H:%M:%S";
  std::vector<std::string> spans;
  for (std::size_t i = 0; i < std::min(segments.size(), max_spans); ++i) {
    const Segment& segment = segments[i];
    std::string& span = spans.emplace_back(utc_text(time[segment.first], clock));
    if (segment.count > 1) span += "-" + utc_text(time[segment.first + segment.count - 1], clock);
  }
  const std::string more =
      segments.size() > max_spans ? fmt::format(" and {} more spans", segments.size() - max_spans) : "";
  return fmt::format("{}{} UTC", fmt::join(spans, ", "), more);
}

}  // namespace pcor::internal

#include "residuals/time_spans.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cstddef>

#include <pcor/base/utc.hpp>

namespace pcor::internal {

std::vector<IndexRange> marked_runs(const std::vector<bool>& marked, std::size_t max_gap) {
  return merge_gaps(runs_where(marked.size(), [&](std::size_t i) { return marked[i]; }), max_gap);
}

std::string times_of(const std::vector<IndexRange>& runs, const std::vector<double>& time) {
  constexpr std::size_t max_spans = 6;
  constexpr const char* clock = "%H:%M:%S";
  std::vector<std::string> spans;
  for (std::size_t i = 0; i < std::min(runs.size(), max_spans); ++i) {
    std::string& span = spans.emplace_back(utc_text(time[runs[i].first], clock));
    if (runs[i].length() > 1) span += "-" + utc_text(time[runs[i].end - 1], clock);
  }
  const std::string more =
      runs.size() > max_spans ? fmt::format(" and {} more spans", runs.size() - max_spans) : "";
  return fmt::format("{}{} UTC", fmt::join(spans, ", "), more);
}

}  // namespace pcor::internal

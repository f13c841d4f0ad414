#include "process/outside_law.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <optional>

#include <pcor/base/error.hpp>

#include "process/origin.hpp"
#include "residuals/masks.hpp"
#include "residuals/samples.hpp"
#include "residuals/time_spans.hpp"
#include "roles/recorded_series.hpp"

namespace pcor::internal {
namespace {

/// Adds the spans of the marked records to the summary, and returns their times as text.
std::string add_spans(const Flight& flight, const std::string& reason, const std::vector<bool>& records,
                      std::size_t max_gap, ProcessSummary& summary) {
  const std::vector<double> time = record_times(flight);
  const std::vector<IndexRange> runs = marked_runs(records, max_gap);
  for (const IndexRange& run : runs)
    summary.outside.push_back({reason, time[run.first], time[run.end - 1] + flight.time().step});
  return times_of(runs, time);
}

}  // namespace

std::vector<bool> find_extended_flaps(const Flight& flight, const ModelDefinition& model,
                                      const ProcessOptions& options, ProcessSummary& summary) {
  if (changes_no_pressure(model, options)) return {};
  std::optional<std::vector<bool>> extended;
  std::string variable;
  try {
    variable = read_role(flight, model, Quantity::flaps).variable;
    const std::vector<ModelEffect>& effects = model.model.effects;
    if (std::any_of(effects.begin(), effects.end(), [&](const ModelEffect& effect) {
          return !is_neutral(effect) && reads_flaps(effect, variable);
        }))
      return {};
    extended = flaps_extended(flight, model);
  } catch (const Error& error) {  // a variable that no result needs is damaged
    summary.notes.push_back(
        warning_note(fmt::format("records with extended flaps have no quality bit: {}", error.what())));
    return {};
  }
  if (!extended) {
    summary.notes.emplace_back(
        "records with extended flaps have no quality bit: flaps are not recorded and the lift does not "
        "determine them");
    return {};
  }
  const auto count = std::count(extended->begin(), extended->end(), true);
  if (count == 0) return {};
  const std::string times = add_spans(flight, "flaps extended", *extended, 0, summary);
  const std::string results =
      options.correct_with == CorrectWith::lams
          ? model.output_name("PCOR") + options.suffix + " or results by the model in "
          : "";
  summary.notes.push_back(warning_note(fmt::format(
      "do not use {}{} of {} records (bit outside_domain): flaps extended, not in the model; {}{}; these "
      "records have no uncertainty",
      results, count, extended->size(), times, variable.empty() ? ", inferred from the lift" : "")));
  return std::move(*extended);
}

void note_outside_domain(const Flight& flight, std::vector<bool> outside, const std::vector<bool>& flaps,
                         ProcessSummary& summary) {
  for (std::size_t i = 0; i < std::min(flaps.size(), outside.size()); ++i)
    outside[i] = outside[i] && !flaps[i];
  const auto count = std::count(outside.begin(), outside.end(), true);
  if (count == 0) return;
  // Values that cross a limit many times in a minute give one span.
  const auto records_per_minute = static_cast<std::size_t>(60.0 / flight.time().step);
  summary.notes.emplace_back(fmt::format(
      "delta-p is extrapolated in {}{} of {} records (bit outside_domain), in flight outside the domain of "
      "the law; these records have no uncertainty: {}",
      flaps.empty() ? "" : "another ", count, outside.size(),
      add_spans(flight, "outside the domain", outside, records_per_minute, summary)));
}

}  // namespace pcor::internal

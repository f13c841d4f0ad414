#include "process/sample_statistics.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>

#include <pcor/residuals/statistics.hpp>

namespace pcor::internal {
namespace {

/// Bits of samples that have no delta-p.
constexpr auto prevent_delta_p = {Quality::static_pressure_missing,
                                  Quality::dynamic_pressure_missing,
                                  Quality::impossible_static_pressure,
                                  Quality::impossible_dynamic_pressure,
                                  Quality::effect_input_missing,
                                  Quality::defect_exceeds_dynamic_pressure,
                                  Quality::no_airflow};

}  // namespace

SampleStatistics::SampleStatistics(const Chain& chain, bool states_defect_error, ProcessSummary& summary)
    : chain_(chain),
      states_defect_error_(states_defect_error),
      summary_(summary),
      thermometer_(chain.recorded(Quantity::recovery_temperature) ? Quantity::recovery_temperature
                                                                  : Quantity::ambient_temperature) {
  summary_.min_defect = std::numeric_limits<double>::infinity();
  summary_.max_defect = -summary_.min_defect;
}

double SampleStatistics::add(const State<double>& state, QualityFlags quality) {
  const std::size_t record = record_of_next();
  ++next_;
  const double defect = state[Quantity::corrected_static_pressure] - state[Quantity::port_static_pressure];
  const bool flies = state[Quantity::dynamic_pressure] >= summary_.flying_dynamic_pressure;
  if (!is_missing(defect) && !is_missing(state[Quantity::corrected_dynamic_pressure])) {
    ++summary_.corrected;
    if (flies) {
      ++summary_.in_flight;
      summary_.mean_defect += defect;  // the sum, until the end
      summary_.min_defect = std::min(summary_.min_defect, defect);
      summary_.max_defect = std::max(summary_.max_defect, defect);
      const double uncertainty = state[Quantity::static_defect_uncertainty];
      if (states_defect_error_ && !is_missing(uncertainty)) {
        ++uncertain_samples_;
        sum_of_uncertainties_ += uncertainty;
      }
    }
  }
  const double temperature = state[thermometer_];
  if (!is_missing(defect) && !is_missing(temperature) && quality.has(Quality::temperature_missing)) {
    ++impossible_temperatures_;
    sum_of_impossible_ += temperature;
  }
  if (flies && chain_.is_outside_domain(state)) {
    outside_.resize(summary_.records);
    outside_[record] = true;
  }
  double bits = 0.0;
  for (std::size_t i = 0; quality.bits() != 0 && i < quality_info.size(); ++i) {
    const Quality bit = quality_info[i].bit;
    if (!quality.has(bit) || bit == Quality::filter_window_incomplete) continue;
    ++summary_.flagged[i];
    bits += static_cast<double>(bit);
  }
  return bits;
}

void SampleStatistics::count(Quality bit) {
  for (std::size_t i = 0; i < quality_info.size(); ++i)
    summary_.flagged[i] += quality_info[i].bit == bit ? 1 : 0;
}

std::string SampleStatistics::uncorrected_text() const {
  constexpr std::size_t few = 100;
  if (few * summary_.corrected >= summary_.samples) return {};
  std::string text = fmt::format("{} of {} samples could be corrected", summary_.corrected, summary_.samples);
  std::size_t most = 0;
  for (std::size_t i = 0; i < quality_info.size(); ++i) {
    const bool prevents = std::find(prevent_delta_p.begin(), prevent_delta_p.end(), quality_info[i].bit) !=
                          prevent_delta_p.end();
    if (prevents && summary_.flagged[i] > summary_.flagged[most]) most = i;
  }
  // The reason of a missing flow angle is more specific.
  for (std::size_t i = 0; i < quality_info.size(); ++i) {
    if (quality_info[i].bit == Quality::impossible_radome_pressure &&
        quality_info[most].bit == Quality::effect_input_missing &&
        10 * summary_.flagged[i] > 9 * summary_.flagged[most])
      most = i;
  }
  if (const std::size_t count = summary_.flagged[most]; count > 0) {
    text += fmt::format("; most frequent reason: {}, {} ({} sample{})", quality_info[most].name,
                        quality_info[most].brief, count, count == 1 ? "" : "s");
  }
  return text;
}

void SampleStatistics::finish() {
  if (summary_.in_flight > 0) {
    summary_.mean_defect /= static_cast<double>(summary_.in_flight);
  } else {
    summary_.mean_defect = summary_.min_defect = summary_.max_defect = missing<double>();
  }
  if (uncertain_samples_ == 0) return;
  summary_.defect_uncertainty = sum_of_uncertainties_ / static_cast<double>(uncertain_samples_);
  if (summary_.defect_uncertainty < max_defect_error) return;
  summary_.notes.push_back(warning_note(
      fmt::format("delta-p is not determined: its standard uncertainty is {:.2f} hPa on average; "
                  "refit the model with a laser, a second static system, or GPS wind in circles "
                  "or reverse headings",
                  summary_.defect_uncertainty)));
}

void SampleStatistics::note_impossible_temperature(const ModelDefinition& model) {
  if (2 * impossible_temperatures_ <= summary_.corrected) return;
  summary_.notes.push_back(warning_note(fmt::format(
      "set the unit of {} in [units] of the model, or name another variable: {} of {} "
      "corrected samples have no possible "
      "temperature; {} is {:.0f} K in these samples on average",
      info_of(thermometer_).name, impossible_temperatures_, summary_.corrected,
      model.variable_of(thermometer_), sum_of_impossible_ / static_cast<double>(impossible_temperatures_))));
}

}  // namespace pcor::internal

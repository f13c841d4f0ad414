#include "temperature/temperature_notes.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <map>

#include <pcor/base/format_estimate.hpp>
#include <pcor/model_io/model_definition.hpp>
#include "temperature/parts.hpp"

namespace pcor::internal {
namespace {

constexpr double much_noise = 3.0;  // m, of the GPS height
constexpr double much_drift = 1.0;  // m in a minute; a usual slope of isobars, 10 m in 100 km, makes 0.7

/// Whether heights detect an error of the static-pressure model.
bool is_seen(const LawError& error) {
  return std::abs(error.change) > significant_ratio * error.standard_error && error.range > usual_zero;
}

/// Comparison of an error that heights detect with its stated size.
const char* size_text(const LawError& error) {
  if (is_beyond_prior(error)) return "but an undetected error of the same size may remain";
  return std::abs(error.change) < error.size ? "and is within the stated error of the model"
                                             : "and is within three times the stated error of the model";
}

}  // namespace

bool is_beyond_prior(const LawError& error) {
  return is_seen(error) && std::abs(error.change) > significant_ratio * error.size;
}

std::vector<std::string> temperature_warnings(const TemperatureResult& result) {
  std::vector<std::string> warnings;
  if (result.is_implausible()) {
    const TemperatureCorrection largest = result.largest_correction();
    const bool recovers = result.model.variables.count(Quantity::recovery_temperature) > 0;
    warnings.push_back(fmt::format(
        "compare the result with {}: a correction of {} K is {:.0f} times the usual error of a thermometer, "
        "{} K; {}a lag or an error of the heights is more likely",
        recovers ? "the recorded ambient temperature" : "another thermometer",
        format_estimate(largest.correction, largest.standard_error),
        std::abs(largest.correction) / usual_thermometer_error, usual_thermometer_error,
        recovers ? "a wrong recovery factor, " : ""));
  }
  const auto differ = [&warnings](const std::vector<PartCorrection>& parts, double spread, const char* who) {
    if (!(spread > 0.0)) return;
    std::vector<std::string> texts;
    for (const PartCorrection& part : parts)
      texts.push_back(
          fmt::format("{} {} K", part.part, format_estimate(part.correction, part.standard_error)));
    const Disagreement apart = disagreement_of(parts);
    warnings.push_back(fmt::format(
        "{} differ by {:.2g} K, p = {:.1g} (threshold 0.01); this standard deviation is included in "
        "the errors: {}; chi-squared {:.1f} with {} degrees of freedom",
        who, spread, apart.p_value, fmt::join(texts, ", "), apart.chi_squared, parts.size() - 1));
  };
  differ(result.parts_by_flight, result.spread_of_flights, "the thermometers of the flights");
  if (result.spread_of_climbs >= result.spread_of_halves)
    differ(result.parts_by_climb, result.spread_of_climbs, "climbs and descents");
  else
    differ(result.parts_by_half, result.spread_of_halves, "the halves of the flights");
  for (const LawError& error : result.law_errors) {
    if (!is_seen(error)) continue;
    const bool is_in_model = has_effect(result.model, error.effect);
    const std::string by = format_estimate(error.change, error.standard_error);
    warnings.push_back(fmt::format(
        "{}; this error was removed before fitting the thermometer, {}; if a laser or a second system "
        "confirms the error, {}",
        is_in_model
            ? fmt::format("{} of {} is too small by {} by GPS heights, which changes delta-p by {:.2f} hPa",
                          error.parameter, error.effect, by, error.range)
            : fmt::format("delta-p lacks {1:.2f} hPa by GPS heights that varies like {0} ({2} = {3})",
                          error.effect, error.range, error.parameter, by),
        size_text(error), is_in_model ? "refit first" : "add the effect (pcor add) and refit"));
  }
  if (std::abs(result.humidity_change) > significant_ratio * result.humidity_error) {
    warnings.push_back(
        fmt::format("compare the humidity with another hygrometer: by GPS heights the vapour pressure is too "
                    "small by {}",
                    format_estimate(result.humidity_change, result.humidity_error)));
  }
  return warnings;
}

Notes noise_notes(const TemperatureResult& result) {
  Notes notes;
  const double size = std::max(result.gps_noise, result.gps_wander);
  if (size > much_noise || result.drift > much_drift) {
    notes.push_back(fmt::format(
        "the fitted noise is large (GPS height {:.1f} m, drift of the integral {:.1f} m per minute): "
        "run pcor check; its layers show a lag of the pressure; other causes are a lag of the "
        "thermometer and a pressure error in climbs",
        size, result.drift));
  }
  if (std::abs(result.innovation_correlation) > 0.1) {
    notes.push_back(
        fmt::format("errors may be wrong by 10 to 30 %: the noise model is not exact (correlation of the "
                    "filter innovations {:+.2f})",
                    result.innovation_correlation));
  }
  return notes;
}

Notes method_notes(const TemperatureOptions& options, bool attack_is_unknown) {
  Notes notes;
  if (attack_is_unknown) {
    notes.emplace_back(
        "a pressure error that varies with the angle of attack may resemble a thermometer error: the angle "
        "is unknown");
  }
  if (options.slope == IsobarSlope::none ||
      (options.slope == IsobarSlope::fitted && options.slope_size == 0.0)) {
    notes.emplace_back(
        "isobars are assumed to be level (--slope fitted estimates their slope); a slope of 10 m in 100 km "
        "in a climb of 5 m/s is equivalent to 1 K");
  }
  return notes;
}

Notes record_notes(const std::vector<HeightRecord>& records, IsobarSlope slope) {
  Notes notes;
  std::size_t steps = 0;
  std::size_t spikes = 0;
  std::size_t missing = 0;
  std::size_t unknown_ways = 0;
  std::map<Note, std::size_t> of_flights;
  for (const HeightRecord& record : records) {
    steps += record.height_steps;
    spikes += record.height_spikes;
    missing += record.missing_heights;
    unknown_ways += record.unknown_ways;
    for (const Note& note : record.notes) ++of_flights[note];
  }
  if (missing > 0) notes.push_back(fmt::format("{} samples have no GPS height", missing));
  if (unknown_ways > 0 && slope != IsobarSlope::none) {
    notes.push_back(fmt::format(
        "{} samples have no ground velocity; airspeed and heading, or the last velocity, were used",
        unknown_ways));
  }
  if (steps + spikes > 0) {
    notes.push_back(
        fmt::format("the GPS height has {} step(s), at which the integral restarts, and {} sample(s) in "
                    "spikes, which are excluded",
                    steps, spikes));
  }
  for (const auto& [note, count] : of_flights) {
    notes.push_back(note);
    if (count > 1 && records.size() > 1) notes.back().text += fmt::format(" ({} flights)", count);
  }
  return notes;
}

}  // namespace pcor::internal

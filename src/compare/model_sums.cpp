#include "compare/model_sums.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <string_view>
#include <utility>

#include "numerics/missing.hpp"

namespace pcor::internal {
namespace {

constexpr double worst_length = 60.0;  // s
constexpr std::size_t worst_count = 5;
// hPa2: for a reference delta-p that varies less than the rounding of a file, R2 is undefined.
constexpr double min_variance = 1e-10;
constexpr std::size_t min_in_band = 30;

/// Bands of a variable: all samples with equal `floor(value / width)`.
struct Banding {
  const char* name;
  double width;
  const char* format;  // format of the limits
  double (*value)(const FlightResiduals&, std::size_t);
};

double at(const std::vector<double>& values, std::size_t sample) {
  return values.empty() ? nan : values[sample];
}

const std::array<Banding, banding_count> bandings{{
    {"altitude", 1000.0, "{} {:.0f} to {:.0f} m",
     [](const FlightResiduals& f, std::size_t i) { return at(f.samples->motion.altitude, i); }},
    {"Mach", 0.05, "{} {:.2f} to {:.2f}",
     [](const FlightResiduals& f, std::size_t i) { return at(f.mach, i); }},
    {"angle of attack", 1.0, "{} {:.0f} to {:.0f} deg",
     [](const FlightResiduals& f, std::size_t i) { return at(f.samples->motion.attack, i); }},
    {"sideslip", 1.0, "{} {:.0f} to {:.0f} deg",
     [](const FlightResiduals& f, std::size_t i) { return at(f.samples->motion.sideslip, i); }},
}};

std::string regimes_text(const RegimeSet& regimes) {
  std::vector<std::string_view> names;
  for (std::size_t i = 0; i < regime_count; ++i) {
    if (regimes[i]) names.push_back(regime_info[i].name);
  }
  return fmt::format("{}", fmt::join(names, ", "));
}

void keep_the_worst(std::vector<WorstInterval>& worst) {
  std::stable_sort(worst.begin(), worst.end(), [](const WorstInterval& a, const WorstInterval& b) {
    return fails_more(a.statistics, b.statistics);
  });
  if (worst.size() > worst_count) worst.resize(worst_count);
}

std::vector<WorstInterval> worst_of(const FlightResiduals& flight, const std::vector<double>& values,
                                    const NoiseFloor& noise, const std::vector<RegimeSet>& regimes) {
  const FlightSamples& samples = *flight.samples;
  const auto enough = static_cast<std::size_t>(0.5 * worst_length / samples.step);
  std::vector<WorstInterval> worst;
  for (std::size_t first = 0; first < values.size();) {
    ResidualSums sums;
    RegimeSet flown;
    std::size_t i = first;
    for (; i < values.size() && samples.time[i] < samples.time[first] + worst_length; ++i) {
      if (std::isnan(values[i])) continue;
      sums.add(values[i], noise.local_rms[i]);
      flown |= regimes[i];
    }
    if (sums.samples > 0 && sums.samples >= enough) {
      sums.sum_variance = nan;  // the error of a minute is not reported
      worst.push_back({samples.name, samples.time[first] - 0.5 * samples.step,
                       samples.time[i - 1] + 0.5 * samples.step, sums.statistics(), regimes_text(flown)});
    }
    first = i;
  }
  keep_the_worst(worst);
  return worst;
}

}  // namespace

void ModelSums::add(const ModelSums& other) {
  all.add(other.all);
  flaps_out.add(other.flaps_out);
  reference_defect += other.reference_defect;
  reference_defect_squares += other.reference_defect_squares;
  pressures.add(other.pressures);
  by_uncertainty = by_uncertainty.size() == 0 ? other.by_uncertainty
                                              : Eigen::VectorXd(by_uncertainty + other.by_uncertainty);
  for (std::size_t r = 0; r < regime_count; ++r) regimes[r].add(other.regimes[r]);
  for (std::size_t b = 0; b < bandings.size(); ++b) {
    for (const auto& [band, sums] : other.bands[b]) bands[b][band].add(sums);
  }
  worst.insert(worst.end(), other.worst.begin(), other.worst.end());
  keep_the_worst(worst);
}

ModelSums sums_of(const FlightResiduals& flight, std::size_t model, const NoiseFloor& noise,
                  SummedRecords& records) {
  const std::vector<double>& values = flight.values[model];
  const std::vector<double>& reference_defect = flight.reference_defects[model];
  const FlightSamples& samples = *flight.samples;
  const std::vector<RegimeSet> regimes = regimes_of_samples(samples.time, samples.intervals);
  ModelSums sums;
  std::map<const ResidualSums*, std::vector<std::size_t>> records_of;
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (std::isnan(values[i])) continue;
    const auto count = [&](ResidualSums& part) {
      part.add(values[i], noise.local_rms[i]);
      records_of[&part].push_back(i);
    };
    count(sums.all);
    sums.reference_defect += reference_defect[i];
    sums.reference_defect_squares += reference_defect[i] * reference_defect[i];
    const double pressure = flight.corrected_pressures[model][i];
    sums.pressures.add(pressure, pressure + values[i]);
    for (std::size_t r = 0; r < regime_count; ++r) {
      if (regimes[i][r]) count(sums.regimes[r]);
    }
    for (std::size_t b = 0; b < bandings.size(); ++b) {
      const double value = bandings[b].value(flight, i);
      if (!std::isnan(value)) count(sums.bands[b][std::lround(std::floor(value / bandings[b].width))]);
    }
  }
  sums.each_part([&](const ResidualSums& part) { records.parts.push_back(std::move(records_of[&part])); });
  records.residual = BinnedResidual(values, samples.time, samples.step);
  sums.worst = worst_of(flight, values, noise, regimes);
  if (has_value(flight.flaps_out[model])) sums.flaps_out = sums_of_flight(samples, flight.flaps_out[model]);
  return sums;
}

ModelComparison comparison_of(const std::string& name, const Reference& reference, ModelSums sums,
                              std::vector<PartStatistics> flights) {
  ModelComparison result;
  result.name = name;
  result.reference = reference.name();
  const bool level_is_determined = sums.all.determines_level();
  result.all = sums.all.statistics();
  result.flaps_out = sums.flaps_out.statistics();
  result.flights = std::move(flights);
  result.worst = std::move(sums.worst);
  const auto count = static_cast<double>(sums.all.samples);
  const double variation =
      sums.reference_defect_squares - sums.reference_defect * sums.reference_defect / count;
  const bool varies = reference.is_static_pressure() && variation > count * min_variance;
  if (reference.is_static_pressure()) result.static_pressure = orthogonal_fit(sums.pressures);
  result.r_squared = varies ? 1.0 - sums.all.squares / variation : nan;
  if (sums.all.samples > 0)
    result.reference_error = sums.by_uncertainty.norm() / static_cast<double>(sums.all.samples);
  const double memory = sums.all.sum_variance / (count * result.all.scatter() * result.all.scatter());
  result.autocorrelation_time = std::isfinite(memory) ? std::max(1.0, memory) : nan;
  for (std::size_t r = 0; r < regime_count; ++r) {
    if (sums.regimes[r].samples > 0)
      result.regimes.push_back(
          {std::string(regime_info[r].name), sums.regimes[r].statistics(level_is_determined)});
  }
  for (std::size_t b = 0; b < bandings.size(); ++b) {
    for (const auto& [band, part] : sums.bands[b]) {
      if (part.samples < min_in_band) continue;
      const double from = static_cast<double>(band) * bandings[b].width;
      result.bands.push_back(
          {fmt::format(fmt::runtime(bandings[b].format), bandings[b].name, from, from + bandings[b].width),
           part.statistics(level_is_determined)});
    }
  }
  return result;
}

}  // namespace pcor::internal

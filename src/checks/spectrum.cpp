#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include <pcor/numerics/line_fit.hpp>
#include <pcor/numerics/noise.hpp>
#include <pcor/physics/geodesy.hpp>
#include "checks/leg_pair.hpp"
#include "checks/manoeuvre_segment.hpp"
#include "numerics/missing.hpp"
#include "numerics/spectrum.hpp"
#include "roles/resolution.hpp"

namespace pcor::internal {
namespace {

/// Largest acceptable noise of delta-p, hPa: the rms of the memo's fits (eq. 18 and 20).
constexpr double max_noise = 0.3;
constexpr std::size_t segment_length = 256;  // samples
constexpr std::size_t min_segments = 8;      // minimum for a slope with an error
constexpr double flattest_fall = -0.8;       // half of -5/3: nearer to a white floor than to turbulence
constexpr double margin = 2.0;               // standard errors

/// Series of the spectrum.
struct Source {
  std::string name;   ///< "delta-p from LAMS"
  std::string title;  ///< label of an axis
  std::vector<double> (*series)(const CheckedFlight& flight);
};

std::vector<double> laser_defect(const CheckedFlight& flight) {
  if (!flight.air.laser) return {};
  return masked(flight.air.laser->static_defect, flight.air.flying);
}

std::vector<double> second_system(const CheckedFlight& flight) {
  if (!flight.second || flight.second->pressure.size() != flight.air.size()) return {};
  return masked(difference(flight.second->pressure, flight.air.pressure), flight.air.flying);
}

/// D-value as a pressure: rho g for each metre.
std::vector<double> d_value_as_pressure(const CheckedFlight& flight) {
  const FlightAir& air = flight.air;
  if (air.d_value.empty() || air.temperature.empty() || !height_problem(air).empty()) return {};
  std::vector<double> values(air.size());
  for (std::size_t i = 0; i < air.size(); ++i)
    values[i] = air.d_value[i] * constants::standard_gravity * air.pressure[i] /
                (air.gas_constant[i] * air.temperature[i]);
  return masked(std::move(values), air.flying);
}

/// Power spectral densities, one for each segment.
struct Spectrum {
  double step = 1.0;                                ///< s
  std::vector<std::vector<double>> periodograms{};  ///< hPa2/Hz at k/(256 steps), k = 1 to 128

  double frequency(std::size_t k) const { return static_cast<double>(k + 1) / (segment_length * step); }
};

/// One-sided power spectral density of a segment. It sums to the variance.
std::vector<double> density_of(const double* values, double step) {
  const auto [squares, window] = periodogram(values, segment_length);
  std::vector<double> density(segment_length / 2);
  for (std::size_t k = 0; k < density.size(); ++k) density[k] = squares[k + 1] * step / window;
  return density;
}

Spectrum spectrum_of(const CheckedFlights& flights, const Source& source) {
  Spectrum spectrum;
  spectrum.step = usual_step(flights, source.series);
  for (const CheckedFlight& flight : flights) {
    const std::vector<double> values = source.series(flight);
    if (values.empty() || !has_step(flight, spectrum.step)) continue;
    const auto segments = contiguous_segments(values, flight.air.time(), flight.air.step());
    for (const std::size_t first : overlapping_parts(segments, segment_length))
      spectrum.periodograms.push_back(density_of(&values[first], spectrum.step));
  }
  return spectrum;
}

/// Slope of log power over log frequency in the last two octaves, from single segments: their scatter gives
/// its error. (Segments overlap by half, but are almost independent through Hann's window.)
Estimate fall_of(const Spectrum& spectrum) {
  std::vector<double> slopes;
  for (const std::vector<double>& each : spectrum.periodograms) {
    PairMoments logarithms;
    // The last frequency has another distribution.
    for (std::size_t k = segment_length / 8 - 1; k + 1 < segment_length / 2; ++k) {
      if (each[k] > 0.0) logarithms.add(std::log(spectrum.frequency(k)), std::log(each[k]));
    }
    const double slope = ordinary_fit(logarithms).slope;
    if (std::isfinite(slope)) slopes.push_back(slope);
  }
  if (slopes.size() < 2) return {nan, nan};
  const auto count = static_cast<double>(slopes.size());
  return {mean_of(slopes), standard_deviation(slopes) / std::sqrt(count)};
}

std::string in_words(const Estimate& fall) {
  if (fall.value - margin * fall.error > flattest_fall)
    return "the spectrum flattens towards a floor of noise or resolution";
  if (fall.value + margin * fall.error < flattest_fall)
    return "the spectrum still falls like turbulence (-5/3), and the noise is below this";
  return "too uncertain to separate a noise floor from turbulence (-5/3)";
}

struct Octave {
  double longest;  ///< s
  double shortest;
  Estimate rms;  ///< hPa
};

std::vector<Octave> octaves_of(const Spectrum& spectrum) {
  std::vector<Octave> octaves;
  for (std::size_t last = segment_length / 2; last >= 2; last /= 2) {
    // Indices of the frequencies above last/2 and up to last.
    std::vector<double> power;
    for (const std::vector<double>& each : spectrum.periodograms) {
      double sum = 0.0;
      for (std::size_t k = last / 2; k < last; ++k) sum += each[k] / (segment_length * spectrum.step);
      power.push_back(sum);
    }
    const double rms = std::sqrt(mean_of(power));
    const double error =
        power.size() < 2 || !(rms > 0.0)
            ? 0.0
            : standard_deviation(power) / std::sqrt(static_cast<double>(power.size())) / (2.0 * rms);
    const double length = static_cast<double>(segment_length) * spectrum.step;
    octaves.push_back(
        {length / static_cast<double>(last) * 2.0, length / static_cast<double>(last), {rms, error}});
  }
  return octaves;
}

/// Magnitude of the change of delta-p from LAMS with the airspeed at the same total temperature, hPa per m/s:
/// mean over all flights.
double pressure_per_speed(const CheckedFlights& flights) {
  std::vector<double> sensitivities;
  for (const CheckedFlight& flight : flights) {
    const FlightAir& air = flight.air;
    for (std::size_t i = 0; i < air.airspeed.size(); ++i) {
      if (air.flying[i])
        sensitivities.push_back(-pressure_per_airspeed(air.pressure[i], air.mach[i], air.airspeed[i]));
    }
  }
  return mean_of(sensitivities);
}

/// Coarsest recording resolution of a static pressure, hPa.
double coarsest_step(const CheckedFlights& flights) {
  double step = 0.0;
  for (const CheckedFlight& flight : flights)
    step = std::max(step, resolution_of(flight.air.measured_static));
  return step;
}

}  // namespace

CheckResult check_spectrum(const CheckedFlights& flights) {
  const std::vector<Source> sources{{"delta-p from LAMS", "delta-p", laser_defect},
                                    {"the difference of the two static systems", "difference", second_system},
                                    {"the D-value as a pressure", "D-value", d_value_as_pressure}};
  Spectrum spectrum;
  const Source* source = nullptr;
  for (const Source& each : sources) {
    spectrum = spectrum_of(flights, each);
    source = &each;
    if (spectrum.periodograms.size() >= min_segments) break;
  }
  if (spectrum.periodograms.size() < min_segments) {
    return not_run(
        fmt::format("no flight has a laser, a second static system or a GPS height in the air over {} "
                    "segments of {} samples without a gap",
                    min_segments, segment_length));
  }
  const std::vector<Octave> octaves = octaves_of(spectrum);
  const Estimate fall = fall_of(spectrum);
  // Rms of white noise with the density of the highest octave, the upper half of all frequencies.
  const Estimate floor = std::sqrt(2.0) * octaves.front().rms;
  const double per_speed = pressure_per_speed(flights);

  CheckResult result;
  set_verdict({test_statistic(floor, max_noise, "hPa", "white noise")}, result);
  if (result.verdict == CheckVerdict::inconsistent && !(fall.value - margin * fall.error > flattest_fall))
    mark_inconclusive("the spectrum does not flatten, so the power is an upper limit of the noise", result);
  const double step = coarsest_step(flights);
  if (step >= coarse_pressure) {
    mark_inconclusive(
        fmt::format("the static pressure is recorded in steps of {:.2g} hPa, which cause {:.2g} hPa of "
                    "noise: the noise of its sensor cannot be determined",
                    step, rounding_of(step)),
        result);
  }
  result.finding =
      fmt::format("At the highest frequencies {} has the power of white noise of {:.3f} +- {:.3f} hPa",
                  source->name, floor.value, floor.error);
  if (std::isfinite(per_speed))
    result.finding += fmt::format(" (equivalent to {:.2f} m/s of airspeed)", floor.value / per_speed);
  result.finding += fmt::format("; over the last two octaves power varies as frequency to the {}: {}.",
                                format_number(fall, ""), in_words(fall));
  const auto has_series = [source](const CheckedFlight& flight) { return has_value(source->series(flight)); };
  note_other_steps(flights, spectrum.step, has_series, result.notes);
  result.limitations =
      "The check cannot identify the noisy sensor: pressures, thermometer, laser and the air between laser "
      "and pitot tube add up. Noise of the transducers and small eddies are indistinguishable unless the "
      "spectrum flattens, and means over the sample interval hide part of both. Errors that last longer than "
      "two minutes are not tested.";
  add_number("floor", "_hpa", floor, result);
  result.numbers.emplace_back("floor_m_s", floor.value / per_speed);
  add_number("slope", "", fall, result);
  result.numbers.emplace_back("segments", static_cast<double>(spectrum.periodograms.size()));
  ReportTable table{"Power by period: numbers",
                    fmt::format("Spectrum of {}, over {} segments of {} samples.", source->name,
                                spectrum.periodograms.size(), segment_length),
                    {"periods", "rms, hPa", "std. error, hPa"}};
  for (const Octave& octave : octaves) {
    const std::string periods = fmt::format("{:.3g} to {:.3g} s", octave.shortest, octave.longest);
    table.rows.push_back(
        {periods, fmt::format("{:.4f}", octave.rms.value), fmt::format("{:.4f}", octave.rms.error)});
    result.bars.push_back({periods, octave.rms.value, octave.rms.error});
  }
  result.tables = {std::move(table)};
  result.columns = {column_of(flights, "spectrum series", source->title, "hPa", source->series)};
  return result;
}

}  // namespace pcor::internal

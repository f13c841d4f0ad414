#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include <pcor/base/utc.hpp>
#include <pcor/numerics/noise.hpp>
#include "checks/manoeuvre_segment.hpp"
#include "numerics/missing.hpp"

namespace pcor::internal {
namespace {

/// Smallest relevant difference, K: the typical error of the thermometer (memo, after eq. 22).
constexpr double min_temperature_difference = 0.3;
constexpr double boundary_layer = 1000.0;  // m above the field
constexpr double altitude_band = 1000.0;   // m
constexpr std::size_t min_in_cloud = 30;   // minimum number of samples to estimate a scatter
constexpr std::size_t min_samples = 60;    // minimum number of samples of a part
constexpr double max_period = 256.0;       // s
constexpr double suspect_share = 0.5;      // fraction of missing laser values in a cloud that indicates an
                                           // iced window

/// Difference of all flights of one record interval, one flight after another.
struct Differences {
  std::vector<double> time{};
  std::vector<double> values{};  ///< ATLAMS minus the thermometer, K; NaN if either is unusable
  std::vector<double> altitude{};
  std::vector<bool> in_cloud{};
  std::vector<bool> near_ground{};  ///< samples in the lowest kilometre above the field
  double step = nan;                ///< record interval with the most differences, s
};

/// Pressure altitude at the beginning of the flight, m: on the ground, or the minimum.
double field_of(const FlightAir& air) {
  if (!air.pressure_altitude.empty() && !air.flying.front() && std::isfinite(air.pressure_altitude.front()))
    return air.pressure_altitude.front();
  double lowest = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < air.size(); ++i) {
    if (air.flying[i] && air.pressure_altitude[i] < lowest) lowest = air.pressure_altitude[i];
  }
  return lowest;
}

std::vector<double> difference_of(const FlightAir& air) {
  std::vector<double> difference(air.size(), nan);
  if (!air.laser || air.temperature.empty()) return difference;
  for (std::size_t i = 0; i < air.size(); ++i) {
    if (air.flying[i]) difference[i] = air.laser->temperature[i] - air.temperature[i];
  }
  return difference;
}

Differences all_differences(const CheckedFlights& flights) {
  Differences all;
  all.step = usual_step(flights, [](const CheckedFlight& flight) { return difference_of(flight.air); });
  for (const CheckedFlight& flight : flights) {
    const FlightAir& air = flight.air;
    const std::vector<double> difference = difference_of(air);
    if (!has_value(difference) || !has_step(flight, all.step)) continue;
    const std::vector<RegimeSet> regimes = regimes_of_samples(air.time(), air.samples->intervals);
    const double field = field_of(air);
    for (std::size_t i = 0; i < air.size(); ++i) {
      all.time.push_back(air.time()[i]);
      all.values.push_back(difference[i]);
      all.altitude.push_back(air.pressure_altitude[i]);
      all.in_cloud.push_back(regimes[i][static_cast<std::size_t>(Regime::cloud)]);
      all.near_ground.push_back(air.pressure_altitude[i] < field + boundary_layer);
    }
  }
  return all;
}

/// Values of the samples that meet a condition; NaN for the others.
template <class Condition>
std::vector<double> values_if(const Differences& all, const Condition& condition) {
  std::vector<double> values(all.values.size(), nan);
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (condition(i)) values[i] = all.values[i];
  }
  return values;
}

/// Mean, error and scatter of a subset of the samples.
struct Part {
  std::string name;
  LeastSquares fit;
};

template <class Condition>
Part part_of(const Differences& all, std::string name, const Condition& condition) {
  return {std::move(name), mean_of(values_if(all, condition), all.time, all.step)};
}

ReportTable part_table(const std::vector<Part>& parts) {
  ReportTable table{"Laser temperature minus thermometer",
                    "Errors include autocorrelation and slow drift of the differences.",
                    {"where", "samples", "mean, K", "std. error, K", "scatter, K"}};
  for (const Part& part : parts) {
    if (part.fit.samples < min_samples) continue;
    table.rows.push_back(
        {part.name, std::to_string(part.fit.samples), fmt::format("{:+.3f}", part.fit.coefficients[0].value),
         fmt::format("{:.3f}", part.fit.coefficients[0].error), fmt::format("{:.3f}", part.fit.rms)});
  }
  return table;
}

/// Rms difference between neighbouring means of `width` samples, divided by the square root of two: the noise
/// of one mean, at periods of about twice the width (Allan deviation). NaN for fewer than ten differences.
double allan_deviation(const std::vector<double>& values, const std::vector<Segment>& segments,
                       std::size_t width) {
  double squares = 0.0;
  std::size_t count = 0;
  for (const Segment& segment : segments) {
    double before = nan;
    for (std::size_t first = 0; first + width <= segment.count; first += width) {
      double mean = 0.0;
      for (std::size_t k = 0; k < width; ++k)
        mean += values[segment.first + first + k] / static_cast<double>(width);
      if (!std::isnan(before)) {
        squares += 0.5 * (mean - before) * (mean - before);
        ++count;
      }
      before = mean;
    }
  }
  return count < 10 ? nan : std::sqrt(squares / static_cast<double>(count));
}

/// Adds the table and the bars of the noise by period.
void add_noise_by_period(const Differences& all, CheckResult& result) {
  ReportTable table{
      "Noise of the difference by period: numbers",
      "K, means over half the period: out of cloud, in the lowest kilometre above the field, and above it.",
      {"period, s", "lowest km", "above"}};
  std::array<std::vector<double>, 2> values;  // near the ground, and above
  std::array<std::vector<Segment>, 2> segments;
  for (const std::size_t part : {0U, 1U}) {
    values[part] =
        values_if(all, [&](std::size_t i) { return all.near_ground[i] == (part == 0) && !all.in_cloud[i]; });
    segments[part] = contiguous_segments(values[part], all.time, all.step);
  }
  for (std::size_t width = 1; 2.0 * static_cast<double>(width) * all.step <= max_period; width *= 2) {
    const std::string period = fmt::format("{:.0f}", 2.0 * static_cast<double>(width) * all.step);
    std::vector<std::string> row{period};
    for (const std::size_t part : {0U, 1U}) {
      const double noise = allan_deviation(values[part], segments[part], width);
      row.push_back(std::isnan(noise) ? "" : fmt::format("{:.3f}", noise));
      if (!std::isnan(noise))
        result.bars.push_back({fmt::format("{} s, {}", period, part == 0 ? "lowest km" : "above"), noise});
    }
    table.rows.push_back(std::move(row));
  }
  result.tables.push_back(std::move(table));
}

/// The clouds, with the state of the laser there; the last cell of a suspect one has a remark.
ReportTable cloud_table(const CheckedFlights& flights, double outside) {
  ReportTable table{
      "Clouds",
      "ATLAMS minus the thermometer in each cloud of 30 samples or more.",
      {"flight", "start (UTC)", "end", "laser missing, %", "mean, K", "std. error, K", "remark"}};
  for (const ManoeuvreSegment& cloud : segments_of_regime(flights, Regime::cloud)) {
    const FlightAir& air = cloud.flight->air;
    if (!air.laser || air.temperature.empty() || cloud.records.size() < min_in_cloud) continue;
    const std::vector<double> values = cloud.of(difference_of(air));
    const auto missing = static_cast<double>(std::count_if(values.begin(), values.end(),
                                                           [](double x) { return std::isnan(x); })) /
                         static_cast<double>(values.size());
    const LeastSquares mean = mean_of(values, cloud.time(), cloud.step());
    const Estimate change{mean.coefficients[0].value - outside, mean.coefficients[0].error};
    std::string remark;
    if (missing > suspect_share)
      remark = "laser mostly missing: an iced window";
    else if (classify(change, min_temperature_difference) == CheckVerdict::inconsistent)
      remark = "suspect";
    table.rows.push_back({air.samples->name, utc_text(cloud.interval.begin),
                          utc_text(cloud.interval.end, "%H:%M:%S"), fmt::format("{:.0f}", 100.0 * missing),
                          std::isnan(change.value) ? "" : fmt::format("{:+.2f}", mean.coefficients[0].value),
                          std::isnan(change.value) ? "" : fmt::format("{:.2f}", mean.coefficients[0].error),
                          remark});
  }
  return table;
}

/// A temperature in the air, degC.
std::vector<double> celsius(std::vector<double> values, const FlightAir& air) {
  for (double& value : values) value -= constants::ice_point;
  return masked(std::move(values), air.flying);
}

}  // namespace

CheckResult check_lams_temperature(const CheckedFlights& flights) {
  const bool has_laser = std::any_of(flights.begin(), flights.end(),
                                     [](const CheckedFlight& f) { return f.air.laser.has_value(); });
  if (!has_laser) {
    return not_run(
        "no flight has a laser airspeed; if one was recorded, name lams_airspeed, attack and sideslip in the "
        "[variables] of a model (-m)");
  }
  const bool has_thermometer = std::any_of(flights.begin(), flights.end(), [](const CheckedFlight& f) {
    return f.air.laser && !f.air.temperature.empty();
  });
  if (!has_thermometer)
    return not_run(
        "no thermometer is known to compare with the laser; give a model (-m) "
        "with recovery_temperature in [variables]");
  const Differences all = all_differences(flights);
  const auto clear = [&](std::size_t i) { return !all.in_cloud[i]; };
  const Part outside = part_of(all, "clear air", clear);
  const Part inside = part_of(all, "cloud", [&](std::size_t i) { return all.in_cloud[i]; });
  if (outside.fit.samples < min_samples)
    return not_run("the laser and the thermometer have less than a minute out of cloud together");

  CheckResult result;
  const Estimate offset = outside.fit.coefficients[0];
  set_verdict({test_statistic(offset, min_temperature_difference, "K", "laser minus thermometer")}, result);
  const std::vector<double> clear_values = values_if(all, clear);
  const double noise = noise_floor(clear_values, all.time, all.step).rms;
  result.finding = fmt::format(
      "Out of cloud the laser temperature minus the thermometer temperature is {}, with a scatter of {:.2f} "
      "K, of which {:.2f} K is noise",
      format_number(offset, "K"), outside.fit.rms, noise);
  add_number("offset", "_k", offset, result);
  result.numbers.insert(result.numbers.end(), {{"scatter_k", outside.fit.rms},
                                               {"noise_k", noise},
                                               {"samples", static_cast<double>(outside.fit.samples)}});
  if (inside.fit.samples >= min_samples) {
    const Estimate in_cloud_offset = inside.fit.coefficients[0];
    result.finding += fmt::format("; in cloud it is {}", format_number(in_cloud_offset, "K"));
    add_number("cloud_offset", "_k", in_cloud_offset, result);
    const Estimate change{in_cloud_offset.value - offset.value,
                          std::hypot(in_cloud_offset.error, offset.error)};
    if (classify(change, min_temperature_difference) == CheckVerdict::inconsistent) {
      result.notes.emplace_back(
          "the difference changes in cloud: the thermometer is wet (reads low), or the laser's window is "
          "iced or drops scatter its light");
    }
  }
  result.finding += ".";
  const auto has_difference = [](const CheckedFlight& flight) {
    return has_value(difference_of(flight.air));
  };
  note_other_steps(flights, all.step, has_difference, result.notes);

  std::vector<Part> parts{
      outside, inside,
      part_of(all, "lowest km above the field, out of cloud",
              [&](std::size_t i) { return all.near_ground[i] && clear(i); }),
      part_of(all, "higher, out of cloud", [&](std::size_t i) { return !all.near_ground[i] && clear(i); })};
  const auto [lowest, highest] = range_of(all.altitude);
  for (double from = std::floor(lowest / altitude_band) * altitude_band; from < highest;
       from += altitude_band) {
    parts.push_back(
        part_of(all, fmt::format("from {:.0f} to {:.0f} m, out of cloud", from, from + altitude_band),
                [&](std::size_t i) {
                  return all.altitude[i] >= from && all.altitude[i] < from + altitude_band && clear(i);
                }));
  }
  result.tables.push_back(part_table(parts));
  add_noise_by_period(all, result);
  ReportTable clouds = cloud_table(flights, offset.value);
  const auto suspect = std::count_if(clouds.rows.begin(), clouds.rows.end(),
                                     [](const auto& row) { return !row.back().empty(); });
  if (suspect > 0) {
    result.notes.push_back(
        fmt::format("{} of {} clouds are suspect: see the table of clouds", suspect, clouds.rows.size()));
  }
  if (!clouds.rows.empty()) result.tables.push_back(std::move(clouds));
  result.limitations =
      "The check is independent of the thermometer only to the extent that the fit of delta-p is: the fit "
      "used the thermometer, so an error common to the whole fit is hidden, and with delta-p from LAMS "
      "sample by sample the laser temperature equals the thermometer temperature exactly. An offset of the "
      "thermometer, a wrong recovery factor, the scale of the laser and the elevation of its beam are "
      "indistinguishable.";
  const auto add_column = [&](const char* name, const char* title, const char* unit, const auto& series) {
    result.columns.push_back(column_of(flights, name, title, unit,
                                       [&](const CheckedFlight& flight) { return series(flight.air); }));
  };
  add_column("lams-temperature difference", "ATLAMS - thermometer", "K", difference_of);
  add_column("lams-temperature altitude", "pressure altitude", "m",
             [](const FlightAir& air) { return air.pressure_altitude; });
  add_column("lams-temperature laser", "ATLAMS", "degC", [](const FlightAir& air) {
    return air.laser ? celsius(air.laser->temperature, air) : std::vector<double>{};
  });
  add_column("lams-temperature thermometer", "thermometer", "degC",
             [](const FlightAir& air) { return celsius(air.temperature, air); });
  return result;
}

}  // namespace pcor::internal

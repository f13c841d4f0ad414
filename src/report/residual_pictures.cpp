#include "report/residual_pictures.hpp"

#include <cstddef>
#include <utility>

#include <pcor/numerics/noise.hpp>

#include "numerics/median.hpp"
#include "numerics/spectrum.hpp"
#include "report/columns.hpp"

namespace pcor::internal {
namespace {

// Median sampling interval, s.
double step_of(const Report& report) {
  std::vector<double> steps;
  for (std::size_t i = 1; i < report.time.size(); ++i) {
    if (report.time[i] > report.time[i - 1]) steps.push_back(report.time[i] - report.time[i - 1]);
  }
  return steps.empty() ? 0.0 : median(std::move(steps));
}

}  // namespace

void add_regimes(Report& report, const std::vector<std::string>& residuals) {
  const std::vector<std::string> shown = present(report, residuals);
  if (shown.empty() || report.intervals.empty()) return;
  report.items.emplace_back(RegimePanel{
      "Residual by regime",
      "Dots: mean in each regime (number of samples) and its rms; bars: scatter about the mean; arrows: "
      "means "
      "beyond the axis. A mean different from zero in one regime indicates a missing effect that depends on "
      "the manoeuvre.",
      shown, "residual"});
}

double noise_autocorrelation(const Report& report, const std::string& residual) {
  const ReportColumn* const column = column_named(report.columns, residual);
  const double step = step_of(report);
  if (column == nullptr || !(step > 0.0)) return 1.0;
  return noise_floor(column->values, report.time, step).autocorrelation_time;
}

void add_distributions(Report& report, const std::vector<std::string>& residuals) {
  const std::vector<std::string> shown = present(report, residuals);
  if (shown.empty()) return;
  CurvePanel spectrum{
      "Residual by period",
      "Rms of the residual within an octave about each period, with standard errors: missing effects of "
      "manoeuvres appear at the periods of the manoeuvres, white noise rises towards short periods.",
      {},
      "period",
      "rms per octave",
      "s",
      "hPa"};
  const double step = step_of(report);
  for (const std::string& name : shown) {
    const ReportColumn& column = *column_named(report.columns, name);
    OctaveSpectrum found = octave_spectrum(column.values, report.time, step);
    if (!found.period.empty())
      spectrum.curves.push_back(
          {column.title, std::move(found.period), std::move(found.rms), std::move(found.error)});
  }
  if (!spectrum.curves.empty()) report.items.emplace_back(std::move(spectrum));
  report.items.emplace_back(
      QuantilePanel{"Quantiles of the residual",
                    "Normal noise lies on the line, whose slope is its standard deviation. Ends that deviate "
                    "indicate outliers or an intermittent effect.",
                    shown, "residual"});
}

void add_strip(Report& report) {
  std::vector<std::string> shown = present(report, {"altitude", "true_airspeed"});
  if (shown.empty()) return;
  report.items.emplace_back(StripPanel{
      "Height, speed and regimes", "Altitude, speed and regimes of the flight, with a lane for each regime.",
      std::move(shown)});
}

void add_track(Report& report, const std::string& title, const std::string& caption,
               const std::string& colour, bool diverging) {
  if (meet(report.columns, {"latitude", "longitude", colour}))
    report.items.emplace_back(TrackPanel{title, caption, "latitude", "longitude", colour, diverging});
}

}  // namespace pcor::internal

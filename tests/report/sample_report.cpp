// Writes a report with every kind of item on a flight that never was, for report_browser_test.py.
//
//   sample_report FILE [SAMPLES [FLIGHTS]]

#include <pcor/report/report.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdio>
#include <exception>
#include <iostream>
#include <limits>
#include <random>
#include <string>
#include <vector>

namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr double pi = 3.14159265358979;

// A leg of the flight, `minutes` long, which ends at `altitude` (m) and at an indicated airspeed of `speed`
// (m/s).
struct Leg {
  const char* regime;
  double minutes, altitude, speed;
};

const std::vector<Leg> legs{{"climb", 17, 4200, 118},   {"level", 14, 4200, 118}, {"manoeuvre", 9, 4200, 118},
                            {"climb", 10, 6600, 112},   {"level", 20, 6600, 112}, {"manoeuvre", 8, 6600, 112},
                            {"descent", 11, 2100, 125}, {"level", 15, 2100, 125}, {"descent", 14, 300, 95}};

constexpr double start = 1054468800 + 600;  // start of the first flight, s since 1970

constexpr std::size_t old_model = 8, refit = 9;  // indices of columns of the report

// One sample, `part` of the way through a leg that began at `from`.
void add_sample(std::vector<pcor::ReportColumn>& columns, const Leg& from, const Leg& leg, double part,
                double seconds, std::mt19937& random) {
  std::normal_distribution<double> normal;
  const bool turns = leg.regime == std::string("manoeuvre");
  const double smooth = part * part * (3 - 2 * part);
  const double wave = turns ? std::sin(2 * pi * seconds / 45) : 0;
  const double altitude = from.altitude + (leg.altitude - from.altitude) * smooth + 6 * normal(random) * 0.2;
  const double speed = from.speed + (leg.speed - from.speed) * smooth +
                       (turns ? 14 * std::sin(2 * pi * part) : 1.2 * std::sin(seconds / 70));
  const double pressure = 1013.25 * std::pow(1 - 2.25577e-5 * altitude, 5.2559);
  const double dynamic = 0.5 * 1.225 * speed * speed / 100 * 1.01;
  const double mach = std::sqrt(5 * (std::pow(dynamic / pressure + 1, 1 / 3.5) - 1));
  const double attack = 2.2 + 9500 / (speed * speed) * 1.4 - 2 +
                        1.7 * wave * (seconds - std::floor(seconds / 90) * 90 < 45) + 0.12 * normal(random);
  const double sideslip = 2.4 * wave * (seconds - std::floor(seconds / 90) * 90 >= 45) + 0.2 * normal(random);
  static double red = 0;
  red = 0.93 * red + 0.3 * std::sqrt(1 - 0.93 * 0.93) * normal(random);
  const double structure = 4.2 * (mach - 0.42) + 0.22 * (attack - 3) + 0.035 * sideslip * sideslip;
  // Around in an ellipse across the date line, once in three quarters of an hour.
  const double around = 2 * pi * seconds / 2700;
  const double sample[] = {52.0 + 0.9 * std::sin(around) + seconds / 9000,
                           std::remainder(179.6 + 1.6 * std::cos(around), 360.0),
                           altitude,
                           pressure,
                           mach,
                           attack,
                           sideslip,
                           dynamic,
                           red + structure + 0.35,
                           red + 0.06 * structure,
                           pressure + dynamic,
                           0.31 + 0.99946 * (pressure + dynamic) + 0.12 * normal(random)};
  for (std::size_t i = 0; i < columns.size(); ++i) columns[i].values.push_back(sample[i]);
}

std::vector<pcor::ReportColumn> empty_columns() {
  return {{"latitude", "Latitude", "deg", {}},
          {"longitude", "Longitude", "deg", {}},
          {"altitude", "Altitude", "m", {}},
          {"pressure", "Static pressure", "hPa", {}},
          {"mach", "Mach number", "", {}},
          {"attack", "Angle of attack", "°", {}},
          {"sideslip", "Sideslip", "°", {}},
          {"dynamic", "Dynamic pressure", "hPa", {}},
          {"old", "Published model", "hPa", {}},
          {"new", "Refit of <this> \"flight\"", "hPa", {}},
          {"total-lams", "Total pressure, LAMS", "hPa", {}},
          {"total-pitot", "Total pressure, pitot", "hPa", {}}};
}

std::vector<pcor::ReportItem> items() {
  using namespace pcor;
  return {
      TimePanel{"Residual over the flight",
                "Residual of the static defect measured by LAMS after subtracting a model.",
                {"old", "new"},
                "Residual"},
      TimePanel{"The flight", "Altitude from the uncorrected pressure.", {"altitude"}},
      RegimeTable{"Residuals by regime", "Selected samples.", {"old", "new"}},
      BinnedPanel{"Residual against the state of flight",
                  "Mean of each bin.",
                  {"old", "new"},
                  {"mach", "attack", "sideslip", "dynamic", "pressure"},
                  25.0,
                  "Residual"},
      PlanePanel{"Published model in the plane of Mach number and pressure",
                 "Orange where the model corrects too little, blue where it corrects too much.", "mach",
                 "pressure", "old"},
      PairPanel{"Total pressure by two systems",
                "A slope other than 1 indicates a wrong gain; an offset, a leak or a tilted transducer.",
                "total-lams",
                "total-pitot",
                {{0.99946, 0.31, "0.31 hPa + 0.99946 x"}, {1, 0, "y = x"}}},
      BarPanel{
          "Rms with one effect left out",
          "The longer the bar, the more the effect is needed; with its 68 % interval from the bootstrap.",
          {{"nothing left out", 0.298, 0.006},
           {"constant", 0.412, 0.011},
           {"Mach number", 0.377, 0.010},
           {"angle of attack", 0.345, 0.008},
           {"sideslip squared", 0.306, 0.007},
           {"dynamic pressure", 0.301, 0.006}},
          "Rms of the residual",
          "hPa"},
      CurvePanel{
          "Delay of the model behind the reference",
          "A delay that is the same at all periods is a clock; one that falls off at short periods is a "
          "lag.",
          {{"before",
            {2, 4, 8, 16, 32, 64},
            {0.31, 0.42, 0.48, 0.49, 0.50, 0.52},
            {0.02, 0.02, 0.03, 0.05, 0.09, 0.2}},
           {"after",
            {2, 4, 8, 16, 32, 64},
            {0.01, 0.00, 0.01, -0.02, 0.03, 0.1},
            {0.02, 0.02, 0.03, 0.05, 0.09, 0.2}}},
          "Period",
          "Delay",
          "s",
          "s"},
      StripPanel{"Height, pressure and regimes", "Regimes flown.", {"altitude", "dynamic"}},
      RegimePanel{"Residual by regime", "Mean, and scatter about it.", {"old", "new"}, "Residual"},
      QuantilePanel{"Quantiles", "Noise lies on the line.", {"old", "new"}, "Residual"},
      TrackPanel{"Residual on the map", "The track over the ground.", "latitude", "longitude", "old"},
      DotPanel{"Checks",
               "A square in the band is consistent, a cross inconsistent, an open square inconclusive.",
               {""},
               {{"total pressure", {{0.3, 0.1}}, "+0.030 ± 0.010 hPa", ReportTone::good},
                {"layers", {{-2.4, 0.4}}, "-0.72 ± 0.12 K", ReportTone::bad},
                {"circles", {{0.9, 1.1}}, "+0.9 ± 1.1 m/s", ReportTone::open}},
               "number / tolerance",
               "",
               {},
               "negligible"},
      DotPanel{"Rms of each step",
               "With the noise as a line.",
               {"fitted", "held out: rf03"},
               {{"input model", {{0.91, 0.02}, {0.94, 0.03}}, "0.910 and 0.940"},
                {"refitted", {{0.52, 0.01}, {0.55, 0.02}}, "0.520 and 0.550"},
                {"+ static-lag", {{0.27, 0.01}, {nan, 0.0}}, "0.270 and –"}},
               "rms residual",
               "hPa",
               {{"noise, 0.25 hPa", 0.25}}},
      ReportTable{"Coefficients",
                  "With the standard errors of the fit; the change is in units of the error.",
                  {"Effect", "Coefficient", "Published", "Refit", "Standard error", "Change"},
                  {{"constant", "a0", "0.004128", "0.003911", "0.000062", "-3.5"},
                   {"angle of attack", "a1", "0.021280", "0.020873", "0.000215", "-1.9"},
                   {"dynamic pressure", "a2", "0.030850", "0.031442", "0.000530", "1.1"}}},
      ReportText{
          "How this was made",
          {"The models were run over the flight by the real-time loop; the reference is the dynamic pressure "
           "from the laser air-motion sensor. Samples in turns of more than 30° of bank are left out.",
           "Standard errors take into account that neighbours in time err alike."}}};
}

std::string rms(const std::vector<double>& values) {
  double sum = 0, count = 0;
  for (const double value : values)
    if (std::isfinite(value)) sum += value * value, count += 1;
  char text[32];
  std::snprintf(text, sizeof text, "%.2f", std::sqrt(sum / count));
  return text;
}

pcor::Report sample_report(std::size_t samples, std::size_t flights) {
  std::mt19937 random(2003);
  pcor::Report report;
  report.columns = empty_columns();
  double minutes = 0;
  for (const Leg& leg : legs) minutes += leg.minutes;
  const std::size_t each = samples / flights;
  const double step = std::max(1.0, std::floor(minutes * 60 / static_cast<double>(each)));
  for (std::size_t flight = 0; flight < flights; ++flight) {
    const double begins = start + 86400 * 3 * static_cast<double>(flight);
    report.flight_starts.push_back(report.time.size());
    report.flight_names.push_back("rf0" + std::to_string(flight + 1));
    Leg from{"ground", 0, 150, 70};
    double begin = begins;
    std::size_t made = 0;
    for (const Leg& leg : legs) {
      const double length = leg.minutes * static_cast<double>(each) / minutes * step;
      for (; made < each && static_cast<double>(made) * step < begin + length - begins; ++made) {
        const double seconds = static_cast<double>(made) * step;
        add_sample(report.columns, from, leg, (begins + seconds - begin) / length, seconds, random);
        report.time.push_back(begins + seconds);
      }
      report.intervals.push_back({leg.regime, begin, begin + length - step});
      begin += length;
      from = leg;
    }
    for (; made < each; ++made) {
      add_sample(report.columns, from, from, 1, static_cast<double>(made), random);
      report.time.push_back(begins + static_cast<double>(made) * step);
    }
  }
  for (std::size_t i = report.time.size() / 3; i < report.time.size() / 3 + 90; ++i)
    report.columns[old_model].values[i] = report.columns[refit].values[i] = nan;
  report.title = "Comparison of two models of the static defect";
  report.subtitle = "C-130, flight rf01 of 1 June 2003 <script>alert('not run')</script>";
  report.summary = {
      "The refit leaves an rms of " + rms(report.columns[refit].values) + " hPa; the published model, " +
          rms(report.columns[old_model].values) + " hPa.",
      "The published model errs with the Mach number and the angle of attack; the refit has no "
      "such structure.",
      "The two systems of total pressure differ by a gain of 0.99946 and an offset of 0.31 hPa."};
  report.info = {{"Flight", "rf01, 2003-06-01, 12:10–14:08 UTC"},
                 {"Samples", std::to_string(report.time.size())},
                 {"Rate", "1 Hz"},
                 {"Models", "c130-psfd-qcr-2003, refit"},
                 {"Reference", "LAMS"}};
  report.items = items();
  return report;
}

}  // namespace

int main(int count, char** words) {
  if (count < 2) {
    std::cerr << "usage: sample_report FILE [SAMPLES [FLIGHTS]]\n";
    return 2;
  }
  try {
    pcor::write_report(
        sample_report(count > 2 ? std::stoul(words[2]) : 7080, count > 3 ? std::stoul(words[3]) : 1),
        words[1]);
  } catch (const std::exception& error) {
    std::cerr << "sample_report: " << error.what() << '\n';
    return 1;
  }
}

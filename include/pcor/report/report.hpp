#pragma once

#include <cstddef>
#include <filesystem>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

namespace pcor {

/// Quantity shown in the figures of a report, one value per sample, NaN if missing. A report stores 16 bits
/// per value: the rounding error is at most half of (max - min) / 65534; for a quantity used only on axes 12
/// bits, half of (max - min) / 4094.
struct ReportColumn {
  std::string name;   ///< key used by panels; unique in a report
  std::string title;  ///< label of axes and legends, e.g. "Mach number"; the name if empty
  std::string unit;   ///< e.g. "hPa"; empty for a pure number
  std::vector<double> values;
};

/// Time range of a flight, shaded in the time panels. All intervals with the same name can be selected
/// together.
struct ReportInterval {
  std::string name;  ///< e.g. "climb"
  double begin = 0.0;
  double end = 0.0;  ///< both in seconds since 1970 UTC
};

/// Lines over time. Dragging over one selects a time range for the whole report.
struct TimePanel {
  std::string title;
  std::string caption;
  std::vector<std::string> columns;
  std::string axis{};  ///< label of the vertical axis without unit; composed from the columns if empty
  /// Column with the standard uncertainty of the first column, drawn as a band; no band if empty.
  std::string uncertainty{};
  double averaging_time = 0.0;  ///< s; lines show means over periods of this length; 0: every sample
};

/// Columns against a column chosen by the reader: samples in the background, and the mean of each bin with
/// its standard error.
struct BinnedPanel {
  std::string title;
  std::string caption;
  std::vector<std::string> columns;
  std::vector<std::string> x_choices;
  /// Integrated autocorrelation time in samples, at least 1; effective sample size = samples / this.
  double autocorrelation_time = 1.0;
  std::string axis{};  ///< see TimePanel
};

/// One column in the plane of two others, by colours centred on zero; y increases downwards, as for pressure.
struct PlanePanel {
  std::string title;
  std::string caption;
  std::string x;
  std::string y;
  std::string colour;
};

/// A line y = offset + slope * x.
struct ReportLine {
  double slope = 1.0;
  double offset = 0.0;
  std::string label;
};

/// Ground track, in distances from its centre, with one column as colour.
struct TrackPanel {
  std::string title;
  std::string caption;
  std::string latitude;   ///< column, deg
  std::string longitude;  ///< column, deg
  std::string colour;
  /// True: colour scale centred on zero, as for a residual; false: from minimum to maximum.
  bool diverging = true;
};

/// Columns over time, each on a separate axis, with a lane below for the intervals of each name.
struct StripPanel {
  std::string title;
  std::string caption;
  std::vector<std::string> columns;
};

/// Mean and scatter of columns for each interval name and for all samples.
struct RegimePanel {
  std::string title;
  std::string caption;
  std::vector<std::string> columns;
  std::string axis{};  ///< see TimePanel
};

/// Quantiles of columns against those of a normal distribution.
struct QuantilePanel {
  std::string title;
  std::string caption;
  std::vector<std::string> columns;
  std::string axis{};  ///< see TimePanel
};

/// Two columns against each other, with lines; below, the difference of each sample from the first line.
struct PairPanel {
  std::string title;
  std::string caption;
  std::string x;
  std::string y;
  std::vector<ReportLine> lines;  ///< one or more
};

/// Samples, bias and rms of columns for each name of the intervals, and for all.
struct RegimeTable {
  std::string title;
  std::string caption;
  std::vector<std::string> columns;
};

struct ReportBar {
  std::string label;
  double value = 0.0;
  double error = 0.0;  ///< half the length of the error bar; 0: no bar
};

/// Bars for numbers that do not belong to samples, in the order given.
struct BarPanel {
  std::string title;
  std::string caption;
  std::vector<ReportBar> bars;
  std::string axis{};  ///< label of the axis, e.g. "rms"
  std::string unit{};
};

/// Assessment of a row of dots, shown by colour and mark.
enum class ReportTone { none, good, bad, open };

/// Number with its standard error.
struct ReportDot {
  double value = 0.0;  ///< NaN: not drawn
  double error = 0.0;  ///< half the length of the error bar; 0: no bar
};

struct ReportDotRow {
  std::string label;
  std::vector<ReportDot> dots;  ///< one dot for each series
  std::string text{};           ///< numbers as text at the right
  ReportTone tone = ReportTone::none;
};

/// Rows of dots with error bars for numbers that do not belong to samples, for one or several series.
struct DotPanel {
  std::string title;
  std::string caption;
  std::vector<std::string> series;  ///< names of the series; not shown for a single series
  std::vector<ReportDotRow> rows;
  std::string axis;
  std::string unit{};
  std::vector<std::pair<std::string, double>> lines{};  ///< lines across all rows, with labels
  /// Label of the band between -1 and 1; no band if empty.
  std::string band{};
};

/// Curve of numbers that do not belong to samples, with their standard errors.
struct ReportCurve {
  std::string label;
  std::vector<double> x;
  std::vector<double> y;        ///< same size as x; NaN: not drawn
  std::vector<double> error{};  ///< standard errors of y; same size, or empty
};

/// Curves, e.g. spectra, on a logarithmic axis of x, which must be positive.
struct CurvePanel {
  std::string title;
  std::string caption;
  std::vector<ReportCurve> curves;
  std::string x_axis;
  std::string axis;
  std::string x_unit{};
  std::string unit{};
};

/// Coefficient that the reader of a what-if changes or that is refitted there.
struct WhatIfCoefficient {
  std::string name;  ///< parameter, e.g. "tau"; for a coefficient of the model "static-qp.a2"
  std::string unit{};
  double given = 0.0;  ///< value in the model; for a missing effect, its neutral value
  double start = 0.0;  ///< value at which the residual equals its column
  double minimum = -std::numeric_limits<double>::infinity();  ///< physical bounds
  double maximum = std::numeric_limits<double>::infinity();
  bool fixed = false;      ///< true: keeps its given value
  std::string argument{};  ///< command-line argument that names it, shell-quoted
  /// Decrease of the residual per unit of the coefficient, one value per sample; NaN if unknown. A page
  /// of more than 64,000 samples has regular ones, between which it interpolates linearly.
  std::vector<double> column{};
};

/// Effect that the reader of a what-if switches on.
struct WhatIfEffect {
  std::string id;
  std::string title;
  /// Reason for its inclusion, e.g. "found", "instead of static-lag"; "not found" effects are listed apart.
  std::string why{};
  /// Index of the effect of `WhatIfWeights` that it represents, itself or another; nullopt if there is no
  /// such effect.
  std::optional<std::size_t> stands_for{};
  std::size_t first = 0;  ///< index of its first coefficient
  std::size_t count = 0;
  std::string argument{};   ///< command-line argument that adds it, shell-quoted; empty if no command can
  bool is_formula = false;  ///< true: added by a separate command
  std::string note{};       ///< note for the reader, one sentence
};

/// Normal equations summed over samples: the lower triangle, row by row, of the products of (columns,
/// residual at the start).
struct WhatIfSums {
  std::vector<double> products;
  double samples = 0.0;
};

/// Normal equations whitened with the noise after some effects are removed.
struct WhatIfWeights {
  std::vector<std::size_t> effects;
  std::vector<WhatIfSums> parts;  ///< parts of the flights, each left out once
  /// Covariance of the products of columns and residual due to noise, the lower triangle by rows.
  std::vector<double> score_covariance;
};

/// Commands to copy, ready for a shell.
struct WhatIfCommands {
  std::string add;    ///< command up to the effects, e.g. "pcor add"
  std::string model;  ///< input model file
  std::string with;   ///< arguments after the model, e.g. "--flight rf01.nc"
  std::string refit;  ///< command up to the model, e.g. "pcor refit rf01.nc rf02.nc"
  std::string stem;   ///< prefix of the names of new models; only ASCII alphanumerics, ".", "_" and "-"
};

/// Panel in which the reader adds effects by switches and moves their coefficients by sliders; shows the
/// residual with the coefficients of the model refitted.
struct WhatIfPanel {
  std::string title;
  std::string caption;
  std::string details{};              ///< folded below the panel
  std::string residual;               ///< column of the initial residual
  std::string start = "input model";  ///< label of the initial model
  /// True: the initial coefficients were fitted to the same samples, so they have no rms on unused samples.
  bool is_start_fitted = false;
  /// Coefficients of the model, followed by those of the effects.
  std::vector<WhatIfCoefficient> coefficients;
  std::size_t model_coefficient_count = 0;  ///< number of coefficients of the model
  std::vector<WhatIfEffect> effects;
  std::vector<std::string> x_choices{};  ///< columns available as x axis of the residual
  double autocorrelation_time = 1.0;     ///< see `BinnedPanel`
  /// Fit weights; first entry: no effect removed, last entry: all findings removed.
  std::vector<WhatIfWeights> weights;
  std::vector<WhatIfSums> unweighted;  ///< sums of the same parts, without outliers, hPa
  WhatIfSums outliers{};               ///< unweighted sums of the outliers
  WhatIfSums held_out{};  ///< unweighted sums of held-out data; empty if there are no held-out data
  double noise = 0.0;     ///< rms, hPa
  std::string noise_label = "noise";
  WhatIfCommands commands{};
};

/// Table of text and numbers; cells that are numbers are aligned. Each row has a cell for each header. The
/// page folds a table of more than 30 rows, and omits a table without rows.
struct ReportTable {
  std::string title;
  std::string caption;
  std::vector<std::string> headers;
  std::vector<std::vector<std::string>> rows{};
  bool is_folded = false;  ///< true: folded with any number of rows
};

struct ReportText {
  std::string title;
  std::vector<std::string> paragraphs;
  std::string details{};  ///< folded below the paragraphs
};

using ReportItem =
    std::variant<TimePanel, BinnedPanel, PlanePanel, PairPanel, RegimeTable, BarPanel, CurvePanel, TrackPanel,
                 StripPanel, RegimePanel, QuantilePanel, DotPanel, WhatIfPanel, ReportTable, ReportText>;

/// A step that a report advises: the page shows "text: command", or the text as a sentence.
struct NextStep {
  std::string text{};     ///< "To apply it", or a sentence if there is no command
  std::string command{};  ///< command line of a shell, or empty
};

/// Content of a report in reading order: title, summary, next step, facts, items, origin. All strings are
/// plain UTF-8.
struct Report {
  std::string title;  ///< the result in one sentence
  std::string subtitle;
  /// Sentences; the page folds those after the first, or after the second if both are short.
  std::vector<std::string> summary;
  std::vector<NextStep> next;  ///< advised steps, if any
  std::vector<std::pair<std::string, std::string>>
      info;                                ///< name and value, e.g. "Model"; folded on the page
  std::vector<double> time;                ///< sample times, s since 1970 UTC
  std::vector<std::size_t> flight_starts;  ///< first sample of each flight; {0} if empty
  std::vector<std::string> flight_names;   ///< one per flight, or empty
  std::vector<ReportColumn> columns;
  std::vector<ReportInterval> intervals;
  std::vector<ReportItem> items;
  std::vector<std::pair<std::string, std::string>> origin;  ///< provenance as names and values, in the footer
};

/// Self-contained HTML page, without network access or other files. The browser draws the panels from the
/// columns; the reader selects samples by time or interval, and saves panels as SVG or PNG.
///
/// A panel without values states so in its place.
///
/// @throws Error if the time of a flight does not increase, a column has the wrong length, two columns have
/// the same name, or a panel names an absent column.
std::string report_html(const Report& report);

/// Writes `report_html` to the file `path` atomically.
/// @throws Error as `report_html`, or if the file cannot be written.
void write_report(const Report& report, const std::filesystem::path& path);

}  // namespace pcor

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

/// A quantity that the pictures of a report show, one value per sample, NaN where missing. A report keeps
/// 16 bits of a value: it is off by at most half of (greatest - least) / 65534; of a quantity that pictures
/// have along their axes alone 12 bits, half of (greatest - least) / 4094.
struct ReportColumn {
  std::string name;   ///< by which panels name it; unique in a report
  std::string title;  ///< on axes and in legends, e.g. "Mach number"; the name if empty
  std::string unit;   ///< e.g. "hPa"; empty for a pure number
  std::vector<double> values;
};

/// A stretch of a flight, shaded in the time panels. All intervals of one name can be selected together.
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
  std::string axis{};  ///< what the vertical axis says, without the unit; made from the columns if empty
};

/// Columns against one that the reader chooses: the samples faintly, and the mean of each bin with its
/// standard error.
struct BinnedPanel {
  std::string title;
  std::string caption;
  std::vector<std::string> y;
  std::vector<std::string> x_choices;
  std::size_t bins = 12;
  /// How many samples count as one independent sample, because neighbours in time err alike; at least 1.
  double autocorrelation_time = 1.0;
  std::string axis{};  ///< as for TimePanel
};

/// One column in the plane of two others, by colour.
struct PlanePanel {
  std::string title;
  std::string caption;
  std::string x;
  std::string y;
  std::string colour;
  bool reverse_y = false;  ///< the least at the top, as for pressure
  bool diverging = true;   ///< colours meet at zero, as for a residual; else from the least to the greatest
};

/// A line y = offset + slope * x.
struct ReportLine {
  double slope = 1.0;
  double offset = 0.0;
  std::string label;
};

/// Where the air goes at a time.
struct ReportBarb {
  double time = 0.0;  ///< s since 1970 UTC
  double east = 0.0;  ///< m/s
  double north = 0.0;
};

/// The track over the ground, in distances from its middle, with one column by colour.
struct TrackPanel {
  std::string title;
  std::string caption;
  std::string latitude;   ///< a column, deg
  std::string longitude;  ///< a column, deg
  std::string colour;
  bool diverging = true;           ///< as for PlanePanel
  std::vector<ReportBarb> wind{};  ///< shown as barbs where the reader asks
};

/// Columns over time, each on an axis of its own, and below them a lane for the intervals of each name.
struct StripPanel {
  std::string title;
  std::string caption;
  std::vector<std::string> columns;
};

/// Of each name of the intervals, and of all: the mean of columns, and the scatter about it.
struct RegimePanel {
  std::string title;
  std::string caption;
  std::vector<std::string> columns;
  std::string axis{};  ///< as for TimePanel
};

/// Quantiles of columns against those of a normal distribution.
struct QuantilePanel {
  std::string title;
  std::string caption;
  std::vector<std::string> columns;
  std::string axis{};  ///< as for TimePanel
};

/// Two columns against each other, with lines; below it, what each sample differs from the first line (from
/// y = x if there is none).
struct PairPanel {
  std::string title;
  std::string caption;
  std::string x;
  std::string y;
  std::vector<ReportLine> lines{};
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
  double error = 0.0;  ///< half the length of the error bar; 0 for none
};

/// Numbers that do not belong to samples, as bars, in the order given.
struct BarPanel {
  std::string title;
  std::string caption;
  std::vector<ReportBar> bars;
  std::string axis{};  ///< what the axis says, e.g. "rms"
  std::string unit{};
};

/// What a row of dots says of itself by its colour and its mark.
enum class ReportTone { none, good, bad, open };

/// A number with its standard error.
struct ReportDot {
  double value = 0.0;  ///< NaN for none
  double error = 0.0;  ///< half the length of the error bar; 0 for none
};

struct ReportDotRow {
  std::string label;
  std::vector<ReportDot> dots;  ///< one of each series
  std::string text{};           ///< at the right, the numbers in words
  ReportTone tone = ReportTone::none;
};

/// Numbers that do not belong to samples, as rows of dots with error bars: of one series or of several.
struct DotPanel {
  std::string title;
  std::string caption;
  std::vector<std::string> series;  ///< what they are called; the name of one alone is not shown
  std::vector<ReportDotRow> rows;
  std::string axis;
  std::string unit{};
  std::vector<std::pair<std::string, double>> lines{};  ///< across all rows, with what they are
  std::string band{};                                   ///< what lies between -1 and 1; none if empty
};

/// A curve of numbers that do not belong to samples, with their standard errors.
struct ReportCurve {
  std::string label;
  std::vector<double> x;
  std::vector<double> y;        ///< as many as of x; NaN for none
  std::vector<double> error{};  ///< of y; as many, or none
};

/// Curves, as spectra are; x above zero where its axis is logarithmic.
struct CurvePanel {
  std::string title;
  std::string caption;
  std::vector<ReportCurve> curves;
  std::string x_axis;
  std::string axis;
  std::string x_unit{};
  std::string unit{};
  bool log_x = false;
};

/// A coefficient that the reader of a what-if moves, or that is fitted again there.
struct WhatIfCoefficient {
  std::string name;  ///< of the parameter, e.g. "tau"; of the model's own "static-qp.a2"
  std::string unit{};
  double given = 0.0;  ///< in the model; of an effect that it lacks, that with which the effect does nothing
  double start = 0.0;  ///< at which the residual is as its column has it
  double least = -std::numeric_limits<double>::infinity();  ///< that physics allows
  double greatest = std::numeric_limits<double>::infinity();
  bool fixed = false;      ///< keeps the value that is given
  std::string argument{};  ///< that names it in a command, as a shell reads it
  double size = 0.0;       ///< of its changes: pictures are right where it moves by so much
  /// What a unit of it takes off the residual, one value per sample; NaN where not known. Reports keep the
  /// samples between which a straight line will not do, a few thousand at most.
  std::vector<double> column{};
};

/// An effect that the reader of a what-if switches on.
struct WhatIfEffect {
  std::string id;
  std::string title;
  std::string why{};  ///< it is in the list, e.g. "found", "instead of static-lag"
  /// The number of the effect of `WhatIfWeights` that it stands for, itself or another; nothing for none.
  std::optional<std::size_t> stands_for{};
  std::size_t first = 0;  ///< of its coefficients
  std::size_t count = 0;
  std::string argument{};   ///< by which a command adds it, ready for a shell; empty where none can
  bool is_formula = false;  ///< a command of its own adds it
  std::string note{};       ///< what the reader should know of it; a sentence
};

/// Sums over samples of what coefficients and residual have in common: the lower triangle, row by row, of the
/// products of (columns, residual at the start).
struct WhatIfSums {
  std::vector<double> products;
  double samples = 0.0;
};

/// Sums in units of the noise that is left when some effects are taken off.
struct WhatIfWeights {
  std::vector<std::size_t> effects;
  std::vector<WhatIfSums> parts;  ///< of the flights, each of which is left out in turn
  /// The covariance by the noise of the columns' products with the residual, the lower triangle by rows.
  std::vector<double> score_covariance;
};

/// What two effects are told apart by, as a sentence.
struct WhatIfSeparation {
  std::size_t effect = 0;
  std::size_t rival = 0;
  std::string text;
};

/// Commands to copy, ready for a shell.
struct WhatIfCommands {
  std::string add;    ///< up to the effects, e.g. "pcor add"
  std::string model;  ///< the file to begin with
  std::string with;   ///< behind the model, e.g. "--flight rf01.nc"
  std::string refit;  ///< up to the model, e.g. "pcor refit rf01.nc rf02.nc"
  std::string stem;  ///< with which the names of new models begin, of letters, digits, ".", "_" and "-" alone
};

/// Effects that the reader adds to the model by switches, with their coefficients on sliders: what the
/// residual would be, with the model's own coefficients fitted again.
struct WhatIfPanel {
  std::string title;
  std::string caption;
  std::string residual;                         ///< the column that it starts from
  std::string start = "as given";               ///< what the model is called with which it starts
  std::vector<WhatIfCoefficient> coefficients;  ///< the model's own, then those of the effects
  std::size_t own = 0;                          ///< how many are the model's own
  std::vector<WhatIfEffect> effects;
  std::vector<std::string> x_choices{};  ///< columns that the residual is shown against
  double autocorrelation_time = 1.0;     ///< as of `BinnedPanel`
  /// For fits: with no effect taken off first, with all that were found last.
  std::vector<WhatIfWeights> weights;
  std::vector<WhatIfSums> alike;  ///< of the same parts, of all samples alike but outliers, hPa
  WhatIfSums outliers{};          ///< as `alike`
  WhatIfSums held_out{};  ///< as `alike`, of what took no part in any fit; empty where there is nothing
  double noise = 0.0;     ///< rms, hPa
  std::vector<WhatIfSeparation> separations{};
  WhatIfCommands commands{};
};

/// A table of words and numbers; cells that are numbers are aligned.
struct ReportTable {
  std::string title;
  std::string caption;
  std::vector<std::string> headers;
  std::vector<std::vector<std::string>> rows;
};

struct ReportText {
  std::string title;
  std::vector<std::string> paragraphs;
};

using ReportItem =
    std::variant<TimePanel, BinnedPanel, PlanePanel, PairPanel, RegimeTable, BarPanel, CurvePanel, TrackPanel,
                 StripPanel, RegimePanel, QuantilePanel, DotPanel, WhatIfPanel, ReportTable, ReportText>;

/// What a report says, in the order in which the reader meets it: the title, the summary, the facts, the
/// items, its origin. All texts are plain text in UTF-8.
struct Report {
  std::string title;
  std::string subtitle;
  std::vector<std::string> summary;                       ///< sentences
  std::vector<std::pair<std::string, std::string>> info;  ///< a name and what it is, e.g. "Model"
  std::vector<double> time;                               ///< of the samples, s since 1970 UTC
  std::vector<std::size_t> flight_starts;                 ///< first sample of each flight; {0} if empty
  std::vector<std::string> flight_names;                  ///< as many as flights, or none
  std::vector<ReportColumn> columns;
  std::vector<ReportInterval> intervals;
  std::vector<ReportItem> items;
  std::vector<std::pair<std::string, std::string>> origin;  ///< how it came to be, like facts, at the foot
};

/// One HTML page that needs nothing else: no network, no other file. A browser draws its panels from the
/// columns; the reader selects samples by time or interval, and saves panels as SVG or PNG.
///
/// @throws Error if the time of a flight does not increase, a column is not of its length, two columns have
/// one name, a panel names a column that is not there, or a panel would be empty: no sample has a value in
/// all the columns of a picture.
std::string report_html(const Report& report);

/// Writes `report_html` to the file `path`, whole or not at all.
/// @throws Error as `report_html`, or if the file cannot be written.
void write_report(const Report& report, const std::filesystem::path& path);

}  // namespace pcor

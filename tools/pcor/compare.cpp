#include <pcor/compare/compare.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <optional>
#include <string>

#include <pcor/base/utc.hpp>
#include <pcor/compare/comparison_report.hpp>
#include "communicator.hpp"
#include "comparison.hpp"
#include "comparison_advice.hpp"
#include "flight_table.hpp"
#include "model_name.hpp"
#include "model_selector.hpp"
#include "progress.hpp"
#include "report_origin.hpp"

namespace pcor::tool {
namespace {

constexpr std::size_t name_width = 32;  // first column

void print_row(const std::string& name, const Statistics& s) {
  const auto known = [](double value, int digits) {
    return std::isnan(value) ? std::string("unknown") : fmt::format("{:.{}f}", value, digits);
  };
  print_formatted("{:<{}} {:>8} {:>9.3f} {:>9.3f} {:>9.3f} {:>9} {:>7}\n", name, name_width, s.samples,
                  s.bias, s.scatter(), s.rms, known(s.noise_rms, 3), known(s.rms_over_noise(), 1));
}

void print_header(const ModelComparison& model) {
  const bool by_gps = model.is_by_gps();
  print_formatted("{:<{}} {:>8} {:>9} {:>9} {:>9} {:>9} {:>7}\n",
                  by_gps ? fmt::format("residual by {}, hPa", model.reference) : "residual, hPa", name_width,
                  "samples", by_gps ? "GPS bias" : "bias", "scatter", "rms", by_gps ? "max noise" : "noise",
                  "ratio");
}

constexpr std::size_t listed_bands = 5;  // those with the largest errors, with --verbose

/// Parts that are printed, and the number of the others.
struct ShownParts {
  std::vector<PartStatistics> regimes{};
  std::vector<PartStatistics> bands{};
  std::size_t omitted = 0;
};

/// At most `max_regimes` regimes: of those with 1 % of the samples the ones with the largest ratio and bias,
/// then those with most samples; the `max_bands` worst bands; and the part with the largest ratio.
ShownParts shown_parts(const ModelComparison& model, std::size_t max_regimes, std::size_t max_bands) {
  std::vector<PartStatistics> bands = model.bands;
  std::stable_sort(bands.begin(), bands.end(), [](const PartStatistics& a, const PartStatistics& b) {
    return fails_more(a.statistics, b.statistics);
  });
  if (bands.size() > listed_bands) bands.resize(listed_bands);
  double largest = 0.0, largest_of_regimes = 0.0, largest_bias = 0.0;
  const auto is_long = [&](const Statistics& part) { return 100 * part.samples >= model.all.samples; };
  for (const auto* const parts : {&model.regimes, &std::as_const(bands)}) {
    for (const PartStatistics& part : *parts)
      largest = std::max(largest, part.statistics.rms_over_noise());  // NaN is not larger
  }
  for (const auto& [name, part] : model.regimes) {
    if (!is_long(part)) continue;
    largest_of_regimes = std::max(largest_of_regimes, part.rms_over_noise());
    largest_bias = std::max(largest_bias, std::abs(part.bias));
  }
  const auto rank = [&](const Statistics& part) {
    const bool is_worst = part.rms_over_noise() == largest_of_regimes || std::abs(part.bias) == largest_bias;
    return std::pair(is_long(part) && is_worst, part.samples);
  };
  std::vector<std::pair<bool, std::size_t>> ranks;
  for (const PartStatistics& part : model.regimes) ranks.push_back(rank(part.statistics));
  std::sort(ranks.rbegin(), ranks.rend());
  const auto least = ranks.size() <= max_regimes ? std::pair(false, std::size_t{0}) : ranks[max_regimes - 1];
  ShownParts shown;
  const auto add = [&](const PartStatistics& part, bool is_main, std::vector<PartStatistics>& to) {
    if (is_main || part.statistics.rms_over_noise() == largest)
      to.push_back(part);
    else
      ++shown.omitted;
  };
  for (const PartStatistics& part : model.regimes) {
    const auto part_rank = rank(part.statistics);
    add(part, part_rank.first || part_rank >= least, shown.regimes);
  }
  for (std::size_t i = 0; i < bands.size(); ++i) add(bands[i], i < max_bands, shown.bands);
  return shown;
}

/// @param more rows that are omitted elsewhere
void print_parts(const ShownParts& parts, std::size_t more) {
  for (const PartStatistics& part : parts.regimes) print_row("  " + part.name, part.statistics);
  const std::size_t omitted = parts.omitted + more;
  const std::string rest = omitted == 0 ? "" : fmt::format("{} rows omitted (--verbose)", omitted);
  if (!parts.bands.empty()) print_formatted("worst bands{}{}\n", rest.empty() ? "" : "; ", rest);
  for (const PartStatistics& part : parts.bands) print_row("  " + part.name, part.statistics);
  if (parts.bands.empty() && !rest.empty()) print_formatted("{}\n", rest);
}

/// First cells of the rows of the models: "all" for a single model; numbers if a name is too long.
class RowNames {
 public:
  explicit RowNames(const Comparison& comparison) {
    const std::vector<std::string> labels = model_labels(comparison);
    for (std::size_t m = 0; m < labels.size(); ++m)
      rows_.emplace_back(comparison.models[m].name, labels.size() == 1 ? "all" : labels[m]);
    are_long_ = labels.size() > 1 && labels.front() != comparison.models.front().name;
  }

  std::string of(const ModelComparison& model) const {
    const auto found = std::find_if(rows_.begin(), rows_.end(),
                                    [&model](const auto& row) { return row.first == model.name; });
    return found == rows_.end() ? model.name : found->second;
  }

  void print_numbers() const {
    for (const auto& [name, number] : rows_) {
      if (are_long_) print_formatted("{}: {}\n", number, name);
    }
  }

 private:
  std::vector<std::pair<std::string, std::string>> rows_{};  // name of the model, its cell
  bool are_long_ = false;
};

/// All samples of each model and reference; of a single model its main parts.
void print_short(const Comparison& comparison, const RowNames& rows) {
  rows.print_numbers();
  print_header(comparison.models.front());
  const bool is_single = comparison.models.size() == 1;
  for (const ModelComparison& model : comparison.models) {
    print_row(rows.of(model), model.all);
    if (!is_single) continue;
    std::size_t of_further = 0;
    for (const Comparison& further : comparison.further) of_further += further.models.front().regimes.size();
    const std::size_t others = std::min<std::size_t>(comparison.further.size(), 4);  // each prints one line
    print_parts(
        shown_parts(model, others == 0 ? 5 : std::min<std::size_t>(3, 5 - others), others == 0 ? 2 : 0),
        of_further);
  }
  for (const Comparison& further : comparison.further) {
    for (const ModelComparison& model : further.models) {
      const double ratio = model.noise_ratio();
      print_formatted("{}, {}: {}bias {:+.3f}, rms {:.3f} hPa{}\n", rows.of(model), further.reference,
                      model.is_by_gps() ? "GPS " : "", model.all.bias, model.all.rms,
                      std::isnan(ratio) ? "" : fmt::format(", ratio {:.1f}", ratio));
    }
  }
  print_formatted("used {} samples; not used: {}\n", comparison.masks[0], mask_text(comparison.masks));
}

void print_model(const ModelComparison& model, bool with_name) {
  if (with_name) print_formatted("\n{}\n", model.name);
  print_flaps_out(model.flaps_out, "the comparison");
  print_formatted("\n");
  print_header(model);
  print_row("all", model.all);
  print_parts(shown_parts(model, model.regimes.size(), listed_bands), 0);
  if (model.flights.size() > 1) {
    print_formatted("flights\n");
    for (const PartStatistics& part : model.flights) print_row("  " + part.name, part.statistics);
  }
  if (!model.worst.empty()) print_formatted("worst minutes\n");
  for (const WorstInterval& worst : model.worst) {
    print_formatted("  {} to {}  bias {:+.3f}, rms {:.3f} hPa  {}\n", utc_text(worst.begin),
                    utc_text(worst.end, "%H:%M:%S"), worst.statistics.bias, worst.statistics.rms,
                    worst.regimes);
  }
  // Differences over time have no R2.
  if (std::isfinite(model.r_squared))
    print_formatted("R2, 1 - (rms / standard deviation of the reference's delta-p)^2: {:.4f}\n",
                    model.r_squared);
  if (std::isfinite(model.autocorrelation_time))  // not of a residual without scatter
    print_formatted("the residuals are correlated in time: autocorrelation time {:.1f} samples\n",
                    model.autocorrelation_time);
  if (model.reference_error > 0.0)
    print_formatted(
        "The calibration of the reference may shift the bias by {:.2f} hPa (one standard uncertainty).\n",
        model.reference_error);
}

/// Statistics of a further reference: all samples and each regime.
void print_further(const Comparison& comparison, const RowNames& rows) {
  print_formatted("\nresidual = {}, reference minus model\n", comparison.reference);
  print_formatted("used {} samples; not used: {}\n", comparison.masks[0], mask_text(comparison.masks));
  print_header(comparison.models.front());
  for (const ModelComparison& model : comparison.models) {
    print_row(rows.of(model), model.all);
    for (const PartStatistics& part : model.regimes) print_row("  " + part.name, part.statistics);
  }
}

/// Output files for the residuals of the flights, if requested: the given file, or for several flights files
/// next to it with their names.
std::vector<std::filesystem::path> residual_files(const CompareArguments& options) {
  if (options.residuals.empty()) return {};
  const std::filesystem::path requested = options.residuals;
  if (options.comparison.flights.size() == 1) return {requested};
  std::vector<std::filesystem::path> files;
  for (const std::filesystem::path& flight : flight_paths(options.comparison)) {
    files.push_back(requested.parent_path() / (requested.stem().string() + "-" + flight.stem().string() +
                                               requested.extension().string()));
  }
  return files;
}

void print_in_full(const Comparison& comparison, const ChosenReferences& references, const RowNames& rows) {
  print_references(references);
  if (comparison.is_static_pressure) {
    print_formatted("residual = static pressure of the reference ({}) minus static pressure of the model\n",
                    comparison.reference);
  } else {
    print_formatted("residual = {}, reference minus model\n", comparison.reference);
  }
  print_formatted("used {} samples; not used: {}\n", comparison.masks[0], mask_text(comparison.masks));
  if (comparison.models.size() > 1)
    print_formatted("noise: common to all models, from the model with the smallest noise\n");
  for (const ModelComparison& model : comparison.models) print_model(model, comparison.models.size() > 1);
  if (comparison.total_pressure) {
    const LineFit& total = *comparison.total_pressure;
    print_formatted(
        "\ntotal pressure of the reference against total pressure of the model: slope {:.5f}, offset {:+.3f} "
        "hPa, rms {:.3f} hPa\n",
        total.slope, total.offset, total.rms);
  }
  if (!comparison.further.empty()) rows.print_numbers();
  for (const Comparison& further : comparison.further) print_further(further, rows);
}

void print(const ComparisonWithGps& result, const std::vector<ComparedModel>& models,
           const ChosenReferences& references, const CompareArguments& options) {
  const Comparison& comparison = result.comparison;
  const RowNames rows(comparison);
  if (is_verbose())
    print_in_full(comparison, references, rows);
  else
    print_short(comparison, rows);
  print_notes(comparison.notes);
  std::vector<std::string> written;
  for (const std::filesystem::path& file : residual_files(options)) written.push_back(file.string());
  written.insert(written.end(), {options.common.report, options.table, options.common.json});
  print_written_files(written);
  print_next_steps(next_steps(result, models, options));
}

/// Adds the references of a model to the references of earlier models, without repetition.
void add_references(ChosenReferences& all, const ChosenReferences& of_model) {
  for (const auto& reference : of_model.used) {
    const auto same = [&reference](const auto& other) { return other->name() == reference->name(); };
    if (std::none_of(all.used.begin(), all.used.end(), same)) all.used.push_back(reference);
  }
  for (const std::string& why_not : of_model.not_used) {
    if (std::find(all.not_used.begin(), all.not_used.end(), why_not) == all.not_used.end())
      all.not_used.push_back(why_not);
  }
}

/// Distinguishes models with the same name by their files.
void name_by_file(std::vector<ComparedModel>& models, const std::vector<std::string>& files) {
  std::map<std::string, std::size_t> count;
  for (const ComparedModel& compared : models) ++count[compared.name];
  for (std::size_t i = 0; i < models.size(); ++i) {
    if (count[models[i].name] > 1) models[i].name = files[i];
  }
}

/// Writes the residuals of each model on each flight.
void write_flight_table(const Comparison& comparison, const std::string& path) {
  FlightTable table({"flight", "model", "samples", "bias_hpa", "rms_hpa"});
  for (std::size_t f = 0; f < comparison.models.front().flights.size(); ++f) {
    for (const ModelComparison& model : comparison.models) {
      const auto& [flight, statistics] = model.flights[f];
      table.add({flight, model.name, std::to_string(statistics.samples), cell(statistics.bias),
                 cell(statistics.rms)});
    }
  }
  table.write(path);
}

/// Mean error of delta-p of each model by GPS, if requested.
void add_levels(const FlightSet& flights, const std::vector<ComparedModel>& models,
                const CompareArguments& options, ComparisonWithGps& result) {
  // Without the option all available references are used: GPS takes seconds.
  if (options.comparison.references.empty()) return;
  const MaskOptions mask = mask_options(options.comparison);
  for (const ComparedModel& each : models) {
    if (const auto level = level_by_gps(flights, each.model, each.references, mask))
      result.levels.emplace_back(each.name, *level);
  }
}

void add_notes_on_gps(const ChosenReferences& references, bool separates_atmosphere, Comparison& comparison) {
  const bool has_wind = std::any_of(references.used.begin(), references.used.end(),
                                    [](const auto& reference) { return reference->name() == "wind"; });
  if (has_wind) {
    comparison.notes.emplace_back(separates_atmosphere
                                      ? "rms and max noise by wind contain gusts and drift; the GPS bias "
                                        "does not if the level is determined, and may exceed the rms"
                                      : "residuals by wind contain gusts and the drift of the wind; "
                                        "--reference wind separates them from the bias");
  }
  double largest = 0.0;
  for (const ModelComparison& model : comparison.models) {
    // Heights alone hardly determine the level.
    if (model.reference == "height" && model.all.bias_error > model.all.rms)
      largest = std::max(largest, model.all.bias_error);
  }
  if (!LevelByGps{0.0, largest}.is_determined()) {
    comparison.notes.emplace_back(
        fmt::format("heights do not determine the level (standard error {:.2f} hPa): the bias by height is a "
                    "mean residual, not an error of delta-p",
                    largest));
  } else if (largest > 0.0) {
    comparison.notes.emplace_back(
        fmt::format("biases by height have a common standard error of {:.2f} hPa", largest));
  }
}

std::string level_text(const LevelByGps& level) {
  return level.is_determined() ? "delta-p by GPS needs a mean correction of " + correction_text(level)
                               : "GPS does not determine the mean delta-p error on these flights; it "
                                 "requires circles or reverse headings with --reference wind";
}

/// The mean correction of each model.
std::vector<std::string> level_texts(const Levels& levels) {
  std::vector<std::string> texts;
  for (const auto& [name, level] : levels) {
    texts.push_back(name + ": " + level_text(level));
  }
  return texts;
}

/// First lines: the mean corrections, and the sign of the following values.
void print_levels(const ComparisonWithGps& result) {
  for (const std::string& text : level_texts(result.levels)) print_formatted("{}\n", text);
  if (!result.levels.empty())
    print_formatted("A positive correction, or GPS bias by wind: delta-p of the model is too small.\n");
}

std::string history_of(const CompareArguments& options) {
  std::string line = "pcor " PCOR_VERSION " compare " + command_line(options.comparison);
  for (const std::string& model : options.models) line += " -m " + shell_path(model);
  return line + " --residuals " + shell_path(options.residuals);
}

void run(const CompareArguments& options) {
  const std::vector<std::filesystem::path> residuals = residual_files(options);
  std::vector<std::filesystem::path> outputs{options.table};
  outputs.insert(outputs.end(), residuals.begin(), residuals.end());
  prepare_outputs(options.common, std::move(outputs), input_files(options.comparison, options.models));
  JsonResult json(options.common);
  const FlightSet flights = CommandFlights(options.comparison).flights;
  std::vector<ComparedModel> models;
  ChosenReferences references;  // references of all models, for printing
  for (const std::string& path : options.models) {
    const ModelDefinition model = read_model_for(path, flights, options.common);
    const ChosenReferences of_model = read_references(options.comparison.references, model, flights);
    add_references(references, of_model);
    models.push_back({model.model.name, model, of_model.used});
  }
  name_by_file(models, options.models);
  CompareOptions compare_options;
  compare_options.mask = mask_options(options.comparison);
  compare_options.separates_atmosphere = !options.comparison.references.empty();
  if (!residuals.empty())
    compare_options.max_series = options.comparison.flights.size();
  else if (options.common.report.empty())
    compare_options.max_series = 0;  // other results are numbers
  ComparisonWithGps result;
  Comparison& comparison = result.comparison;
  {
    Progress bar("comparing", !options.common.quiet);
    compare_options.progress = [&bar](std::size_t done, std::size_t total) { bar.show(done, total); };
    comparison = compare(flights, models, compare_options);
  }
  add_levels(flights, models, options, result);
  add_notes_on_gps(references, compare_options.separates_atmosphere, comparison);
  if (!is_speaker()) return;
  OutputTransaction together;
  for (std::size_t i = 0; i < residuals.size(); ++i)
    write_residuals(comparison, i, flights[i], residuals[i], history_of(options));
  if (!options.common.report.empty()) {
    Report report = comparison_report(comparison);
    const std::vector<std::string> levels = level_texts(result.levels);
    report.summary.insert(report.summary.begin(), levels.begin(), levels.end());
    if (levels.size() == 1 && comparison.models.front().is_by_gps())
      report.title = "Mean error of the model: " + level_text(result.levels.front().second);
    write_report_of_run(std::move(report),
                        {options.models, options.comparison.flights, {}, next_steps(result, models, options)},
                        options.common);
  }
  if (!options.table.empty()) write_flight_table(comparison, options.table);
  json.write(result);
  together.appear();
  if (!wants_text(options.common)) return;
  print_levels(result);
  print(result, models, references, options);
}

}  // namespace

std::function<void()> add_compare(CLI::App& program) {
  auto options = std::make_shared<CompareArguments>();
  CLI::App* command =
      program.add_subcommand("compare", "Compare a model with a measurement of delta-p, by flight regime");
  add_comparison_options(*command, options->comparison);
  add_list_option(*command, "-m,--model", options->models,
                  "model of the pressure system; several models are shown side by side")
      ->required()
      ->type_name("MODEL.toml");
  add_table_option(*command, options->table,
                   "write samples, bias and rms of each flight and model to FILE.csv");
  command
      ->add_option("--residuals", options->residuals,
                   "write the residuals of every sample to a netCDF file; for several flights to one file "
                   "each, OUT-FLIGHT.nc")
      ->check(is_file_name())
      ->type_name("OUT.nc");
  add_common_options<ComparisonWithGps>(*command, options->common);
  add_examples(*command, {"compare first.nc second.nc -m model.toml --report compare.html",
                          "compare first.nc -m model.toml -m fitted.toml --reference lams",
                          "compare first.nc -m model.toml --exclude turn --residuals residuals.nc"});
  return [options] { run(*options); };
}

}  // namespace pcor::tool

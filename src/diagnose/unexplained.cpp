#include "diagnose/unexplained.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include <pcor/words/error.hpp>
#include "diagnose/rms.hpp"
#include "diagnose/structure.hpp"
#include "numerics/chi_squared.hpp"

namespace pcor::internal {
namespace {

constexpr double chance = 0.002;  // that any verdict comes of noise
constexpr std::size_t flips = 1000;
constexpr double least_gain = 1.1;  // of a line in a variable over effects with a name
constexpr double enough_blocks = 12.0;
constexpr double few_blocks_penalty = 6.0;
constexpr std::size_t most_variables = 10;
constexpr double least_drift_gain = 30.0;  // twice the gain in log-likelihood
constexpr double least_drift = 0.35;       // of the noise

/// A variable at every record of every flight.
struct Series {
  std::string name;
  std::string unit{};
  std::string description{};
  bool in_file = false;
  std::vector<std::vector<double>> values{};

  std::vector<const double*> pointers() const {
    std::vector<const double*> result;
    for (const std::vector<double>& each : values) result.push_back(each.data());
    return result;
  }
};

/// Flight-state series tested for structure, and their products.
std::vector<Series> flown(const Analysis& analysis) {
  std::vector<Series> result;
  const std::vector<FlightColumns>& flights = analysis.flights();
  for (const auto& [quantity, values] : flights.front().quantities) {
    Series& series = result.emplace_back();
    series.name = std::string(facts_of(quantity).name);
    series.unit = std::string(facts_of(quantity).unit);
    for (const FlightColumns& flight : flights) series.values.push_back(flight.quantity(quantity));
  }
  Series& pressure = result.emplace_back();
  pressure.name = "corrected_static_pressure";
  pressure.unit = "hPa";
  for (const FlightColumns& flight : flights) pressure.values.push_back(flight.corrected_pressure);
  const auto product = [&](std::string name, Quantity a, Quantity b) {
    Series series;
    series.name = std::move(name);
    for (const FlightColumns& flight : flights) {
      std::vector<double> values = flight.quantity(a);
      for (std::size_t i = 0; i < values.size(); ++i) values[i] *= flight.quantity(b)[i];
      series.values.push_back(std::move(values));
    }
    result.push_back(std::move(series));
  };
  product("attack times Mach number", Quantity::attack, Quantity::corrected_mach);
  product("sideslip times Mach number", Quantity::sideslip, Quantity::corrected_mach);
  return result;
}

std::set<std::string> left_out(const std::vector<Flight>& files, const ModelFile& model,
                               const Reference& reference, const DiagnoseOptions& options) {
  std::set<std::string> names(options.not_variables.begin(), options.not_variables.end());
  for (const Flight& file : files) names.insert(file.time_variable());
  names.insert({"Time", "time", "time_offset", "base_time"});
  const auto is_read_by_model = [&model](const std::string& variable) {
    return std::any_of(model.variables.begin(), model.variables.end(),
                       [&variable](const auto& role) { return role.second == variable; });
  };
  for (const std::string& variable : reference.variables()) {
    if (!is_read_by_model(variable)) names.insert(variable);
  }
  const auto laser = model.variables.find(Quantity::lams_airspeed);
  if (laser != model.variables.end()) names.insert(laser->second);
  return names;
}

/// Whether a simulated flight holds the variable as the truth beside what was recorded.
bool is_truth(const VariableInfo& variable) {
  return std::any_of(variable.attributes.begin(), variable.attributes.end(), [](const auto& attribute) {
    return attribute.first == "Category" && attribute.second == truth_category;
  });
}

Series read_series(const std::vector<Flight>& files, const std::string& name) {
  Series series;
  series.name = name;
  series.unit = files.front().variable(name).units;
  series.description = files.front().variable(name).long_name;
  series.in_file = true;
  for (const Flight& file : files) {
    std::vector<double>& values = series.values.emplace_back(file.records());
    for (const RecordBlock block : blocks_of(file.records()))
      file.read_at_rate(1, name, block, UnitConversion(), values.data() + block.first);
  }
  return series;
}

TracedVariable traced_of(const Structure& structure, const Series& series, std::size_t tested,
                         double squares) {
  TracedVariable variable;
  variable.name = series.name;
  variable.unit = series.unit;
  variable.description = series.description;
  variable.r2 = structure.share;
  variable.p_value = std::min(1.0, static_cast<double>(tested) * chi_squared_tail(structure.equivalent, 1.0));
  variable.linear_r2 = std::max(0.0, structure.line_chi2 - 1.0) / squares;
  variable.slope = structure.slope;
  variable.slope_error = structure.slope_error;
  variable.centre = structure.centre;
  // Only what a straight line describes is worth a formula.
  const bool straight = std::abs(structure.slope) > 3.0 * structure.slope_error && structure.slope != 0.0 &&
                        variable.linear_r2 > 0.5 * variable.r2;
  if (series.in_file && straight)
    variable.formula = fmt::format("k * ({} {} {:.4g})", series.name, structure.centre < 0.0 ? '+' : '-',
                                   std::abs(structure.centre));
  return variable;
}

/// Where, of all that is flown, the residual is largest beyond the noise.
std::string worst_regime(const Analysis& analysis, const std::vector<std::vector<double>>& after,
                         double noise) {
  constexpr double fewest = 120.0;
  std::array<double, regime_count> squares{};
  std::array<double, regime_count> counts{};
  for (std::size_t f = 0; f < after.size(); ++f) {
    const FlightSamples& samples = *analysis.flights()[f].samples;
    const std::vector<RegimeSet> regimes = regimes_of_samples(samples.time, samples.intervals);
    for (std::size_t i = 0; i < after[f].size(); ++i) {
      if (std::isnan(after[f][i])) continue;
      for (std::size_t r = 0; r < regime_count; ++r) {
        if (!regimes[i][r]) continue;
        squares[r] += after[f][i] * after[f][i];
        counts[r] += 1.0;
      }
    }
  }
  double worst = noise * noise;
  std::string name;
  for (std::size_t r = 0; r < regime_count; ++r) {
    if (counts[r] < fewest || !(squares[r] / counts[r] > worst)) continue;
    worst = squares[r] / counts[r];
    name = std::string(facts_of(static_cast<Regime>(r)).name);
  }
  return name;
}

std::vector<std::vector<double>> residuals_after(const Analysis& analysis,
                                                 const std::vector<std::size_t>& groups) {
  Eigen::VectorXd estimate;
  Eigen::MatrixXd covariance;
  analysis.search().fit(groups, estimate, covariance);
  std::vector<std::vector<double>> after;
  for (std::size_t f = 0; f < analysis.flights().size(); ++f) {
    std::vector<double> left = analysis.flights()[f].given;
    const std::vector<double> added = analysis.added(f, groups, estimate);
    for (std::size_t i = 0; i < left.size(); ++i) left[i] -= added[i];
    after.push_back(std::move(left));
  }
  return after;
}

/// Whether the strongest structure is beyond chance: for normal noise, and for the noise that is there, which
/// is known when that structure is taken off.
bool is_significant(const StructureTest& test, const Analysis& analysis,
                    const std::vector<std::size_t>& chosen, const std::vector<const Series*>& tested,
                    std::uint64_t seed) {
  const std::optional<std::size_t> best = test.strongest();
  if (!best) return false;
  const double score = test.structures()[*best].equivalent;
  if (!(score > test.threshold(chance))) return false;
  const double blocks = test.effective_blocks(*best);
  if (blocks < enough_blocks)
    return score > test.threshold(chance) * (1.0 + few_blocks_penalty / std::max(blocks, 1.0));
  const Series& series = *tested[*best];
  std::vector<Eigen::MatrixXd> columns = analysis.columns_of(chosen);
  const std::vector<Eigen::MatrixXd> more = test.columns_of(series.pointers());
  for (std::size_t f = 0; f < columns.size(); ++f) {
    Eigen::MatrixXd all(columns[f].rows(), columns[f].cols() + more[f].cols());
    all << columns[f], more[f];
    columns[f] = std::move(all);
  }
  StructureTest noise_alone(analysis.bins(), columns, analysis.residuals(), analysis.noise());
  for (const Series* each : tested) noise_alone.add(each->name, each->pointers());
  return noise_alone.chance_of(score, flips, seed) <= 2.0 * chance;
}

}  // namespace

UnexplainedStructure find_unexplained(const Analysis& analysis, const std::vector<Flight>& files,
                                      const ModelFile& model, const Reference& reference,
                                      const DiagnoseOptions& options, double residual_rms, double noise_rms) {
  UnexplainedStructure result;
  std::vector<Series> variables = flown(analysis);
  const std::vector<std::size_t>& chosen = analysis.result().chosen;
  const std::vector<std::vector<double>> after = residuals_after(analysis, chosen);
  if (options.whole_file) {
    const std::set<std::string> without = left_out(files, model, reference, options);
    for (const std::string& name : files.front().variables()) {
      const bool everywhere = std::all_of(files.begin(), files.end(), [&name](const Flight& file) {
        return file.has(name) && file.variable(name).is_series;
      });
      if (!everywhere || without.count(name) != 0 || is_truth(files.front().variable(name))) continue;
      Series series = read_series(files, name);
      if (shares_noise(after, series.pointers())) {
        result.found.shares_noise.push_back(name);
        continue;
      }
      variables.push_back(std::move(series));
    }
  }

  StructureTest beside_all(analysis.bins(), analysis.columns_of(chosen), analysis.residuals(),
                           analysis.noise());
  std::vector<const Series*> tested;
  for (const Series& series : variables) {
    if (beside_all.add(series.name, series.pointers())) tested.push_back(&series);
  }
  const bool structure_left = is_significant(beside_all, analysis, chosen, tested, options.seed);
  for (const Structure& structure : beside_all.structures())
    result.left = std::max(result.left, structure.chi2 - structure.freedom);

  const StructureTest* shown = &beside_all;
  std::unique_ptr<StructureTest> beside_base;
  if (structure_left && !chosen.empty()) {
    // A line that any of many variables may win with has to be that much better.
    beside_base = std::make_unique<StructureTest>(analysis.bins(), analysis.columns_of({}),
                                                  analysis.residuals(), analysis.noise());
    for (const Series* series : tested) beside_base->add(series->name, series->pointers());
    double by_effects = 0.0;
    for (const std::size_t group : chosen) by_effects += analysis.search().score(group, {}).freedom;
    const double together = (analysis.search().variance({}) / analysis.search().variance(chosen) - 1.0) *
                            static_cast<double>(analysis.scores().row_count());
    const double margin = 9.0 + 2.0 * std::log(static_cast<double>(tested.size()));
    double line = 0.0;
    for (std::size_t i = 0; i < beside_base->structures().size(); ++i) {
      if (tested[i]->in_file) line = std::max(line, beside_base->structures()[i].line_chi2);
    }
    // Both in units of the noise that all effects leave.
    line *= analysis.search().variance({}) / analysis.search().variance(chosen);
    result.overrules = line - 1.0 > least_gain * (together - by_effects) + margin;
    if (result.overrules) shown = beside_base.get();
  }

  const bool drifts = analysis.drift_gain() > least_drift_gain;
  std::vector<std::vector<double>> drift;
  for (std::size_t f = 0; f < files.size(); ++f) drift.push_back(analysis.drift(f, chosen));
  const auto whole = [](const std::vector<double>& series) -> const std::vector<double>& { return series; };
  result.found.drift_rms = rms_of(drift, whole);
  const bool large_drift = drifts && result.found.drift_rms > least_drift * noise_rms;
  result.found.significant = structure_left || large_drift;
  if (!result.found.significant) return result;

  const std::vector<std::vector<double>> left = result.overrules ? residuals_after(analysis, {}) : after;
  const double rms = result.overrules ? rms_of(left, whole) : residual_rms;
  // What is beyond the noise; at least what drifts, and what the best variable explains.
  const std::optional<std::size_t> best = shown->strongest();
  const Structure strongest = best ? shown->structures()[*best] : Structure{};
  result.found.rms =
      std::max({result.found.drift_rms, std::sqrt(std::max(0.0, rms * rms - noise_rms * noise_rms)),
                structure_left ? std::sqrt(strongest.share) * rms : 0.0});
  result.found.regime = worst_regime(analysis, left, noise_rms);
  result.found.p_value =
      std::min(1.0, static_cast<double>(tested.size()) * chi_squared_tail(strongest.equivalent, 1.0));
  const double squares = static_cast<double>(analysis.scores().row_count());
  std::vector<std::size_t> order;
  for (std::size_t i = 0; i < shown->structures().size(); ++i) {
    if (shown->structures()[i].equivalent > shown->threshold(chance)) order.push_back(i);
  }
  // A straight line that explains as much as a bent one comes first.
  const auto merit = [&](std::size_t i) {
    const Structure& structure = shown->structures()[i];
    return std::max(structure.chi2 - 2.0 * structure.freedom, structure.line_chi2 - 2.0);
  };
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return merit(a) > merit(b); });
  for (const std::size_t i : order) {
    if (result.found.variables.size() == most_variables) break;
    result.found.variables.push_back(traced_of(shown->structures()[i], *tested[i], tested.size(), squares));
    if (result.traced.empty()) result.traced = tested[i]->values;
  }
  return result;
}

}  // namespace pcor::internal

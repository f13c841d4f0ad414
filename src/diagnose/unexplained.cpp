#include "diagnose/unexplained.hpp"

#include <fmt/format.h>
#include <cereal/types/set.hpp>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <functional>
#include <numeric>
#include <set>
#include <utility>

#include <pcor/effects/catalogue.hpp>
#include <pcor/model/formula.hpp>
#include <pcor/numerics/line_fit.hpp>
#include "campaign/gps_rows.hpp"
#include "diagnose/findings.hpp"
#include "diagnose/flight_steps.hpp"
#include "diagnose/rms.hpp"
#include "diagnose/structure.hpp"
#include "diagnose/tested_variables.hpp"
#include "numerics/chi_squared.hpp"
#include "numerics/missing.hpp"
#include "numerics/triangular_factor.hpp"
#include "residuals/flight_statistics.hpp"
#include "roles/role_evidence.hpp"

namespace pcor::internal {
namespace {

constexpr double max_p_value = 0.01;  // probability that the best of all variables matches noise alone
constexpr double sure = 3.0;          // log odds, a probability of 95 %
constexpr std::size_t max_variables = 10;
/// Twice the gain in log-likelihood by drift. Noise of short memory gains 17 at most in a dozen flights
/// without drift, since no autoregression describes it wholly.
constexpr double min_drift_gain = 30.0;
/// Drift of transducers, hPa rms, not exceeded in 95 % of flights: 1.96 times the usual drift, 0.06 hPa.
constexpr double max_usual_drift = 0.12;

/// Variables that are not tested: variables of the reference that the model does not read, times, the laser,
/// and variables that the options exclude.
std::set<std::string> excluded(const FlightSet& files, const ModelDefinition& model,
                               const Reference& reference, const DiagnoseOptions& options) {
  std::set<std::string> names;
  for (const std::string& variable : reference.variables()) names.insert(variable);
  for (const auto& [role, variable] : model.variables) names.erase(variable);
  names.insert(options.not_variables.begin(), options.not_variables.end());
  for (const FlightOutline& file : files.outlines()) names.insert(file.time_variable);
  names.insert({"Time", "time", "time_offset", "base_time"});
  names.insert(model.variable_of(Quantity::lams_airspeed));
  return names;
}

/// Variables used in the measurement of the residual.
std::set<std::string> sensors_of(const ModelDefinition& model, const Reference& reference) {
  std::set<std::string> sensors{model.variable_of(Quantity::static_pressure),
                                model.variable_of(Quantity::dynamic_pressure)};
  if (reference.reads_laser()) sensors.insert(model.variable_of(Quantity::lams_airspeed));
  for (const std::string& variable : reference.variables()) sensors.insert(variable);
  return sensors;
}

EmpiricalPredictor predictor_of(const Structure& structure, double p_value) {
  EmpiricalPredictor variable = structure;
  variable.p_value = p_value;
  // Only a straight line gets a formula.
  const bool straight = std::abs(variable.slope) > 3.0 * variable.slope_error && variable.slope != 0.0 &&
                        variable.linear_r2 > 0.5 * variable.r2;
  if (structure.variable->in_file && straight)
    variable.formula = fmt::format("k * ({} {} {:.4g})", variable.name, variable.centre < 0.0 ? '+' : '-',
                                   std::abs(variable.centre));
  return variable;
}

/// Regime with the largest residual beyond the noise.
std::string worst_regime(const Analysis& analysis, const std::vector<std::vector<double>>& after,
                         double noise) {
  constexpr double fewest = 120.0;
  // Squares and their number for each regime.
  using Sums = Eigen::Matrix<double, static_cast<int>(regime_count), 2>;
  const auto sums = analysis.partition().all_reduce_flights<Sums>([&](std::size_t f) {
    Sums of_flight = Sums::Zero();
    const FlightSamples& samples = *analysis.flights()[f].samples;
    const std::vector<RegimeSet> regimes = regimes_of_samples(samples.time, samples.intervals);
    for (std::size_t i = 0; i < after[f].size(); ++i) {
      if (std::isnan(after[f][i])) continue;
      for (std::size_t r = 0; r < regime_count; ++r) {
        if (!regimes[i][r]) continue;
        of_flight(as_index(r), 0) += after[f][i] * after[f][i];
        of_flight(as_index(r), 1) += 1.0;
      }
    }
    return of_flight;
  });
  double worst = noise * noise;
  std::string name;
  for (std::size_t r = 0; r < regime_count; ++r) {
    const double squares = sums(as_index(r), 0);
    const double count = sums(as_index(r), 1);
    if (count < fewest || !(squares / count > worst)) continue;
    worst = squares / count;
    name = std::string(info_of(static_cast<Regime>(r)).name);
  }
  return name;
}

/// Residuals of the flights of this process after the groups.
std::vector<std::vector<double>> residuals_after(const Analysis& analysis,
                                                 const std::vector<std::size_t>& groups) {
  const Eigen::VectorXd coefficients = analysis.coefficients(groups);
  std::vector<std::vector<double>> after;
  for (std::size_t f = 0; f < analysis.flights().size(); ++f)
    after.push_back(
        select_samples(residual_after(analysis.flights()[f], coefficients), analysis.bins(f).records()));
  return after;
}

/// Structure of variables in addition to some effects. @param aside see `StructureTest`
StructureTest test_beside(const Analysis& analysis, const std::vector<std::size_t>& chosen,
                          const std::vector<TestedVariable>& variables,
                          const std::vector<Eigen::MatrixXd>& aside = {}) {
  StructureTest test(analysis.partition(), analysis.binned(chosen), analysis.noise(), random_seed, aside);
  for (const TestedVariable& variable : variables) test.add(variable);
  return test;
}

/// Moves variables whose changes are correlated with those of the residual to `variables` if they may be its
/// cause, otherwise to the list in `found`.
void sort_correlated(const Analysis& analysis,
                     std::vector<std::pair<TestedVariable, ChangeSlope>>& correlated,
                     std::vector<TestedVariable>& variables, Unexplained& found) {
  if (correlated.empty()) return;
  StructureTest test = test_beside(analysis, analysis.result().chosen, {});
  for (auto& [variable, slope] : correlated) {
    if (test.add(variable) && slope.agrees_with(test.structures().back())) {
      variables.push_back(std::move(variable));
    } else {
      found.shares_noise.push_back(variable.name);
    }
  }
}

/// Variables that may explain structure; those that cannot be causes are listed in `found`.
std::vector<TestedVariable> variables_to_test(const Analysis& analysis, const FlightSet& files,
                                              const ModelDefinition& model, const Reference& reference,
                                              const DiagnoseOptions& options,
                                              const std::vector<std::vector<double>>& after,
                                              Unexplained& found) {
  std::vector<TestedVariable> variables = quantity_variables(analysis.flights());
  if (!options.whole_file) return variables;
  // Variables computed from the sensors according to the first file.
  const auto computed = files.partition().all_gather_flights<std::set<std::string>>([&](std::size_t number) {
    return number > 0 ? std::set<std::string>() : computed_from(files[0], sensors_of(model, reference));
  });
  std::vector<std::pair<TestedVariable, ChangeSlope>> correlated;
  for (TestedVariable& variable :
       recorded_variables(files, analysis.flights(), excluded(files, model, reference, options))) {
    if (computed.front().count(variable.name) != 0) {
      found.computed.push_back(variable.name);
      continue;
    }
    const ChangeSlope slope = slope_of_changes(analysis.partition(), after, variable);
    if (slope.is_correlated()) {
      correlated.emplace_back(std::move(variable), slope);
    } else {
      variable.fine = variable.name == model.variable_of(Quantity::altitude);
      variables.push_back(std::move(variable));
    }
  }
  sort_correlated(analysis, correlated, variables, found);
  return variables;
}

/// Whether the structure with the greatest gain, for its degrees of freedom, is significant.
bool explains_most_beyond_chance(const StructureTest& test) {
  const std::vector<Structure>& all = test.structures();
  const auto maximum = std::max_element(all.begin(), all.end(), [](const Structure& a, const Structure& b) {
    return a.gain - a.degrees_of_freedom < b.gain - b.degrees_of_freedom;
  });
  return maximum != all.end() && test.p_value_of(maximum->chi2_one_dof) < max_p_value;
}

/// Structure of all variables in addition to some effects.
StructureTest test_all(const Analysis& analysis, const std::vector<std::size_t>& chosen,
                       const std::vector<TestedVariable>& variables) {
  StructureTest test = test_beside(analysis, chosen, variables);
  const std::vector<Eigen::MatrixXd> strong = test.strong_structure();
  if (strong.empty() || explains_most_beyond_chance(test)) return test;
  // The chance level may be too high only because its residuals contain that structure.
  return test_beside(analysis, chosen, variables, strong);
}

/// Variable minus its middle at every record; missing values repeat the previous one.
Eigen::VectorXd line_in(const std::vector<double>& values, double middle) {
  Eigen::VectorXd line = Eigen::VectorXd::Zero(as_index(values.size()));
  double last = 0.0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (std::isfinite(values[i])) last = values[i] - middle;
    line[as_index(i)] = last;
  }
  return line;
}

/// Lines in variables, in bins, for each local flight against each reference: one column per variable and
/// reference.
std::vector<Eigen::MatrixXd> lines_in(const Analysis& analysis,
                                      const std::vector<const Structure*>& structures) {
  const Eigen::Index references = as_index(analysis.reference_count());
  const std::vector<FlightColumns>& flights = analysis.flights();
  std::vector<Eigen::MatrixXd> lines;
  for (std::size_t f = 0; f < analysis.flight_count(); ++f) {
    const FlightColumns& flight = analysis.flight(f);
    const Binning& bins = analysis.bins(f);
    Eigen::MatrixXd& columns = lines.emplace_back(
        Eigen::MatrixXd::Zero(as_index(bins.size()), references * as_index(structures.size())));
    const auto known = std::find_if(flights.begin(), flights.end(), [&flight](const FlightColumns& other) {
      return other.file == flight.file;
    });
    if (known == flights.end() || !analysis.whole_partition().is_local(f)) continue;
    const auto position = static_cast<std::size_t>(known - flights.begin());
    for (std::size_t k = 0; k < structures.size(); ++k) {
      columns.col(references * as_index(k) + as_index(flight.reference)) =
          bins.means(line_in(*structures[k]->variable->values[position], structures[k]->centre));
    }
  }
  return lines;
}

/// Possible locations of a cause: at the static ports, the laser or the thermometer it leaves the total
/// pressures unchanged; at the pitot or at the transducers it changes them. @param structures of the
/// variables
void find_places(const Analysis& analysis, const std::vector<const Structure*>& structures,
                 const References& references, std::vector<EmpiricalPredictor>& variables) {
  constexpr double seen = 3.0;           // standard errors
  constexpr double would_be_seen = 6.0;  // the same slope as against the first reference
  const std::size_t count = analysis.reference_count();
  std::size_t blind = 0;  // first reference that is insensitive to static defects
  while (blind < count && references[blind]->sees_static_defect()) ++blind;
  if (blind == 0 || blind >= count || structures.empty()) return;
  std::vector<ColumnGroup> groups(count * structures.size());
  for (std::size_t k = 0; k < groups.size(); ++k) {
    groups[k].first = as_index(k);
    groups[k].count = 1;
    groups[k].bounds.resize(1);
  }
  const WhitenedSystem scores = analysis.scores_with(lines_in(analysis, structures));
  const EffectSearch search(scores, analysis.base(), groups);
  for (std::size_t k = 0; k < structures.size(); ++k) {
    EmpiricalPredictor& variable = variables[k];
    const GroupScore total = search.score(count * k + blind, {count * k});
    if (total.degrees_of_freedom == 0.0) continue;
    const double error = std::sqrt(total.covariance(0, 0));
    if (std::abs(total.estimate[0]) > seen * error) {
      variable.components = {"pitot", "p-transducer", "q-transducer"};
      if (!references.front()->reads_laser()) variable.components.emplace_back("other-system");
      variable.location = EffectLocation::pitot;
    } else if (std::abs(variable.slope) > would_be_seen * error) {
      variable.components = {"port", references.front()->reads_laser() ? "laser" : "other-system"};
      if (references.front()->reads_laser()) variable.components.emplace_back("thermometer");
      variable.components.emplace_back("pitot");  // common to both systems
    }
  }
}

/// Inputs of chosen effects. A variable that an effect reads is not a rival of it.
struct EffectInputs {
  std::set<Quantity> quantities{};
  std::set<std::string> variables{};
};

/// Inputs of the effects of findings on either system; an angle is also read as its differential pressure.
EffectInputs effect_inputs(const std::vector<Finding>& findings, const ModelDefinition& model) {
  EffectInputs inputs;
  const auto read = [&](Quantity quantity) {
    inputs.quantities.insert(quantity);
    inputs.variables.insert(model.variable_of(quantity));
  };
  const auto read_with_angles = [&](Quantity need) {
    read(need);
    if (need == Quantity::attack || need == Quantity::attack_ratio) {
      read(Quantity::attack);
      read(Quantity::attack_differential_pressure);
    }
    if (need == Quantity::sideslip || need == Quantity::sideslip_ratio) {
      read(Quantity::sideslip);
      read(Quantity::sideslip_differential_pressure);
    }
  };
  for (const Finding& finding : findings) {
    if (finding.effect.is_formula()) {
      const auto formula = Formula::parse(finding.effect.formula, finding.effect.parameter_names, nullptr);
      for (const std::string& name : formula ? formula->variables() : std::vector<std::string>()) {
        inputs.variables.insert(name);
        if (quantity_named(name) != Quantity::count) read_with_angles(quantity_named(name));
      }
      continue;
    }
    for (const Quantity need : effect_named(finding.effect.id)->needs) {
      if (need != Quantity::count) read_with_angles(need);
    }
  }
  return inputs;
}

/// Whether two series are images of each other: their correlation exceeds 0.95 in size. @param pair the two
/// series of a local flight; the second may be null or empty
bool are_images(const Analysis& analysis,
                const std::function<std::array<const std::vector<double>*, 2>(std::size_t flight)>& pair) {
  constexpr double image = 0.95;
  const auto of_flights = analysis.partition().all_gather_flights<PairMoments>([&](std::size_t f) {
    PairMoments moments;
    const auto [x, y] = pair(f);
    if (y == nullptr || y->empty()) return moments;
    for (const std::size_t record : analysis.bins(f).records()) {
      if (std::isfinite((*x)[record]) && std::isfinite((*y)[record])) moments.add((*x)[record], (*y)[record]);
    }
    return moments;
  });
  PairMoments all;
  for (const PairMoments& moments : of_flights) all.add(moments);
  return std::abs(all.correlation()) > image;
}

bool is_image(const Analysis& analysis, const TestedVariable& variable, Quantity quantity) {
  return are_images(analysis, [&](std::size_t f) -> std::array<const std::vector<double>*, 2> {
    const FlightColumns& flight = analysis.flights()[f];
    const std::vector<double>* known = &flight.quantity(quantity);
    if (known->empty()) known = flight.samples->model.find(quantity);
    return {variable.values[f].get(), known};
  });
}

bool is_image(const Analysis& analysis, const TestedVariable& variable, const TestedVariable& other) {
  return are_images(analysis, [&](std::size_t f) -> std::array<const std::vector<double>*, 2> {
    return {variable.values[f].get(), other.values[f].get()};
  });
}

/// Most likely line in a variable.
struct LineRival {
  std::string variable{};
  double log_odds = -infinity;  ///< against all chosen effects
};

/// Compares the most likely line in one variable with all chosen effects: marginal likelihoods, times
/// the expected number of effects and of causes among the variables, shared by those that were tested. The
/// line has a separate slope against each reference because the location of the cause is unknown; the shapes
/// of the effects are uncertain. Inputs of an effect do not compete with it.
LineRival best_line(const Analysis& analysis, const std::vector<std::size_t>& chosen,
                    const StructureTest& tested, const EffectInputs& inputs) {
  constexpr double expected_effects = 0.5;
  constexpr double expected_variables = 0.1;
  const auto is_input = [&](const TestedVariable& variable) {
    return inputs.variables.count(variable.name) != 0 ||
           std::any_of(inputs.quantities.begin(), inputs.quantities.end(),
                       [&](Quantity quantity) { return is_image(analysis, variable, quantity); });
  };
  std::vector<const Structure*> causes;
  for (const Structure& structure : tested.structures()) {
    const TestedVariable& variable = *structure.variable;
    if (variable.may_be_cause && variable.turn == 0.0 && !is_input(variable)) causes.push_back(&structure);
  }
  LineRival best;
  if (causes.empty()) return best;
  const Competition competition = analysis.competition(chosen, lines_in(analysis, causes));
  const EffectSearch search(competition.system, analysis.base(), competition.groups);
  std::vector<std::size_t> effects(chosen.size());
  std::iota(effects.begin(), effects.end(), std::size_t{0});
  const auto prior = [](double expected, std::size_t tested_count) {
    return std::log(expected / static_cast<double>(tested_count));
  };
  std::size_t tested_effects = 0;
  for (std::size_t group = 0; group < analysis.groups().size(); ++group)
    tested_effects += analysis.search().is_absorbed(group) ? 0 : 1;
  const double against = search.evidence(effects) +
                         static_cast<double>(chosen.size()) * prior(expected_effects, tested_effects) -
                         prior(expected_variables, causes.size());
  for (std::size_t k = 0; k < causes.size(); ++k) {
    if (search.is_absorbed(chosen.size() + k)) continue;
    const double log_odds = search.evidence({chosen.size() + k}) - against;
    if (log_odds > best.log_odds) best = {causes[k]->name, log_odds};
  }
  return best;
}

/// Adds the variables with significant structure, each once, and returns their structures.
std::vector<const Structure*> add_predictors(const Analysis& analysis, const StructureTest& tested,
                                             Diagnosis& diagnosis) {
  std::vector<EmpiricalPredictor>& variables = diagnosis.unexplained.variables;
  std::vector<const Structure*> order;
  for (const Structure& structure : tested.structures()) {
    if (tested.p_value_of(structure.chi2_one_dof) < max_p_value) order.push_back(&structure);
  }
  // A straight line that explains as much as a curve is preferred.
  const auto merit = [](const Structure& each) {
    return std::max(each.gain - 2.0 * each.degrees_of_freedom, each.line_gain - 2.0);
  };
  std::sort(order.begin(), order.end(),
            [&](const Structure* a, const Structure* b) { return merit(*a) > merit(*b); });
  std::set<std::string> named;
  std::vector<const Structure*> structures;
  for (const Structure* const structure : order) {
    if (variables.size() == max_variables) break;
    if (!named.insert(structure->name).second) continue;
    variables.push_back(predictor_of(*structure, tested.p_value_of(structure->chi2_one_dof)));
    for (std::size_t k = 0; k < structures.size() && variables.back().similar_to.empty(); ++k) {
      if (variables[k].similar_to.empty() &&
          is_image(analysis, *structure->variable, *structures[k]->variable))
        variables.back().similar_to = variables[k].name;
    }
    structures.push_back(structure);
    if (structures.size() > 1) continue;
    for (std::size_t f = 0; f < diagnosis.flights.size(); ++f)
      diagnosis.flights[f].predictor = *structure->variable->values[f];
  }
  return structures;
}

std::vector<FlightOffset> steps_between(const Analysis& analysis, const std::vector<std::size_t>& chosen) {
  std::vector<FlightOffset> steps;
  if (analysis.flights().size() < 2) return steps;
  steps = find_mean_offsets(analysis.partition(), analysis.binned(chosen), analysis.noise_beside_offsets());
  for (std::size_t f = 0; f < steps.size(); ++f) steps[f].flight = analysis.flights()[f].samples->name;
  steps.erase(std::remove_if(steps.begin(), steps.end(),
                             [](const FlightOffset& step) { return !(step.p_value < max_p_value); }),
              steps.end());
  std::sort(steps.begin(), steps.end(),
            [](const FlightOffset& a, const FlightOffset& b) { return std::abs(a.size) > std::abs(b.size); });
  return steps;
}

/// Withdraws the findings if a straight line in one variable of the files is more likely than they are.
void overrule(Diagnosis& diagnosis, const std::string& variable) {
  for (const Finding& finding : diagnosis.findings) {
    diagnosis.notes.push_back(fmt::format(
        "{} is not reported as the cause: a straight line in {} is more likely (probability above "
        "95 %)",
        finding.id(), variable));
  }
  diagnosis.findings.clear();
  for (FlightDiagnosis& flight : diagnosis.flights) {
    flight.after = flight.before;
    flight.added.clear();
    flight.evidence.clear();
  }
}

/// Notes on the variables the residual is correlated with that seem to be an input, without a name in the
/// model, of an effect that was not tested.
void note_unnamed_inputs(const FlightSet& files, const ModelDefinition& model, Diagnosis& diagnosis) {
  if (diagnosis.unexplained.variables.empty()) return;
  for (const NotTestable& effect : diagnosis.not_testable) {
    const EffectInfo* const info = effect_named(effect.effect);
    if (info == nullptr) continue;
    for (const Quantity input : info->needs) {
      if (!is_role(input) || model.variables.count(input) != 0) continue;
      const std::string role(info_of(input).name);
      const auto variables = files.partition().all_gather_flights<std::string>(
          [&](std::size_t flight) { return sure_variable(files[flight], role); });
      for (const EmpiricalPredictor& predictor : diagnosis.unexplained.variables) {
        if (std::any_of(variables.begin(), variables.end(),
                        [&](const std::string& variable) { return variable != predictor.name; }))
          continue;
        diagnosis.unnamed_roles.push_back({role, predictor.name, effect.effect});
        diagnosis.notes.push_back(fmt::format(
            "{} was not tested: write {} = \"{}\" into [variables] of the model; {} seems to be that role",
            effect.effect, role, predictor.name, predictor.name));
      }
    }
  }
}

}  // namespace

double add_unexplained(const Analysis& analysis, const FlightSet& files, const ModelDefinition& model,
                       const ModelDefinition& extended, const References& references,
                       const DiagnoseOptions& options, Diagnosis& diagnosis) {
  if (gps_kind(*references.front())) {
    add_rival_by_atmosphere(diagnosis);
    diagnosis.notes.emplace_back(
        "give a laser or a second system as a further reference to test unnamed structure; variations of the "
        "atmosphere look the same in a comparison with GPS");
    return 0.0;
  }
  Unexplained& found = diagnosis.unexplained;
  const std::vector<std::size_t>& chosen = analysis.result().chosen;
  const std::vector<std::vector<double>> after = residuals_after(analysis, chosen);
  const std::vector<TestedVariable> variables =
      variables_to_test(analysis, files, model, first_of(references), options, after, found);

  StructureTest tested = test_all(analysis, chosen, variables);
  const double by_variables = tested.p_value();
  double remaining_chi2 = 0.0;
  for (const Structure& structure : tested.structures()) {
    if (by_variables < max_p_value)
      remaining_chi2 = std::max(remaining_chi2, structure.gain - structure.degrees_of_freedom);
  }
  LineRival line;
  if (!chosen.empty())
    line = best_line(analysis, chosen, tested, effect_inputs(diagnosis.findings, extended));
  const bool overrules = line.log_odds > sure;
  if (overrules) tested = test_all(analysis, {}, variables);

  const auto rms_of_flights = [&](std::vector<double> FlightDiagnosis::*series) {
    return rms_of(
        analysis.partition(), [&](std::size_t f) -> const auto& { return diagnosis.flights[f].*series; });
  };
  found.drift_rms = rms_of_flights(&FlightDiagnosis::drift);
  const bool drifts = analysis.drift_gain() > min_drift_gain && found.drift_rms > max_usual_drift;
  found.steps = steps_between(analysis, chosen);
  found.significant = by_variables < max_p_value || drifts || !found.steps.empty() || overrules;
  if (found.significant) {
    const std::vector<std::vector<double>> residuals = overrules ? residuals_after(analysis, {}) : after;
    const double rms =
        overrules ? rms_of(
                        analysis.partition(), [&](std::size_t f) -> const auto& { return residuals[f]; })
                  : rms_of_flights(&FlightDiagnosis::after);
    const double noise_rms = diagnosis.noise_rms_with_findings;
    const std::vector<const Structure*> structures = add_predictors(analysis, tested, diagnosis);
    // Retained effects describe a part of every reference that the lines do not include.
    if (chosen.empty() || overrules) find_places(analysis, structures, references, found.variables);
    // Part beyond the noise; at least the drift and the part that the best variable explains.
    found.rms = std::max(found.drift_rms, std::sqrt(std::max(0.0, rms * rms - noise_rms * noise_rms)));
    if (!found.variables.empty())
      found.rms = std::max(found.rms, std::sqrt(found.variables.front().r2) * rms);
    // A regime is named only if its residual clearly exceeds that of all samples.
    found.regime = worst_regime(analysis, residuals, std::max(noise_rms, 1.25 * rms));
    found.p_value =
        std::min(tested.p_value(),
                 drifts ? chi_squared_tail(analysis.drift_gain(), drift_time_constants.size()) : 1.0);
    for (const FlightOffset& step : found.steps) found.p_value = std::min(found.p_value, step.p_value);
  }
  note_unnamed_inputs(files, extended, diagnosis);
  if (overrules) {
    overrule(diagnosis, line.variable);
  } else if (line.log_odds > -sure) {
    diagnosis.rival = line.variable;
    diagnosis.notes.push_back(fmt::format(
        "a straight line in {} may be the cause instead of the effects (probability between 5 and "
        "95 %)",
        diagnosis.rival));
  }
  return remaining_chi2;
}

std::string id_of_predictor(const std::string& variable) {
  std::string id = "traced-";
  for (const char each : variable) {
    const auto letter = static_cast<unsigned char>(each);
    id += std::isalnum(letter) != 0 ? static_cast<char>(std::tolower(letter)) : '-';
  }
  return id;
}

ModelEffect effect_of(const EmpiricalPredictor& variable, const std::string& flights) {
  ModelEffect effect;
  effect.id = id_of_predictor(variable.name);
  effect.parameter_names = {"k"};
  effect.parameters = {variable.slope};
  effect.formula = variable.formula;
  effect.location = variable.location;
  effect.unit = "hPa";
  effect.source = fmt::format("traced in the residuals of {}: {:.0f} % of their variance, p = {:.2g}",
                              flights, 100.0 * variable.r2, variable.p_value);
  return effect;
}

}  // namespace pcor::internal

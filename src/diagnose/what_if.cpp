#include <pcor/diagnose/what_if.hpp>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>
#include <variant>

#include <pcor/base/error.hpp>
#include "diagnose/flight_columns.hpp"
#include "diagnose/step_dates.hpp"
#include "diagnose/unexplained.hpp"
#include "diagnose/what_if_fit.hpp"
#include "numerics/missing.hpp"
#include "numerics/triangular_factor.hpp"
#include "residuals/masks.hpp"
#include "residuals/parameter_dependent_columns.hpp"

namespace pcor {

using namespace internal;

namespace {

constexpr std::size_t max_predictors = 2;

/// Whether a candidate is the requested effect, in its shape.
bool is_meant(const Candidate& candidate, const WhatIfCandidate& requested) {
  if (candidate.id != requested.id || candidate.is_shared != requested.is_shared) return false;
  if (!requested.effect) return !candidate.is_variant;
  std::vector<double> parameters = candidate.effect.parameters;
  for (const CandidateParameter& tested : candidate.tested)
    parameters[tested.index] = requested.effect->parameters[tested.index];
  return candidate.effect.scaling == requested.effect->scaling && parameters == requested.effect->parameters;
}

/// Distance between the candidate's time for the need and that of the requested effect.
double distance(const Candidate& candidate, const WhatIfCandidate& requested) {
  const Memory memory = memory_of(candidate.effect);
  if (memory.of == Quantity::count || !requested.effect) return 0.0;
  return std::abs(candidate.memory - std::abs(requested.effect->parameters[memory.parameter]));
}

/// Index of the matching candidate; the number of candidates if there is no match.
std::size_t position_of(const std::vector<Candidate>& candidates, const WhatIfCandidate& requested) {
  std::size_t best = candidates.size();
  for (std::size_t c = 0; c < candidates.size(); ++c) {
    if (!is_meant(candidates[c], requested)) continue;
    if (best == candidates.size() ||
        distance(candidates[c], requested) < distance(candidates[best], requested))
      best = c;
  }
  return best;
}

/// Dates of requested steps; empty for any date.
std::vector<double> dates_for(const std::vector<WhatIfCandidate>& requested, const FlightSet& files) {
  std::vector<ModelEffect> effects;
  for (const WhatIfCandidate& each : requested) {
    if (each.effect) effects.push_back(*each.effect);
  }
  std::vector<double> dates = dates_of(effects);
  return dates.empty() ? StepDates(files).tried() : dates;
}

/// Keeps the requested candidates and those that they depend on.
void keep(CandidateSet& set, const std::vector<WhatIfCandidate>& requested) {
  std::vector<bool> kept(set.candidates.size() + 1, false);
  for (const WhatIfCandidate& each : requested) {
    std::size_t candidate = position_of(set.candidates, each);
    kept[candidate] = true;
    while (candidate < set.candidates.size() && set.candidates[candidate].is_shared) --candidate;
    kept[candidate] = true;
  }
  std::vector<Candidate> candidates;
  for (std::size_t c = 0; c < set.candidates.size(); ++c) {
    if (kept[c]) candidates.push_back(std::move(set.candidates[c]));
  }
  set.candidates = std::move(candidates);
}

/// Sorts candidates and columns into the requested order; returns the requested effects that could be tested.
/// @param further flights with the same columns
std::vector<WhatIfCandidate> put_in_order(CandidateSet& set, PartitionedColumns& flights,
                                          PartitionedColumns& further,
                                          const std::vector<WhatIfCandidate>& requested) {
  std::vector<WhatIfCandidate> found;
  std::vector<Candidate> candidates;
  std::vector<Eigen::Index> columns;
  for (const WhatIfCandidate& each : requested) {
    const std::size_t position = position_of(set.candidates, each);
    if (position == set.candidates.size()) continue;
    found.push_back(each);
    candidates.push_back(set.candidates[position]);
    for (std::size_t k = 0; k < candidates.back().tested.size(); ++k)
      columns.push_back(as_index(set.first_column(position) + k));
  }
  set.candidates = std::move(candidates);
  for (PartitionedColumns* const each : {&flights, &further}) {
    for (FlightColumns& flight : each->flights) flight.keep_candidates(columns);
  }
  return found;
}

/// Columns of unused samples: all of files after the fitted ones, and later parts of fitted flights.
PartitionedColumns held_out_columns(const FlightSet& files, std::size_t fitted,
                                    const PartitionedColumns& columns, const ModelDefinition& model,
                                    const CandidateSet& set, const WhatIfOptions& options) {
  const MaskOptions& mask = options.diagnose.mask;
  const double share = options.diagnose.training_share;
  std::vector<std::size_t> file_of_each;
  for (std::size_t file = fitted; file < files.size(); ++file) file_of_each.push_back(file);
  const std::size_t whole = file_of_each.size();
  if (share < 1.0) {
    for (const FlightColumns& flight : columns.flights) {
      if (flight.reference == 0) file_of_each.push_back(flight.file);
    }
  }
  // The fitted flights against the first reference come first.
  const auto read = [&](std::size_t entry) {
    return entry < whole ? files.samples(file_of_each[entry], set.extended, *set.references[0], mask)
                         : columns.flights[entry - whole].samples;
  };
  return columns_of_entries(
      files.partition().of_entries(file_of_each), read,
      [&](std::size_t entry, const SamplesOfFlight& samples) {
        FlightColumns later = find_columns(samples, model, set, 0, mask, 1.0);
        for (const std::size_t i : used_samples(later.mask, entry < whole ? 0.0 : share))
          later.given[i] = nan;
        later.file = file_of_each[entry];
        return later;
      });
}

/// All columns of a flight by records, in double precision.
std::vector<std::vector<double>> by_records(const FlightColumns& flight) {
  std::vector<std::vector<double>> columns;
  for (const Eigen::MatrixXf* part : {&flight.base, &flight.candidates}) {
    for (Eigen::Index c = 0; c < part->cols(); ++c) {
      std::vector<double>& column = columns.emplace_back(flight.given.size(), nan);
      for (std::size_t i = 0; i < column.size(); ++i) {
        if (!std::isnan(flight.given[i])) column[i] = static_cast<double>((*part)(as_index(i), c));
      }
    }
  }
  return columns;
}

/// Flights of all ranks with columns in the panel, complete on every rank.
std::vector<FlightColumns> shown(const PartitionedColumns& columns,
                                 const std::function<bool(std::size_t)>& is_shown) {
  std::vector<std::size_t> entries;
  for (std::size_t f = 0; f < columns.flights.size(); ++f) {
    if (columns.flights[f].reference == 0 && is_shown(columns.flights[f].file)) entries.push_back(f);
  }
  return columns.partition.of_entries(entries).all_gather_flights<FlightColumns>(
      [&](std::size_t k) { return columns.flights[entries[k]]; });
}

/// Appends the unused samples to the used ones.
void add_held_out(std::vector<WhatIfFlight>& flights, const FlightColumns& held_out) {
  std::vector<std::vector<double>> columns = by_records(held_out);
  const auto same = std::find_if(flights.begin(), flights.end(), [&](const WhatIfFlight& flight) {
    return flight.samples->name == held_out.samples->name && flight.samples->time == held_out.samples->time;
  });
  if (same == flights.end()) {
    flights.push_back({held_out.samples, std::move(columns)});
    return;
  }
  for (std::size_t c = 0; c < columns.size(); ++c) {
    for (std::size_t i = 0; i < columns[c].size(); ++i) {
      if (!std::isnan(columns[c][i])) same->columns[c][i] = columns[c][i];
    }
  }
}

std::string note_of(const Candidate& candidate, const std::string& flaps_variable) {
  if (candidate.is_of_reference()) return "An error of the reference system: do not change the model.";
  if (candidate.is_shared)
    return "The reference system has the same error, which a model file cannot represent: the command adds "
           "the effect to the model only.";
  if (reads_flaps(candidate.effect, flaps_variable))
    return "Only samples with flaps retracted are used here; a refit with this effect also uses samples with "
           "flaps extended.";
  return "";
}

/// Whether the provenance of a model states a fit to one of the flights.
bool is_fitted_to(const ModelDefinition& model, const FlightSet& flights) {
  const auto* const fitted = find_entry<ProvenanceList>(model.provenance, "flights");
  if (fitted == nullptr) return false;
  for (const ProvenanceValue& each : *fitted) {
    const auto* const name = std::get_if<std::string>(&each);
    for (std::size_t f = 0; name != nullptr && f < flights.size(); ++f) {
      if (*name == flights.name(f)) return true;
    }
  }
  return false;
}

/// Formulas of the user, and those of the requested effects.
std::vector<ModelEffect> formulas_with(std::vector<ModelEffect> formulas,
                                       const std::vector<WhatIfCandidate>& requested) {
  for (const WhatIfCandidate& each : requested) {
    const auto same = [&each](const ModelEffect& formula) { return formula.id == each.id; };
    if (each.effect && each.effect->is_formula() && std::none_of(formulas.begin(), formulas.end(), same))
      formulas.push_back(*each.effect);
  }
  return formulas;
}

/// Effects and coefficients of a panel. @param found effects of the candidates of the set
/// @param start_values of the model's coefficients, if they differ from those of the model
WhatIfPanel panel_of(const CandidateSet& set, const std::vector<WhatIfCandidate>& found,
                     const std::vector<CoefficientEstimate>& start_values,
                     const std::string& flaps_variable) {
  WhatIfPanel panel;
  panel.model_coefficient_count = set.base.size();
  for (const BaseCoefficient& coefficient : set.base) {
    const auto start =
        std::find_if(start_values.begin(), start_values.end(),
                     [&](const CoefficientEstimate& each) { return each.name == coefficient.name; });
    panel.coefficients.push_back({coefficient.name, coefficient.unit, coefficient.value,
                                  start == start_values.end() ? coefficient.value : start->value,
                                  coefficient.bounds.lower, coefficient.bounds.upper,
                                  coefficient.of_reference});
  }
  for (std::size_t e = 0; e < found.size(); ++e) {
    const Candidate& candidate = set.candidates[e];
    const auto stands_for = std::find_if(found.begin(), found.end(), [&](const WhatIfCandidate& each) {
      return each.id == found[e].stands_for;
    });
    panel.effects.push_back({found[e].id,
                             candidate.title,
                             found[e].why,
                             {},
                             panel.coefficients.size(),
                             candidate.tested.size(),
                             "",
                             candidate.effect.is_formula(),
                             note_of(candidate, flaps_variable)});
    if (stands_for != found.end())
      panel.effects.back().stands_for = static_cast<std::size_t>(stands_for - found.begin());
    for (const CandidateParameter& tested : candidate.tested) {
      const double neutral = candidate.effect.parameters[tested.index];
      panel.coefficients.push_back({tested.name, tested.unit, neutral, neutral, neutral + tested.bounds.lower,
                                    neutral + tested.bounds.upper});
    }
  }
  return panel;
}

}  // namespace

std::vector<WhatIfCandidate> what_if_candidates(const Diagnosis& diagnosis,
                                                const std::vector<ModelEffect>& formulas) {
  std::vector<WhatIfCandidate> candidates;
  const auto add = [&candidates](WhatIfCandidate candidate) {
    const bool is_new = std::none_of(candidates.begin(), candidates.end(),
                                     [&](const WhatIfCandidate& each) { return each.id == candidate.id; });
    if (is_new && candidates.size() < max_what_if_effects) candidates.push_back(std::move(candidate));
  };
  for (const Finding& finding : diagnosis.findings)
    add({finding.id(), "found", finding.effect, finding.is_shared, finding.id()});
  for (const Finding& finding : diagnosis.findings) {
    for (const Alias& alias : finding.aliases)
      add({alias.effect, "instead of " + finding.id(), alias.correction, alias.is_shared, finding.id()});
  }
  for (const ModelEffect& formula : formulas) add({formula.id, "your formula"});
  std::vector<std::string> flights;
  for (const FlightDiagnosis& flight : diagnosis.flights) flights.push_back(flight.name);
  // A variable with structure that no effect explains counts as found.
  std::size_t predictors = 0;
  for (const EmpiricalPredictor& variable : diagnosis.unexplained.variables) {
    if (variable.formula.empty() || predictors == max_predictors) continue;
    const ModelEffect effect = effect_of(variable, fmt::format("{}", fmt::join(flights, ", ")));
    const bool counts = predictors++ == 0 && diagnosis.findings.empty();
    add({effect.id, "varies with " + variable.name, effect, false, counts ? effect.id : ""});
  }
  // Nearest candidates by estimate in units of the error.
  constexpr std::size_t nearest = 4;
  std::vector<std::pair<double, const UpperLimit*>> others;
  for (const UpperLimit& limit : diagnosis.limits) {
    double score = 0.0;
    for (const CoefficientEstimate& estimate : limit.estimates)
      score = std::max(score, std::abs(estimate.value) / estimate.standard_error);
    if (std::isfinite(score)) others.emplace_back(score, &limit);
  }
  std::stable_sort(others.begin(), others.end(),
                   [](const auto& a, const auto& b) { return a.first > b.first; });
  others.resize(std::min(others.size(), nearest));
  for (const auto& [score, limit] : others) add({limit->effect, "not found"});
  return candidates;
}

WhatIf what_if(const FlightSet& flights, const ModelDefinition& model, const References& all_references,
               const std::vector<WhatIfCandidate>& requested, const WhatIfOptions& options) {
  const FlightSet files = flights.with(options.holdout);
  // A refit by GPS does not minimise one residual per sample.
  References references = in_order_of_diagnosis(all_references);
  references.erase(std::remove_if(references.begin(), references.end(),
                                  [](const auto& each) { return gps_kind(*each).has_value(); }),
                   references.end());
  if (references.empty()) return {};
  Notes notes;  // reported by the diagnosis
  CandidateSet set =
      find_candidates(model, formulas_with(options.diagnose.formulas, requested), files, references,
                      dates_for(requested, files), options.diagnose.trust_reference);
  keep(set, requested);
  PartitionedColumns columns = columns_of_flights(files, flights.size(), model, set, options.diagnose, notes);
  leave_out_empty(columns);
  if (columns.flights.empty()) throw Error(Error::Code::samples, "no sample remains to test effects");
  drop_untestable(set, columns);
  PartitionedColumns others = held_out_columns(files, flights.size(), columns, model, set, options);
  hold_imitated_coefficients(set, columns, &others);
  const std::vector<WhatIfCandidate> found = put_in_order(set, columns, others, requested);

  WhatIf result;
  if (found.empty()) return result;
  WhatIfPanel& panel = result.panel;
  panel =
      panel_of(set, found, options.refitted_coefficients, columns.flights.front().samples->flaps_variable);
  panel.is_start_fitted = is_fitted_to(model, files);
  std::vector<std::size_t> are_found;
  for (std::size_t e = 0; e < found.size(); ++e) {
    result.effects.push_back(set.candidates[e].effect);
    if (found[e].stands_for == found[e].id) are_found.push_back(e);
  }
  const WhatIfFit fit(model, set, std::move(columns), std::move(others), are_found, options.is_robust, panel);
  const auto is_shown = [&](std::size_t file) {
    const auto& requested_flights = options.diagnose.series_of;
    return !requested_flights || file >= flights.size() ||
           std::find(requested_flights->begin(), requested_flights->end(), file) != requested_flights->end();
  };
  for (const FlightColumns& flight : shown(fit.flights(), is_shown))
    result.flights.push_back({flight.samples, by_records(flight)});
  for (const FlightColumns& flight : shown(fit.others(), is_shown)) add_held_out(result.flights, flight);
  files.require_unchanged();
  return result;
}

}  // namespace pcor

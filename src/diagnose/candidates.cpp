#include "diagnose/candidates.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <optional>

#include <pcor/effects/catalogue.hpp>
#include <pcor/realtime/chain.hpp>
#include "campaign/model_parameters.hpp"
#include "campaign/reference_id.hpp"
#include "flight/value_problem.hpp"
#include "model_io/parameter_unit.hpp"
#include "parallel/flight_partition.hpp"
#include "roles/model_inputs.hpp"
#include "roles/recorded_series.hpp"

namespace pcor::internal {
namespace {

/// Aircraft family whose variable names a model uses on some flights.
const VariableNaming& naming_of(const ModelDefinition& file, const FlightSet& flights) {
  if (!file.roles_from.empty()) return naming_by_name(file.roles_from);
  return flights.size() == 0 ? known_namings().front() : naming_by_name(flights.outlines().front().naming);
}

/// Fills roles without a variable in the model with the usual variables, if every flight records them in a
/// suitable unit. Flow angles stay unchanged if the model computes them from the radome.
void name_usual_variables(ModelDefinition& file, const FlightSet& flights) {
  const VariableNaming& naming = naming_of(file, flights);
  std::vector<std::pair<Quantity, std::string>> usual;  // most usual variable of each role first
  for (std::size_t i = 0; i < role_count; ++i) {
    const auto role = static_cast<Quantity>(i);
    if (file.variables.count(role) != 0) continue;
    if (role == Quantity::attack && file.model.attack_radome.is_calibrated()) continue;
    if (role == Quantity::sideslip && file.model.sideslip_radome.is_calibrated()) continue;
    for (std::string& variable : usual_variables(naming, role)) usual.emplace_back(role, std::move(variable));
  }
  const auto recorded = flights.partition().all_gather_flights<std::vector<bool>>([&](std::size_t number) {
    std::vector<bool> has;
    for (const auto& [role, variable] : usual)
      has.push_back(
          has_values(flights[number], variable, std::string(info_of(role).unit), naming.unit_of(variable)));
    return has;
  });
  std::size_t position = 0;
  for (const auto& [role, variable] : usual) {
    const std::size_t k = position++;
    if (file.variables.count(role) != 0) continue;
    if (!std::all_of(recorded.begin(), recorded.end(), [k](const std::vector<bool>& has) { return has[k]; }))
      continue;
    file.variables[role] = variable;
    if (std::string unit = naming.unit_of(variable); !unit.empty()) file.units[role] = std::move(unit);
  }
}

Candidate candidate_of(const EffectInfo& info) {
  Candidate candidate;
  candidate.effect = neutral_effect(info.id);
  candidate.id = candidate.effect.id;
  candidate.title = std::string(info.title);
  for (std::size_t i = 0; i < info.parameter_count(); ++i) {
    const ParameterInfo& parameter = info.parameters[i];
    if (parameter.shape) continue;
    candidate.tested.push_back({i,
                                std::string(parameter.name),
                                std::string(parameter.unit),
                                parameter.typical,
                                {parameter.lower - parameter.neutral, parameter.upper - parameter.neutral}});
  }
  return candidate;
}

bool reads_date(const EffectInfo& info) { return info.needs[0] == Quantity::date; }

/// Values at which a shape parameter is tried: from its `ParameterInfo`, or dates.
std::vector<double> tried_values(const EffectInfo& info, const ParameterInfo& shape,
                                 const std::vector<double>& dates) {
  if (reads_date(info)) return dates;
  return {shape.tried.begin(), std::find(shape.tried.begin(), shape.tried.end(), 0.0)};
}

Candidate& add_variant(std::vector<Candidate>& all, const Candidate& candidate) {
  Candidate& variant = all.emplace_back(candidate);
  variant.is_variant = true;
  return variant;
}

/// Other shapes of the candidate.
std::vector<Candidate> variants_of(const Candidate& candidate, const std::vector<double>& dates) {
  std::vector<Candidate> variants;
  if (candidate.effect.is_formula()) return variants;
  const EffectInfo& info = *effect_named(candidate.effect.id);
  for (std::size_t i = 0; i < info.parameter_count(); ++i) {
    const bool remembers = info.memory.of != Quantity::count && info.memory.parameter == i;
    if (!info.parameters[i].shape || remembers) continue;
    for (const double value : tried_values(info, info.parameters[i], dates)) {
      if (value == candidate.effect.parameters[i]) continue;
      add_variant(variants, candidate).effect.parameters[i] = value;
    }
  }
  for (std::size_t i = 0; i < info.scaling_count(); ++i)
    add_variant(variants, candidate).effect.scaling = info.scalings[i];
  return variants;
}

Candidate candidate_of(const ModelEffect& formula) {
  Candidate candidate;
  candidate.effect = formula;
  candidate.id = formula.id;
  candidate.title = fmt::format("formula {}", formula.formula);
  for (std::size_t i = 0; i < formula.parameter_names.size(); ++i) {
    candidate.effect.parameters[i] = 0.0;
    candidate.tested.push_back({i, formula.parameter_names[i], "", 0.0, {}});
  }
  return candidate;
}

/// Reason why a flight has no values of a variable of a formula; empty if all have some.
std::string missing_variable(const ModelEffect& effect, const FlightSet& flights) {
  const auto formula = Formula::parse(effect.formula, effect.parameter_names, nullptr);
  if (!formula) return "";
  for (const std::string& name : formula->variables()) {
    if (quantity_named(name) != Quantity::count) continue;
    for (std::string& problem : flights.partition().all_gather_flights<std::string>([&](std::size_t number) {
           const Flight& flight = flights[number];
           return flight.has(name) ? value_problem(flight, name)
                                   : fmt::format("{} has no variable {}", flight.path().string(), name);
         })) {
      if (!problem.empty()) return std::move(problem);
    }
  }
  return "";
}

bool is_of_laser(EffectLocation location) {
  return location == EffectLocation::beam_elevation || location == EffectLocation::beam_azimuth ||
         location == EffectLocation::beam_speed;
}

/// Whether an error at this location often occurs on both systems, because tubes and lines are built alike.
bool is_often_shared(EffectLocation location) {
  return location == EffectLocation::static_line || location == EffectLocation::total_line ||
         location == EffectLocation::pitot;
}

/// Whether an effect there can be one of the other system as well.
bool has_a_twin(EffectLocation location) {
  return location == EffectLocation::static_transducer || location == EffectLocation::dynamic_transducer ||
         location == EffectLocation::static_defect || is_often_shared(location);
}

/// Reason why an effect cannot be tested with a model; empty if it can. @param dates on which steps are tried
std::string why_not_testable(const EffectInfo& info, bool is_moist, const std::vector<double>& dates) {
  if (info.location == EffectLocation::ambient_temperature)
    return "not separable from temp-offset with the laser; the hydrostatic height determines it (pcor "
           "temperature)";
  if (info.constants == GasConstants::dry && is_moist) return "the model uses the constants of moist air";
  if (info.constants == GasConstants::moist && !is_moist) return "the model uses the constants of dry air";
  if (reads_date(info) && dates.empty()) return "it needs flights at two different times";
  return "";
}

/// Inserts after each candidate its variants: the same effect on both systems for tubes and
/// lines, and other times for the need.
void add_derived_ones(CandidateSet& set, bool two_systems) {
  std::vector<Candidate> all;
  for (const Candidate& candidate : set.candidates) {
    all.push_back(candidate);
    if (candidate.effect.is_formula()) continue;
    if (two_systems && is_often_shared(location_of(candidate.effect)))
      add_variant(all, candidate).is_shared = true;
    const EffectInfo& info = *effect_named(candidate.effect.id);
    if (info.memory.of == Quantity::count) continue;
    const ParameterInfo& over = info.parameters[info.memory.parameter];
    for (const double time : over.tried) {
      if (time == 0.0) break;
      Candidate& derived = add_variant(all, candidate);
      derived.memory = time;
      if (over.shape) derived.effect.parameters[info.memory.parameter] = time;
    }
  }
  set.candidates = std::move(all);
}

/// Whether two models are of the same system, with the same coefficients to fit.
bool is_same(const ModelDefinition& a, const ModelDefinition& b) {
  const auto ids = [](const ModelDefinition& file) {
    std::vector<std::string> all;
    for (const ModelEffect& effect : file.model.effects) all.push_back(effect.id);
    return all;
  };
  return a.model.name == b.model.name && a.variables == b.variables && ids(a) == ids(b) &&
         free_parameters(a) == free_parameters(b);
}

/// System that a model corrects, named by its pressures: "PSFRD+QCFR". Two laws of one pair belong to one
/// system.
std::string system_of(const ModelDefinition& model) {
  return model.variables.at(Quantity::static_pressure) + "+" + model.variables.at(Quantity::dynamic_pressure);
}

std::vector<BaseCoefficient> base_of(const ModelDefinition& model) {
  const std::vector<std::size_t> free = free_parameters(model);
  std::vector<BaseCoefficient> base;
  std::size_t number = 0;
  for (std::size_t e = 0; e < model.model.effects.size(); ++e) {
    const ModelEffect& effect = model.model.effects[e];
    const std::vector<std::string> names = parameter_names(effect);
    const EffectInfo* const info = effect.is_formula() ? nullptr : effect_named(effect.id);
    for (std::size_t p = 0; p < names.size(); ++p, ++number) {
      if (!std::binary_search(free.begin(), free.end(), number)) continue;
      base.push_back({effect.id + "." + names[p], parameter_unit(effect, p), effect.parameters[p],
                      model.bounds(e, p), false,
                      info == nullptr ? 0.0 : std::abs(info->parameters[p].typical)});
    }
  }
  return base;
}

void fix_all(ModelDefinition& model) {
  model.fits.resize(model.model.effects.size());
  for (std::size_t e = 0; e < model.fits.size(); ++e) {
    model.fits[e].resize(parameter_names(model.model.effects[e]).size());
    for (ParameterFit& fit : model.fits[e]) fit.fixed = true;
  }
}

/// Adds the effects that another system may have, in all their shapes, to its model and to the set.
/// @param chain of that model @param r number of its reference
void add_twins(CandidateSet& set, const References& references, Chain chain, std::size_t r,
               const std::string& system, const std::vector<double>& dates) {
  std::vector<ModelEffect>& effects = set.others[r]->model.effects;
  for (const EffectInfo& info : effect_info) {
    if (!has_a_twin(info.location) || has_effect(*references[r]->model(), info.id)) continue;
    Candidate usual = candidate_of(info);
    if (reads_date(info)) {
      if (dates.empty()) continue;
      usual.effect.parameters[1] = dates.front();
    }
    usual.system = system;
    usual.id = id_on_other_system(system, usual.effect.id);
    usual.title += system.empty() ? ", of the other system" : ", of the system " + system;
    std::vector<Candidate> shapes = variants_of(usual, dates);
    shapes.insert(shapes.begin(), std::move(usual));
    for (Candidate& twin : shapes) {
      BindingError error;
      std::optional<Chain> with = chain.with_effect(twin.effect, &error);
      if (!with) continue;
      chain = std::move(*with);
      auto position =
          std::find_if(set.candidates.begin(), set.candidates.end(), [&twin](const Candidate& each) {
            return each.id == twin.id && each.effect.parameters == twin.effect.parameters &&
                   each.effect.scaling == twin.effect.scaling;
          });
      if (position == set.candidates.end()) {
        twin.numbers_in_others.resize(references.size());
        position = set.candidates.insert(position, std::move(twin));
      }
      position->numbers_in_others[r] = effects.size();
      effects.push_back(position->effect);
    }
  }
}

/// Every effect of this system may also occur in the reference system. One residual of both determines only
/// the difference.
void add_those_of_the_references(CandidateSet& set, const References& references, const FlightSet& flights,
                                 const std::vector<double>& dates, bool trusted) {
  for (std::size_t r = 0; r < references.size(); ++r) {
    const ModelDefinition* const model = references[r]->model();
    std::optional<ModelDefinition>& other = set.others.emplace_back();
    set.references.push_back(references[r]);
    set.base_of_others.push_back(set.base.size());
    set.effects_of_others.push_back(model == nullptr ? 0 : model->model.effects.size());
    if (model == nullptr) continue;
    ModelDefinition law = *model;
    if (trusted) fix_all(law);
    const bool several = std::any_of(references.begin(), references.end(), [model](const auto& each) {
      return each->model() != nullptr && system_of(*each->model()) != system_of(*model);
    });
    const std::string system = several ? system_of(*model) : "";
    const auto same = std::find_if(references.begin(), references.end(), [model](const auto& each) {
      return each->model() != nullptr && is_same(*each->model(), *model);
    });
    const auto first = static_cast<std::size_t>(same - references.begin());
    if (first < r) {
      set.base_of_others.back() = set.base_of_others[first];
    } else {
      for (BaseCoefficient& coefficient : base_of(law)) {
        coefficient.name = id_on_other_system(system, coefficient.name);
        coefficient.of_reference = true;
        set.base.push_back(std::move(coefficient));
      }
    }
    other = std::move(law);
    name_usual_variables(*other, flights);
    Chain chain = chain_of(other->model, roles_of(*other, false));
    if (!trusted) add_twins(set, references, std::move(chain), r, system, dates);
    set.references.back() = references[r]->with_model(*other);
  }
}

}  // namespace

CandidateSet find_candidates(const ModelDefinition& model, const std::vector<ModelEffect>& formulas,
                             const FlightSet& flights, const References& references,
                             const std::vector<double>& dates, bool trust_reference) {
  CandidateSet set;
  set.extended = model;
  name_usual_variables(set.extended, flights);
  const bool with_laser =
      std::any_of(references.begin(), references.end(), [](const auto& each) { return each->reads_laser(); });
  std::optional<Chain> chain = chain_of(set.extended.model, roles_of(set.extended, with_laser));
  BindingError error;
  const auto add = [&](Candidate candidate) {
    std::optional<Chain> with = chain->with_effect(candidate.effect, &error);
    if (!with) return false;
    chain = std::move(with);
    candidate.number = set.extended.model.effects.size();
    set.extended.model.effects.push_back(candidate.effect);
    set.candidates.push_back(std::move(candidate));
    return true;
  };
  // @param why the candidate cannot be tested; empty if only the chain may refuse it
  const auto consider = [&](const Candidate& candidate, const std::string& why) {
    if (why.empty() && add(candidate)) {
      for (Candidate& variant : variants_of(candidate, dates)) add(std::move(variant));
    } else {
      set.not_testable.push_back({candidate.effect.id, candidate.title, why.empty() ? error.what : why});
    }
  };
  for (const ModelEffect& formula : formulas) {
    if (has_effect(set.extended, formula.id)) continue;
    const Candidate candidate = candidate_of(formula);
    consider(candidate,
             candidate.tested.empty() ? "it has no coefficient to fit" : missing_variable(formula, flights));
  }
  for (const EffectInfo& info : effect_info) {
    if (has_effect(model, info.id)) continue;
    if (trust_reference && is_of_laser(info.location)) continue;
    Candidate candidate = candidate_of(info);
    if (reads_date(info) && !dates.empty()) candidate.effect.parameters[1] = dates.front();
    consider(candidate, why_not_testable(info, model.model.moist, dates));
  }
  set.base = base_of(model);
  const bool two_systems = std::any_of(references.begin(), references.end(),
                                       [](const auto& each) { return each->model() != nullptr; });
  add_derived_ones(set, two_systems);
  add_those_of_the_references(set, references, flights, dates, trust_reference);
  return set;
}

}  // namespace pcor::internal

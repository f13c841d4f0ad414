#include "diagnose/candidates.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <set>

#include <pcor/effects/catalogue.hpp>
#include <pcor/realtime/chain.hpp>
#include <pcor/units/units.hpp>
#include <pcor/words/error.hpp>
#include "roles/recorded_series.hpp"

namespace pcor::internal {
namespace {

bool has_effect(const ModelFile& model, std::string_view id) {
  const std::vector<ModelEffect>& effects = model.model.effects;
  return std::any_of(effects.begin(), effects.end(), [id](const ModelEffect& e) { return e.id == id; });
}

/// Whether every flight records `variable` in a unit that fits the role.
bool is_recorded(const std::vector<const Flight*>& flights, const std::string& variable, Quantity role) {
  return std::all_of(flights.begin(), flights.end(), [&](const Flight* flight) {
    return has_values(*flight, variable, std::string(facts_of(role).unit));
  });
}

/// Names the usual variables of the roles that the model leaves open. The flow angles stay as they are where
/// the model computes them from the radome.
void name_usual_variables(ModelFile& file, const std::vector<const Flight*>& flights) {
  for (std::size_t i = 0; i < role_count; ++i) {
    const auto role = static_cast<Quantity>(i);
    if (file.variables.count(role) != 0) continue;
    if (role == Quantity::attack && file.model.attack_radome.is_calibrated()) continue;
    if (role == Quantity::sideslip && file.model.sideslip_radome.is_calibrated()) continue;
    for (const std::string& variable : usual_variables(role)) {
      if (!is_recorded(flights, variable, role)) continue;
      file.variables[role] = variable;
      break;
    }
  }
}

Candidate candidate_of(const EffectFacts& facts) {
  Candidate candidate;
  candidate.effect = neutral_effect(facts.id);
  candidate.title = std::string(facts.title);
  for (std::size_t i = 0; i < facts.parameter_count(); ++i) {
    const ParameterFacts& parameter = facts.parameters[i];
    if (parameter.shape) continue;
    candidate.tested.push_back({i,
                                std::string(parameter.name),
                                std::string(parameter.unit),
                                parameter.typical,
                                {parameter.lower - parameter.neutral, parameter.upper - parameter.neutral}});
  }
  return candidate;
}

/// The begins of the flights after the first, in the unit of the role date.
std::vector<double> later_begins(const std::vector<const Flight*>& flights) {
  const UnitConversion to_date =
      UnitConversion::between("seconds since 1970-01-01", std::string(facts_of(Quantity::date).unit), {});
  std::set<double> begins;
  for (const Flight* flight : flights) begins.insert(to_date(flight->time().first));
  if (!begins.empty()) begins.erase(begins.begin());
  return {begins.begin(), begins.end()};
}

bool reads_date(const EffectFacts& facts) { return facts.needs[0] == Quantity::date; }

/// What a shape parameter is tried at: what its facts say, a date at the begins of flights.
std::vector<double> tried_values(const EffectFacts& facts, const ParameterFacts& shape,
                                 const std::vector<const Flight*>& flights) {
  if (reads_date(facts)) return later_begins(flights);
  return {shape.tried.begin(), std::find(shape.tried.begin(), shape.tried.end(), 0.0)};
}

/// The candidate in other shapes.
std::vector<Candidate> variants_of(const Candidate& candidate, const std::vector<const Flight*>& flights) {
  std::vector<Candidate> variants;
  if (candidate.effect.is_formula()) return variants;
  const EffectFacts& facts = effect_facts[effect_named(candidate.effect.id)];
  for (std::size_t i = 0; i < facts.parameter_count(); ++i) {
    if (!facts.parameters[i].shape) continue;
    for (const double value : tried_values(facts, facts.parameters[i], flights)) {
      if (value == candidate.effect.parameters[i]) continue;
      Candidate& variant = variants.emplace_back(candidate);
      variant.effect.parameters[i] = value;
      variant.is_variant = true;
    }
  }
  for (std::size_t i = 0; i < facts.scaling_count(); ++i) {
    Candidate& variant = variants.emplace_back(candidate);
    variant.effect.scaling = facts.scalings[i];
    variant.is_variant = true;
  }
  return variants;
}

Candidate candidate_of(const ModelEffect& formula) {
  Candidate candidate;
  candidate.effect = formula;
  candidate.title = fmt::format("formula {}", formula.formula);
  for (std::size_t i = 0; i < formula.parameter_names.size(); ++i) {
    candidate.effect.parameters[i] = 0.0;
    candidate.tested.push_back({i, formula.parameter_names[i], "", 0.0, {}});
  }
  return candidate;
}

/// Of a formula: the variable that some flight lacks; empty where there is none.
std::string missing_variable(const ModelEffect& effect, const std::vector<const Flight*>& flights) {
  const auto formula = Formula::parse(effect.formula, effect.parameter_names, nullptr);
  if (!formula) return "";
  for (const std::string& name : formula->variables()) {
    if (quantity_named(name) != Quantity::count) continue;
    for (const Flight* flight : flights) {
      if (!flight->has(name)) return fmt::format("{} has no variable {}", flight->path().string(), name);
      try {
        flight->require_values(name);
      } catch (const Error& error) {
        if (error.code() == Error::Code::file) throw;
        return error.what();
      }
    }
  }
  return "";
}

}  // namespace

CandidateSet find_candidates(const ModelFile& model, const std::vector<ModelEffect>& formulas,
                             const std::vector<const Flight*>& flights, const Reference& reference) {
  CandidateSet set;
  set.extended = model;
  name_usual_variables(set.extended, flights);
  std::vector<Quantity> roles = set.extended.roles();
  if (!reference.reads_laser())
    roles.erase(std::remove(roles.begin(), roles.end(), Quantity::lams_airspeed), roles.end());
  BindingError error;
  std::optional<Chain> chain = Chain::build(model.model, roles, &error);
  if (!chain)
    throw Error(Error::Code::model, fmt::format("model '{}': {}", model.model.name, error.message()));
  const auto add = [&](Candidate candidate) {
    std::optional<Chain> with = chain->with_effect(candidate.effect, &error);
    if (!with) return false;
    chain = std::move(with);
    candidate.number = set.extended.model.effects.size();
    set.extended.model.effects.push_back(candidate.effect);
    set.candidates.push_back(std::move(candidate));
    return true;
  };
  const auto consider = [&](const Candidate& candidate) {
    if (add(candidate)) {
      for (Candidate& variant : variants_of(candidate, flights)) add(std::move(variant));
    } else {
      set.not_testable.push_back({candidate.effect.id, candidate.title, error.what});
    }
  };
  for (const ModelEffect& formula : formulas) {
    if (has_effect(set.extended, formula.id)) continue;
    Candidate candidate = candidate_of(formula);
    if (candidate.tested.empty()) {
      set.not_testable.push_back({formula.id, candidate.title, "it has no coefficient to fit"});
      continue;
    }
    if (std::string why = missing_variable(formula, flights); !why.empty()) {
      set.not_testable.push_back({formula.id, candidate.title, std::move(why)});
      continue;
    }
    consider(candidate);
  }
  for (const EffectFacts& facts : effect_facts) {
    if (has_effect(model, facts.id)) continue;
    if (facts.where == Where::ambient_temperature) {
      set.not_testable.push_back(
          {std::string(facts.id), std::string(facts.title),
           "to the laser it is as temp-offset; the hydrostatic height finds it (pcor temperature)"});
      continue;
    }
    if (facts.constants == GasConstants::dry && model.model.moist) {
      set.not_testable.push_back(
          {std::string(facts.id), std::string(facts.title), "the model uses the constants of moist air"});
      continue;
    }
    if (facts.constants == GasConstants::moist && !model.model.moist) {
      set.not_testable.push_back(
          {std::string(facts.id), std::string(facts.title), "the model uses the constants of dry air"});
      continue;
    }
    Candidate candidate = candidate_of(facts);
    if (reads_date(facts)) {
      const std::vector<double> begins = later_begins(flights);
      if (begins.empty()) {
        set.not_testable.push_back({candidate.effect.id, candidate.title, "it needs flights at two times"});
        continue;
      }
      candidate.effect.parameters[1] = begins.front();
    }
    consider(candidate);
  }
  return set;
}

}  // namespace pcor::internal

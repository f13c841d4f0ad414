#include <pcor/roles/model_candidates.hpp>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cstddef>
#include <tuple>

#include <pcor/base/error.hpp>
#include <pcor/base/utc.hpp>
#include <pcor/roles/resolve_variables.hpp>
#include "roles/model_inputs.hpp"
#include "roles/usual_variables.hpp"

namespace pcor {

using namespace internal;

namespace {

std::string day_of(const Flight& flight) { return utc_text(flight.time().first, "%Y-%m-%d"); }

/// Index of the model's pressures among the measured pairs of its aircraft.
std::size_t place_of_pressures(const ModelDefinition& model, const VariableNaming& naming) {
  const auto found =
      std::find_if(naming.measured.begin(), naming.measured.end(), [&](const PressurePair& pair) {
        return pair.static_pressure == model.variable_of(Quantity::static_pressure) &&
               pair.dynamic_pressure == model.variable_of(Quantity::dynamic_pressure);
      });
  return static_cast<std::size_t>(found - naming.measured.begin());
}

/// The candidate with the smallest rank is first.
auto rank_of(const ModelCandidate& law, const VariableNaming& naming) {
  return std::make_tuple(!law.fits(), -static_cast<int>(law.lacks.empty()) - static_cast<int>(law.is_in_time),
                         !law.model.law.operational, !doubt_of_dates(law.model.law).empty(),
                         place_of_pressures(law.model, naming));
}

/// Reason why a model cannot correct a flight that has its variables; empty if it can.
std::string why_not(const Flight& flight, const ModelDefinition& model) {
  try {
    Notes notes;
    const ModelDefinition whole = resolve_variables(model, flight, notes);
    const std::vector<Quantity> roles =
        roles_of(whole, flight.has(whole.variable_of(Quantity::lams_airspeed)));
    model_inputs(flight, whole, chain_of(whole.model, roles), roles, notes);
    return "";
  } catch (const Error& error) {
    return error.what();
  }
}

ModelCandidate law_of_model(const std::filesystem::path& path, ModelDefinition model, const Flight& flight) {
  ModelCandidate law{path, std::move(model)};
  for (const auto& [role, variable] : law.model.variables) {
    // A laser may be off.
    if (role != Quantity::lams_airspeed && !flight.has(variable)) law.lacks.push_back(variable);
  }
  law.is_in_time = law.model.law.is_valid_on(day_of(flight));
  if (law.fits()) law.why_not = why_not(flight, law.model);
  return law;
}

/// Why none fits.
std::string reasons_of(const std::vector<ModelCandidate>& laws) {
  std::vector<std::string> reasons;
  for (const ModelCandidate& law : laws) {
    const std::string name = law.path.stem().string();
    reasons.push_back(!law.is_in_time      ? fmt::format("{} is valid for other dates", name)
                      : !law.lacks.empty() ? fmt::format("{} needs {}", name, fmt::join(law.lacks, " and "))
                                           : fmt::format("{}: {}", name, law.why_not));
  }
  return fmt::format("{}", fmt::join(reasons, "; "));
}

}  // namespace

std::string doubt_of_dates(const LawInfo& law) {
  const bool begins = !law.valid_from.empty();
  const bool ends = !law.valid_to.empty();
  if (law.operational || (begins && ends)) return "";
  if (begins) return "end not stated";
  return (ends ? "beginning not stated" : "dates not stated") +
         (law.note.empty() ? "" : "; note: " + law.note);
}

std::string applicable_text(const std::vector<ModelCandidate>& laws) {
  std::vector<std::string> names;
  for (const ModelCandidate& law : laws) {
    if (!law.fits()) continue;
    const std::string doubt = doubt_of_dates(law.model.law);
    names.push_back(law.path.stem().string() + (doubt.empty() ? "" : " (" + doubt + ")"));
  }
  return fmt::format("{}", fmt::join(names, ", "));
}

std::vector<ModelCandidate> model_candidates(const Flight& flight,
                                             const std::vector<std::filesystem::path>& models, Notes& notes) {
  const VariableNaming& naming = naming_of(flight);
  std::vector<ModelCandidate> laws;
  for (const std::filesystem::path& path : models) {
    try {
      ModelDefinition model = read_model(path);
      if (is_of_aircraft(model, flight)) laws.push_back(law_of_model(path, std::move(model), flight));
    } catch (const Error& error) {
      notes.emplace_back(error.what());
    }
  }
  std::stable_sort(laws.begin(), laws.end(), [&naming](const ModelCandidate& a, const ModelCandidate& b) {
    return rank_of(a, naming) < rank_of(b, naming);
  });
  return laws;
}

ModelCandidate model_candidate(const Flight& flight, const std::vector<std::filesystem::path>& models,
                               Notes& notes) {
  Notes unread;
  std::vector<ModelCandidate> laws = model_candidates(flight, models, unread);
  if (!unread.empty()) throw Error(Error::Code::definition, unread.front().text);
  if (flight.aircraft().empty())
    throw Error(Error::Code::model, fmt::format("{}: the aircraft is not stated; name the model with --model",
                                                flight.path().string()));
  const std::string who =
      fmt::format("{}, '{}' of {}", flight.path().string(), flight.aircraft(), day_of(flight));
  if (laws.empty()) {
    throw Error(
        Error::Code::model,
        fmt::format("{}: the {} models are for other aircraft; name one with --model", who, models.size()));
  }
  const ModelCandidate& first = laws.front();
  if (!first.fits())
    throw Error(Error::Code::model,
                fmt::format("{}: no model fits it: {}; name one with --model", who, reasons_of(laws)));
  for (const ModelCandidate& law : laws) {
    if (!first.model.law.operational && law.model.law.operational && law.is_in_time)
      notes.push_back(
          fmt::format("{} is now processed with another model, which does not apply to this flight: {}",
                      flight.aircraft(), reasons_of({law})));
  }
  const VariableNaming& naming = naming_of(flight);
  laws.erase(
      std::find_if(laws.begin(), laws.end(),
                   [&](const ModelCandidate& law) { return rank_of(law, naming) != rank_of(first, naming); }),
      laws.end());
  if (laws.size() > 1) {
    std::vector<std::string> names;
    for (const ModelCandidate& law : laws) names.push_back(law.path.stem().string());
    throw Error(Error::Code::model,
                fmt::format("{}: {} match equally well; name one with --model, or set in_processing = true "
                            "in the [law] of the model used operationally",
                            who, fmt::join(names, ", ")));
  }
  return laws.front();
}

}  // namespace pcor

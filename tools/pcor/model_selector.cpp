#include "model_selector.hpp"

#include <fmt/format.h>

#include <pcor/base/error.hpp>
#include <pcor/campaign/resolve_model.hpp>
#include <pcor/roles/model_candidates.hpp>
#include <pcor/roles/resolve_variables.hpp>

namespace pcor::tool {

ModelDefinition read_model_for(const std::filesystem::path& model, const FlightSet& flights,
                               const CommonOptions& options) {
  const ModelDefinition file = read_model(model);
  const bool is_complete = file.roles_from.empty() && file.variables.count(Quantity::static_pressure) != 0 &&
                           !names_pressures_alone(file);
  if (flights.empty() || is_complete) return file;
  Notes notes;
  ModelDefinition whole = resolve_model(file, flights, notes);
  tell_choices(notes, options.quiet);
  return whole;
}

ModelDefinition model_for_flight(const std::vector<std::filesystem::path>& models,
                                 const std::filesystem::path& flight, const CommonOptions& options) {
  const Flight opened(flight);
  Notes notes;
  const ModelCandidate law = model_candidate(opened, models, notes);
  notes.insert(notes.begin(), fmt::format("corrected by {} ({})", law.model.model.name, law.path.string()));
  ModelDefinition model = resolve_variables(law.model, opened, notes);
  for (Note& note : notes) note.text = fmt::format("{}: {}", flight.filename().string(), note.text);
  tell_choices(notes, options.quiet);
  return model;
}

}  // namespace pcor::tool

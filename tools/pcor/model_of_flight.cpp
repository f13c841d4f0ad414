#include "model_of_flight.hpp"

#include <fmt/format.h>

#include <utility>

#include <pcor/campaign/model_for_flights.hpp>
#include <pcor/roles/laws_of_flight.hpp>
#include <pcor/roles/with_roles.hpp>
#include <pcor/words/error.hpp>

#include "choices.hpp"

namespace pcor::tool {

ModelFile read_model_for(const std::filesystem::path& model, const FlightSet& flights,
                         const CommonOptions& options) {
  const ModelFile file = read_model(model);
  const bool is_complete = file.roles_from.empty() && file.variables.count(Quantity::static_pressure) != 0 &&
                           !names_pressures_alone(file);
  if (flights.empty() || is_complete) return file;
  std::vector<std::string> notes;
  ModelFile whole = model_for_flights(file, flights, notes);
  tell_choices(notes, options.quiet);
  return whole;
}

ModelFile model_for_flight(const std::vector<std::filesystem::path>& models,
                           const std::filesystem::path& flight, const CommonOptions& options) {
  const Flight opened(flight);
  std::vector<std::string> notes;
  const LawOfFlight law = law_of_flight(opened, models, notes);
  notes.insert(notes.begin(), fmt::format("corrected by {} ({})", law.model.model.name, law.path.string()));
  ModelFile model = with_roles(law.model, opened, notes);
  for (std::string& note : notes) note = fmt::format("{}: {}", flight.filename().string(), note);
  tell_choices(notes, options.quiet);
  return model;
}

}  // namespace pcor::tool

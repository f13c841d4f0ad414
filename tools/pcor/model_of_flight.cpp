#include "model_of_flight.hpp"

#include <fmt/format.h>

#include <optional>
#include <utility>

#include <pcor/roles/laws_of_flight.hpp>
#include <pcor/roles/with_roles.hpp>
#include <pcor/words/error.hpp>

#include "choices.hpp"

namespace pcor::tool {
namespace {

/// A model that names no pressure, completed by the first flight that can be read and completes it. All
/// others have to choose the same variables: a result must not depend on which flights stand beside.
ModelFile completed(const ModelFile& open, const std::vector<std::filesystem::path>& flights,
                    std::vector<std::string>& notes) {
  std::optional<ModelFile> model;
  std::optional<Error> first_error;
  std::filesystem::path chosen_by;
  for (const std::filesystem::path& path : flights) {
    ModelFile own;
    std::vector<std::string> own_notes;
    try {
      own = with_roles(open, Flight(path), own_notes);
    } catch (const Error& error) {
      // Whether a flight may be left out is for the work to say.
      if (!first_error) first_error = error;
      continue;
    }
    if (!model) {
      model = std::move(own);
      notes = std::move(own_notes);
      chosen_by = path;
    } else if (own.variables != model->variables || own.model.moist != model->model.moist) {
      throw Error(fmt::format(
          "{} and {} record different variables, so that one model for both would be of the first; "
          "give them apart, or name the variables in the [variables] of the model",
          chosen_by.string(), path.string()));
    }
  }
  if (!model) throw *first_error;
  return *model;
}

}  // namespace

ModelFile read_model_for(const std::filesystem::path& model,
                         const std::vector<std::filesystem::path>& flights, const CommonOptions& options) {
  const ModelFile file = read_model(model);
  if (flights.empty() || (file.roles_from.empty() && file.variables.count(Quantity::static_pressure) != 0))
    return file;
  std::vector<std::string> notes;
  ModelFile whole = completed(file, flights, notes);
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

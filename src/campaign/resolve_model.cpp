#include <pcor/campaign/resolve_model.hpp>

#include <fmt/format.h>
#include <cereal/types/map.hpp>

#include <algorithm>
#include <map>
#include <optional>
#include <utility>

#include <pcor/base/error.hpp>
#include <pcor/flight/flight.hpp>
#include <pcor/roles/resolve_variables.hpp>
#include "parallel/flight_partition.hpp"

namespace pcor {

using namespace internal;

namespace {

/// Variables that a flight selects for a model, and whether the model becomes moist; none if the flight does
/// not resolve it.
using Choice = std::optional<std::pair<std::map<Quantity, std::string>, bool>>;

}  // namespace

ModelDefinition resolve_model(const ModelDefinition& open, const FlightSet& flights, Notes& notes) {
  const auto choices = flights.partition().all_gather_flights<Choice>([&](std::size_t number) {
    try {
      Notes unsaid;
      const ModelDefinition resolved = resolve_variables(open, flights[number], unsaid);
      return Choice(std::in_place, resolved.variables, resolved.model.moist);
    } catch (const Error&) {
      // The caller decides whether a flight may be skipped.
      return Choice{};
    }
  });
  const auto first =
      std::find_if(choices.begin(), choices.end(), [](const Choice& choice) { return choice.has_value(); });
  const auto number_of = [&](auto choice) { return static_cast<std::size_t>(choice - choices.begin()); };
  for (auto other = first; other != choices.end(); ++other) {
    if (*other && *other != *first) {
      throw Error(
          Error::Code::variable,
          fmt::format("{} and {} need different variables; set [variables] in the model or process the "
                      "flights separately",
                      flights.path(number_of(first)).string(), flights.path(number_of(other)).string()));
    }
  }
  // All ranks read the names, but not the samples, of that flight.
  return resolve_variables(open, flights[first == choices.end() ? 0 : number_of(first)], notes);
}

}  // namespace pcor

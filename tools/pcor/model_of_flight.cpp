#include "model_of_flight.hpp"

#include <fmt/format.h>

#include <cstdio>

#include <pcor/roles/with_roles.hpp>

namespace pcor::tool {

ModelFile read_model_for(const std::filesystem::path& model,
                         const std::vector<std::filesystem::path>& flights, const CommonOptions& options) {
  ModelFile file = read_model(model);
  if (file.variables.count(Quantity::static_pressure) != 0 || flights.empty()) return file;
  std::vector<std::string> notes;
  file = with_roles(file, Flight(flights.front()), notes);
  if (!options.quiet) {
    for (const std::string& note : notes) fmt::print(stderr, "{}\n", note);
  }
  return file;
}

}  // namespace pcor::tool

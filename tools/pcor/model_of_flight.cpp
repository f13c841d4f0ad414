#include "model_of_flight.hpp"

#include <fmt/format.h>

#include <cstdio>

#include <pcor/roles/with_roles.hpp>
#include <pcor/words/error.hpp>

namespace pcor::tool {
namespace {

/// The first flight that can be read; of none the error of the last.
Flight first_readable(const std::vector<std::filesystem::path>& flights) {
  for (std::size_t i = 0; i + 1 < flights.size(); ++i) {
    try {
      return Flight(flights[i]);
    } catch (const Error&) {
      continue;  // which of them may be left out is for the work to say
    }
  }
  return Flight(flights.back());
}

}  // namespace

ModelFile read_model_for(const std::filesystem::path& model,
                         const std::vector<std::filesystem::path>& flights, const CommonOptions& options) {
  ModelFile file = read_model(model);
  if (file.variables.count(Quantity::static_pressure) != 0 || flights.empty()) return file;
  std::vector<std::string> notes;
  file = with_roles(file, first_readable(flights), notes);
  if (!options.quiet) {
    for (const std::string& note : notes) fmt::print(stderr, "{}\n", note);
  }
  return file;
}

}  // namespace pcor::tool

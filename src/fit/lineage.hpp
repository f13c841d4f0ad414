#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <pcor/laws/model_file.hpp>

namespace pcor::internal {

/// What a flight is called: its project, number and date; the name of its file where it does not say.
/// @throws Error if it cannot be read
std::string flight_text(const std::filesystem::path& flight);

/// Several flights in a few words: "GOTEX rf06 2004-02-18 and 2 more".
/// @param first of them, as `flight_text` has it @param count how many they are
std::string flights_text(const std::string& first, std::size_t count);
std::string flights_text(const std::vector<std::filesystem::path>& flights);

/// The name that a model had before it was fitted.
std::string unfitted_name(const ModelFile& model);

/// Gives a model that was made from another a name of its own, "NAME, fitted to GOTEX rf06 2004-02-18", and
/// has its provenance list, as `before`, the models that it came from, the oldest first: the name of each,
/// when it was made and its source, as far as it says. Names do not grow with the number of fits.
/// @param how "fitted to" or "improved on"
void descend(ModelFile& made, const ModelFile& from, const std::string& how, const std::string& flights);

}  // namespace pcor::internal

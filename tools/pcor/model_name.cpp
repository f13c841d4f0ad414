#include "model_name.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <map>
#include <set>
#include <sstream>
#include <string_view>
#include <system_error>
#include <utility>

#include <pcor/base/error.hpp>
#include <pcor/base/shell_quote.hpp>
#include <pcor/base/suggest.hpp>

namespace pcor::tool {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view model_ending = ".toml";

/// Name that the user gave, by the file that `model_file` found.
std::map<std::string, std::string> name_of_file;

/// "static:" and the model of a reference, or an empty kind.
std::pair<std::string, std::string> kind_and_model(const std::string& reference) {
  for (const std::string kind : {"static:", "total:"}) {
    if (reference.compare(0, kind.size(), kind) == 0) return {kind, reference.substr(kind.size())};
  }
  return {"", reference};
}

std::string as_given(const std::string& file) {
  const auto found = name_of_file.find(file);
  return found == name_of_file.end() ? file : found->second;
}

bool ends_with(std::string_view text, std::string_view end) {
  return text.size() >= end.size() && text.substr(text.size() - end.size()) == end;
}

/// Folders of the user first, then folders of the program: relative to its installation, in its source, and
/// at the configured installation path.
std::vector<fs::path> model_folders() {
  std::vector<fs::path> folders;
  if (const char* const user_folders = std::getenv("PCOR_MODELS")) {
    std::istringstream list(user_folders);
    for (std::string folder; std::getline(list, folder, ':');) {
      if (!folder.empty()) folders.emplace_back(folder);
    }
  }
  std::error_code code;
  const fs::path program = fs::read_symlink("/proc/self/exe", code);
  if (!code) folders.push_back(program.parent_path() / PCOR_MODELS_FROM_PROGRAM);
  folders.emplace_back(PCOR_MODELS_IN_SOURCE);
  folders.emplace_back(PCOR_MODELS_INSTALLED);
  return folders;
}

/// Files in the order of their names; empty if the folder cannot be read.
std::vector<fs::path> files_in(const fs::path& folder) {
  std::vector<fs::path> files;
  std::error_code code;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, code)) {
    if (entry.path().extension() == model_ending) files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());
  return files;
}

/// @param kind "model" or "scenario" @param folders in which a file may have this name
std::string named_file(const std::string& given, const char* kind, const std::vector<fs::path>& folders,
                       const char* advice) {
  std::error_code code;
  if (given.empty() || fs::exists(given, code) || given.find('/') != std::string::npos ||
      ends_with(given, model_ending))
    return given;
  std::set<std::string> known;  // a name may occur in several folders
  for (const fs::path& folder : folders) {
    const fs::path file = folder / (given + std::string(model_ending));
    if (fs::is_regular_file(file, code)) {
      std::string path = fs::weakly_canonical(file, code).string();
      name_of_file[path] = given;
      return path;
    }
    for (const fs::path& other : files_in(folder)) known.insert(other.stem().string());
  }
  const std::string meant = did_you_mean(given, {known.begin(), known.end()});
  throw Error(Error::Code::file, fmt::format("there is no {0} file or {0} named '{1}'; {2}", kind, given,
                                             meant.empty() ? advice : meant));
}

}  // namespace

std::string model_file(const std::string& given) {
  return named_file(given, "model", model_folders(), "name a file, or a model in a folder of PCOR_MODELS");
}

std::string scenario_file(const std::string& given) {
  std::vector<fs::path> folders = model_folders();
  for (fs::path& folder : folders) folder.replace_filename("scenarios");
  return named_file(given, "scenario", folders, "give the path of a scenario");
}

std::vector<fs::path> named_models() {
  std::vector<fs::path> models;
  std::set<std::string> known;
  for (const fs::path& folder : model_folders()) {
    for (const fs::path& file : files_in(folder)) {
      if (known.insert(file.stem().string()).second) models.push_back(file);
    }
  }
  return models;
}

std::vector<fs::path> models_in(const fs::path& folder) {
  if (fs::is_regular_file(folder))
    throw Error(Error::Code::usage,
                fmt::format("'{}' is a file; give a model with --model", folder.string()));
  if (!fs::is_directory(folder))
    throw Error(Error::Code::file,
                fmt::format("there is no folder '{}'; check the path of --models", folder.string()));
  std::vector<fs::path> models = files_in(folder);
  if (models.empty()) {
    throw Error(Error::Code::file,
                fmt::format("there is no model in '{}'; name a folder with files that end in {}",
                            folder.string(), model_ending));
  }
  return models;
}

std::string reference_with_model_file(const std::string& given) {
  const auto [kind, model] = kind_and_model(given);
  const bool is_pair_of_variables = model.find('+') != std::string::npos;
  return kind.empty() || is_pair_of_variables ? given : kind + model_file(model);
}

std::string model_argument(const std::string& file) { return shell_path(as_given(file)); }

std::string reference_argument(const std::string& reference) {
  const auto [kind, model] = kind_and_model(reference);
  return shell_quote(kind + as_given(model));
}

void take_models_by_name(CLI::App& program) {
  using Find = std::string (*)(const std::string&);
  const std::pair<const char*, Find> options[] = {{"--model", model_file},
                                                  {"--second", model_file},
                                                  {"--candidates", model_file},
                                                  {"--reference", reference_with_model_file},
                                                  {"scenario", scenario_file}};
  for (CLI::App* const command : program.get_subcommands({})) {
    for (const auto& [name, find] : options) {
      const auto is_named = [name = name](const CLI::Option* option) { return option->check_name(name); };
      for (CLI::Option* const option : command->get_options(is_named)) {
        option->transform(CLI::Validator(
            [find = find](std::string& text) {
              text = find(text);
              return std::string();
            },
            ""));
      }
    }
  }
}

}  // namespace pcor::tool

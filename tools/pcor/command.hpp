#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <functional>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include <pcor/base/atomic_file.hpp>
#include <pcor/model_io/model_definition.hpp>
#include "text.hpp"

namespace pcor::tool {

/// How JSON results spell a time: the pattern for `utc_text`.
inline constexpr const char* iso_time = "%Y-%m-%dT%H:%M:%SZ";

/// The options that every sub-command has.
struct CommonOptions {
  std::string json{};  ///< where the machine-readable result goes, `-` for standard output; empty for nowhere
  std::string report{};   ///< where the self-contained HTML report goes; empty for nowhere
  std::string figures{};  ///< the folder for the pictures of the report; empty for none
  std::string figures_for = "page";
  bool quiet = false;  ///< no text for people
};

/// Adds an option that takes one value and may be given several times. It never takes a second word, so that
/// flights may stand behind it.
CLI::Option* add_list_option(CLI::App& command, const std::string& name, std::vector<std::string>& values,
                             const std::string& description);

/// Keeps an option under the name that it had: it works, is not shown in the help, and says on standard error
/// what it is called now.
void keep_old_name(CLI::Option& option, const std::string& name_now);

/// Ends the help of a sub-command with examples: command lines without the program, which work one after
/// another on the flights of the README.
void add_examples(CLI::App& command, const std::vector<std::string>& examples);

/// The line of a help from which on it has examples.
inline constexpr const char* examples_heading = "Examples:\n";

/// Adds the common options to a sub-command; the report only where the sub-command has one.
void add_common_options(CLI::App& command, CommonOptions& options, bool has_report = true);

/// True where text for people is wanted on standard output: it is not where a result goes there.
/// @param models where models are written
bool wants_text(const CommonOptions& options, const std::vector<std::string>& models = {});

/// Makes `-` a usage error of an option that names a file to write: no file is called so, and standard output
/// takes JSON and models alone.
CLI::Validator is_file_name();

/// Writes a model file, whole or not at all, or to standard output where `output` is `-`.
/// @param inputs files that are never written over @throws Error as `save_model`
void deliver(const ModelDefinition& model, const std::string& output,
             const std::vector<std::filesystem::path>& inputs);

/// The result as JSON, which the first member of a team writes. Made before the work, so that a place that
/// cannot be written stops it in time; the file appears whole or not at all.
class JsonResult {
 public:
  /// @throws Error if the place that the options name cannot be written.
  explicit JsonResult(const CommonOptions& options);

  /// Writes `result` where the options say, if anywhere, with what was chosen for models that leave their
  /// variables open, as "choices". NaN becomes null. @throws Error if it cannot be
  /// written.
  void write(nlohmann::ordered_json result);

 private:
  std::string place_;
  std::optional<AtomicFile> file_{};
};

/// Refuses outputs that are inputs, under whatever name, and two outputs in one place, be it standard output,
/// `-`. Empty names are no files.
/// @throws Error
void refuse_overwriting(const std::vector<std::filesystem::path>& outputs,
                        const std::vector<std::filesystem::path>& inputs);

/// Makes sure, before the work, that the first member of a team can write a file there. Empty names and `-`
/// are no files.
/// @throws Error if it cannot.
void require_writable(const std::filesystem::path& output);

/// A sub-command: adds itself to the program, and returns what to run when it was asked for.
using AddCommand = std::function<void()>(CLI::App& program);

}  // namespace pcor::tool

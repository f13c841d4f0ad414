#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include <pcor/base/atomic_file.hpp>
#include <pcor/model_io/model_definition.hpp>
#include <pcor/report/json.hpp>
#include "text.hpp"

namespace pcor::tool {

/// Common options of all sub-commands.
struct CommonOptions {
  std::string json{};  ///< destination of the machine-readable result, `-` for standard output; empty if not
                       ///< requested
  std::string report{};  ///< destination of the self-contained HTML report; empty if not requested
  bool quiet = false;    ///< no output for people
};

/// Adds an option that takes one value and may be repeated. It never takes a second word, so that flights may
/// follow.
CLI::Option* add_list_option(CLI::App& command, const std::string& name, std::vector<std::string>& values,
                             const std::string& description);

/// Keeps an option under its previous name: it works, is not shown in the help, and prints the new name on
/// standard error.
void add_deprecated_alias(CLI::Option& option, const std::string& name_now);

/// Adds examples to the end of the help of a sub-command: command lines without the program, which work one
/// after another on the flights of the README.
void add_examples(CLI::App& command, const std::vector<std::string>& examples);

/// Heading of the examples in a help text.
inline constexpr const char* examples_heading = "Examples:\n";

/// Result as the program writes it: with the automatic choices of variables and models.
template <class Result>
struct WithChoices {
  const Result& result;
  const std::vector<std::string>& choices;
};

template <class Result, class Field>
void describe(const WithChoices<Result>& self, Field& field) {
  describe(self.result, field);
  if (field.has(!self.choices.empty()))
    field("choices", self.choices, "variables and models that the program selected, and skipped flights");
}

/// Keys of each type of result.
using KeyLists = std::vector<std::vector<JsonKey>>;

/// Adds the common options to a sub-command; the report only if the sub-command has one.
/// @param keys function that lists the keys of its JSON, for --json-keys
void add_common_options(CLI::App& command, CommonOptions& options, bool has_report, KeyLists (*keys)());

/// Adds the common options to a sub-command whose JSON is one of the types `Results`.
template <class... Results>
void add_common_options(CLI::App& command, CommonOptions& options, bool has_report = true) {
  add_common_options(command, options, has_report, [] {
    return KeyLists{json_keys(WithChoices<Results>{Results{}, {}})...};
  });
}

/// True if text for people is printed on standard output: not if a result is written there.
/// @param models outputs of models
bool wants_text(const CommonOptions& options, const std::vector<std::string>& models = {});

/// Validator that refuses `-` for an output file: standard output is supported for JSON and models only.
CLI::Validator is_file_name();

/// Writes a model file atomically, or to standard output if `output` is `-`.
/// @param inputs files that are never overwritten @throws Error as does `save_model`
void write_model_output(const ModelDefinition& model, const std::string& output,
                        const std::vector<std::filesystem::path>& inputs);

/// Adds `--force` to a sub-command that writes a model.
void add_force_option(CLI::App& command, bool& force);

/// Refuses a model that is worse than its input by its statistics. With `force` it is accepted, and its
/// provenance states the reason in `forced`.
///
/// @param worse reason, a sentence without its full stop; empty if the model is not worse
/// @throws Error with the reason, if `worse` is not empty and `force` is false
void require_improvement(const std::string& worse, bool force, ModelDefinition& model);

/// JSON result, written by the first rank. Constructed before the work, so that an unwritable destination
/// stops it early; the file is written atomically.
class JsonResult {
 public:
  /// @throws Error if the destination cannot be written.
  explicit JsonResult(const CommonOptions& options);

  /// Writes `result` to the destination, if any, with the automatic choices of variables and models as
  /// "choices". NaN becomes null. @throws Error if it cannot be written.
  template <class Result>
  void write(const Result& result) {
    if (!destination_.empty()) write_text(to_json(WithChoices<Result>{result, choices_of_this_run()}));
  }

 private:
  void write_text(const std::string& text);

  std::string destination_;
  std::optional<AtomicFile> file_{};
};

/// Refuses outputs that are inputs, under any name, two outputs with the same destination, including standard
/// output, `-`, and with --no-clobber existing files. Registers existing files for `print_written_files`.
/// Empty names are ignored.
/// @throws Error
void refuse_overwriting(const std::vector<std::filesystem::path>& outputs,
                        const std::vector<std::filesystem::path>& inputs);

/// Checks the outputs of a sub-command with a report before its work: `refuse_overwriting` and
/// `require_writable` for `outputs` and the common ones. @throws Error
void prepare_outputs(const CommonOptions& common, std::vector<std::filesystem::path> outputs,
                     const std::vector<std::filesystem::path>& inputs);

/// Checks before the work that the first rank can write the file. Empty names and `-` are ignored.
/// @throws Error if it cannot.
void require_writable(const std::filesystem::path& output);

/// Sub-command: adds itself to the program, and returns the function that runs it.
using AddCommand = std::function<void()>(CLI::App& program);

}  // namespace pcor::tool

#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <functional>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include <pcor/words/replacement_file.hpp>

namespace pcor::tool {

/// How JSON results spell a time: the pattern for `utc_text`.
inline constexpr const char* iso_time = "%Y-%m-%dT%H:%M:%SZ";

/// The options that every sub-command has.
struct CommonOptions {
  std::string json{};  ///< where the machine-readable result goes, `-` for standard output; empty for nowhere
  std::string report{};  ///< where the self-contained HTML report goes; empty for nowhere
  bool quiet = false;    ///< no text for people
};

/// Adds the common options to a sub-command; the report only where the sub-command has one.
void add_common_options(CLI::App& command, CommonOptions& options, bool has_report = true);

/// True where text for people is wanted on standard output.
bool wants_text(const CommonOptions& options);

/// The result as JSON. Made before the work, so that a place that cannot be written stops it in time; the
/// file appears whole or not at all.
class JsonResult {
 public:
  /// @throws Error if the place that the options name cannot be written.
  explicit JsonResult(const CommonOptions& options);

  /// Writes `result` where the options say, if anywhere. NaN becomes null. @throws Error if it cannot be
  /// written.
  void write(const nlohmann::ordered_json& result);

 private:
  std::string place_;
  std::optional<ReplacementFile> file_{};
};

/// A word of a command line as a shell takes it.
std::string quoted(const std::string& word);

/// Refuses outputs that are inputs, under whatever name, and two outputs in one place. Empty names and `-`
/// are no files.
/// @throws Error
void refuse_overwriting(const std::vector<std::filesystem::path>& outputs,
                        const std::vector<std::filesystem::path>& inputs);

/// Makes sure, before the work, that a file can be written there. Empty names and `-` are no files.
/// @throws Error if it cannot.
void require_writable(const std::filesystem::path& output);

/// A sub-command: adds itself to the program, and returns what to run when it was asked for.
using AddCommand = std::function<void()>(CLI::App& program);

}  // namespace pcor::tool

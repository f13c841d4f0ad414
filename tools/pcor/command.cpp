#include "command.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <set>

#include <pcor/base/error.hpp>
#include "communicator.hpp"
#include "report_origin.hpp"
#include "text.hpp"

namespace pcor::tool {
namespace {

namespace fs = std::filesystem;

constexpr const char* standard_output = "-";

bool keeps_existing = false;

bool is_file(const fs::path& path) { return !path.empty() && path != standard_output; }

/// True if two names refer to one file, existing or not.
bool same_place(const fs::path& a, const fs::path& b) {
  if (!is_file(a) || !is_file(b)) return false;
  std::error_code code;
  if (fs::equivalent(a, b, code)) return true;
  return fs::weakly_canonical(fs::absolute(a), code) == fs::weakly_canonical(fs::absolute(b), code);
}

/// Table of keys, each path once.
std::string key_table(const KeyLists& lists) {
  std::vector<JsonKey> keys{{"key", "type", "unit", "meaning"}};
  std::set<std::string> paths;
  std::size_t width = 0;
  for (const std::vector<JsonKey>& list : lists) {
    for (const JsonKey& key : list) {
      if (paths.insert(key.path).second) keys.push_back(key);
      width = std::max(width, key.path.size());
    }
  }
  std::string text;
  for (const JsonKey& key : keys)
    text += fmt::format("{:<{}}  {:<13} {:<24} {}\n", key.path, width, key.type, key.unit, key.meaning);
  return text + "\nA number that is unknown is null.";
}

}  // namespace

CLI::Option* add_list_option(CLI::App& command, const std::string& name, std::vector<std::string>& values,
                             const std::string& description) {
  return command.add_option(name, values, description + "; may be repeated")
      ->expected(1)
      ->allow_extra_args(false)
      ->take_all();
}

void add_deprecated_alias(CLI::Option& option, const std::string& name_now) {
  option.group("");  // hidden
  option.each([old = "--" + option.get_lnames().front(), name_now](const std::string&) {
    print_error(fmt::format("pcor: {} was renamed to {}; the old name is deprecated", old, name_now));
  });
}

void add_examples(CLI::App& command, const std::vector<std::string>& examples) {
  const std::string words = command.get_footer();
  command.footer([words, examples] {
    std::string text = words + "\n\n" + examples_heading;
    for (const std::string& example : examples) text += fmt::format("  {} {}\n", program(), example);
    return text;
  });
  command.footer("");
}

void add_common_options(CLI::App& command, CommonOptions& options, bool has_report, KeyLists (*keys)()) {
  command.add_option("--json", options.json, "write the result as JSON to FILE, - for stdout")
      ->type_name("FILE");
  command.add_flag_callback(
      "--json-keys", [keys] { throw CLI::CallForVersion(key_table(keys()), 0); },
      "print the keys of the JSON result, with type, unit and meaning");
  if (has_report) {
    command
        .add_option("--report", options.report, "write a self-contained report with pictures to FILE.html")
        ->check(is_file_name())
        ->type_name("FILE.html");
  }
  CLI::Option* const quiet = command.add_flag("--quiet", options.quiet, "print no text");
  command.add_flag_callback("--verbose", print_all_details, "print all details, and notes in full")
      ->excludes(quiet);
  command.add_flag_callback(
      "--no-clobber", [] { keeps_existing = true; }, "refuse to overwrite existing files");
  command.set_version_flag("--version", "pcor " PCOR_VERSION, "print the version of the program");
}

bool wants_text(const CommonOptions& options, const std::vector<std::string>& models) {
  return !options.quiet && options.json != standard_output &&
         std::find(models.begin(), models.end(), standard_output) == models.end();
}

CLI::Validator is_file_name() {
  const auto check = [](const std::string& name) -> std::string {
    return name == standard_output
               ? "standard output ('-') is supported for models and JSON only; name a file"
               : "";
  };
  return {check, ""};
}

void write_model_output(const ModelDefinition& model, const std::string& output,
                        const std::vector<fs::path>& inputs) {
  if (output != standard_output) {
    save_model(model, output, inputs);
    return;
  }
  fmt::print("{}", write_model(model));
}

void add_force_option(CLI::App& command, bool& force) {
  command.add_flag("--force", force,
                   "write the result even if the fit is worse than the input model; the file then states it");
}

void require_improvement(const std::string& worse, bool force, ModelDefinition& model) {
  // The verdict on an earlier step does not apply to this one.
  erase_entry(model.provenance, "forced");
  if (worse.empty()) return;
  if (!force)
    throw Error(Error::Code::fit, fmt::format("no model was written: {}; use --force to write it", worse));
  set_entry(model.provenance, "forced", worse);
}

JsonResult::JsonResult(const CommonOptions& options) : destination_(is_speaker() ? options.json : "") {
  if (is_file(destination_)) file_.emplace(destination_);
}

void JsonResult::write_text(const std::string& text) {
  if (!file_) {
    std::fwrite(text.data(), 1, text.size(), stdout);
    return;
  }
  file_->write(text);
}

void require_writable(const fs::path& output) {
  if (is_speaker() && is_file(output)) const AtomicFile probe(output);
}

void refuse_overwriting(const std::vector<fs::path>& outputs, const std::vector<fs::path>& inputs) {
  for (std::size_t i = 0; i < outputs.size(); ++i) {
    for (const fs::path& input : inputs) {
      if (same_place(outputs[i], input)) {
        throw Error(Error::Code::usage,
                    fmt::format("{} is also an input; choose another output", outputs[i].string()));
      }
    }
    for (std::size_t j = 0; j < i; ++j) {
      if (outputs[i] == standard_output && outputs[j] == standard_output)
        throw Error(Error::Code::usage,
                    "standard output ('-') is given twice; name a file for one of the results");
      if (same_place(outputs[i], outputs[j])) {
        throw Error(Error::Code::usage,
                    fmt::format("{} is given twice as an output; choose two names", outputs[i].string()));
      }
    }
    std::error_code code;
    if (!is_file(outputs[i]) || !fs::is_regular_file(outputs[i], code)) continue;
    if (keeps_existing)
      throw Error(Error::Code::usage,
                  fmt::format("{}: the file exists; choose another output or omit --no-clobber",
                              outputs[i].string()));
    remember_existing(outputs[i]);
  }
}

void prepare_outputs(const CommonOptions& common, std::vector<fs::path> outputs,
                     const std::vector<fs::path>& inputs) {
  outputs.insert(outputs.end(), {common.json, common.report});
  refuse_overwriting(outputs, inputs);
  for (const fs::path& output : outputs) require_writable(output);
}

}  // namespace pcor::tool

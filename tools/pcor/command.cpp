#include "command.hpp"

#include <fmt/format.h>

#include <cstdio>
#include <fstream>

#include <pcor/words/error.hpp>

namespace pcor::tool {
namespace {

namespace fs = std::filesystem;

constexpr const char* standard_output = "-";

bool is_file(const fs::path& path) { return !path.empty() && path != standard_output; }

/// True where the two names lead to one file, be it there or not.
bool same_place(const fs::path& a, const fs::path& b) {
  if (!is_file(a) || !is_file(b)) return false;
  std::error_code code;
  if (fs::equivalent(a, b, code)) return true;
  return fs::weakly_canonical(fs::absolute(a), code) == fs::weakly_canonical(fs::absolute(b), code);
}

}  // namespace

void add_common_options(CLI::App& command, CommonOptions& options, bool has_report) {
  command.add_option("--json", options.json, "write the result as JSON to FILE, - for standard output")
      ->type_name("FILE");
  if (has_report) {
    command
        .add_option("--report", options.report, "write a self-contained report with pictures to FILE.html")
        ->type_name("FILE.html");
  }
  command.add_flag("--quiet", options.quiet, "print no text");
}

bool wants_text(const CommonOptions& options) { return !options.quiet && options.json != standard_output; }

JsonResult::JsonResult(const CommonOptions& options) : place_(options.json) {
  if (is_file(place_)) file_.emplace(place_);
}

void JsonResult::write(const nlohmann::ordered_json& result) {
  if (place_.empty()) return;
  const std::string text = result.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) + "\n";
  if (!file_) {
    std::fwrite(text.data(), 1, text.size(), stdout);
    return;
  }
  std::ofstream stream(file_->path(), std::ios::binary);
  stream << text;
  stream.close();
  if (!stream) {
    throw Error(fmt::format("{}: cannot write the JSON result; check the space and the permissions", place_));
  }
  file_->commit();
}

std::string quoted(const std::string& word) {
  const bool plain =
      !word.empty() &&
      word.find_first_not_of(
          ""
          "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789_-+./:,=@%") == std::string::npos;
  if (plain) return word;
  std::string text = "'";
  for (const char letter : word) {
    if (letter == '\'') {
      text += "'\\''";
    } else {
      text += letter;
    }
  }
  return text + "'";
}

void require_writable(const fs::path& output) {
  if (is_file(output)) const ReplacementFile probe(output);
}

void refuse_overwriting(const std::vector<fs::path>& outputs, const std::vector<fs::path>& inputs) {
  for (std::size_t i = 0; i < outputs.size(); ++i) {
    for (const fs::path& input : inputs) {
      if (same_place(outputs[i], input)) {
        throw Error(fmt::format("{} is an input itself; choose another output", outputs[i].string()));
      }
    }
    for (std::size_t j = 0; j < i; ++j) {
      if (same_place(outputs[i], outputs[j])) {
        throw Error(fmt::format("{} is asked for twice as an output; choose two names", outputs[i].string()));
      }
    }
  }
}

}  // namespace pcor::tool

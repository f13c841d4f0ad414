#include "command.hpp"

#include <fmt/format.h>

#include <cstdio>
#include <fstream>

#include "pcor/offline/error.hpp"
#include "pcor/offline/replacement_file.hpp"

namespace pcor::tool {

void add_common_options(CLI::App& command, CommonOptions& options) {
  command.add_option("--json", options.json, "write the result as JSON to FILE, - for standard output")
      ->type_name("FILE");
  command.add_flag("--quiet", options.quiet, "print no text");
}

void write_json(const nlohmann::ordered_json& result, const CommonOptions& options) {
  if (options.json.empty()) return;
  const std::string text = result.dump(2) + "\n";
  if (options.json == "-") {
    std::fwrite(text.data(), 1, text.size(), stdout);
    if (std::fflush(stdout) != 0) throw Error("standard output: cannot write the JSON result");
    return;
  }
  ReplacementFile file(options.json);
  std::ofstream stream(file.path(), std::ios::binary);
  stream << text;
  stream.close();
  if (!stream) throw Error(fmt::format("{}: cannot write the JSON result: is the disk full?", options.json));
  file.commit();
}

bool wants_text(const CommonOptions& options) { return !options.quiet && options.json != "-"; }

}  // namespace pcor::tool

#include "words/text_file.hpp"

#include <fmt/format.h>

#include <fstream>
#include <iterator>
#include <system_error>

#include <pcor/words/error.hpp>

#include "words/quoting.hpp"

namespace pcor::internal {

std::string text_of_file(const std::filesystem::path& path, std::string_view what) {
  const auto fail = [&](const std::string& trouble) {
    throw Error(one_line(fmt::format("{}: {}", path.string(), trouble)));
  };
  std::error_code code;
  if (!std::filesystem::exists(path, code)) {
    fail(fmt::format("there is no such file; give the path of {}", what));
  }
  if (std::filesystem::is_directory(path, code)) {
    fail(fmt::format("is a directory; give the path of {}", what));
  }
  std::ifstream stream(path, std::ios::binary);
  std::string text{std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
  if (!stream) fail("cannot be read; check its permissions");
  return text;
}

}  // namespace pcor::internal

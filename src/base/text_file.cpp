#include "base/text_file.hpp"

#include <fmt/format.h>

#include <cstdint>
#include <fstream>
#include <iterator>
#include <system_error>

#include <pcor/base/error.hpp>

#include "base/quoting.hpp"

namespace pcor::internal {

std::string text_of_file(const std::filesystem::path& path, std::string_view what) {
  constexpr std::uintmax_t max_bytes = std::uintmax_t{16} << 20U;
  const auto fail = [&](const std::string& problem) {
    throw Error(Error::Code::file, one_line(fmt::format("{}: {}", path.string(), problem)));
  };
  const std::string advice = fmt::format("; give the path of {}", what);
  std::error_code code;
  if (!std::filesystem::exists(path, code)) fail("there is no such file" + advice);
  if (std::filesystem::is_directory(path, code)) fail("is a directory" + advice);
  if (!std::filesystem::is_regular_file(path, code)) fail("is not a regular file" + advice);
  if (std::filesystem::file_size(path, code) > max_bytes)
    fail(fmt::format("has more than {} MB, the limit of a text file{}", max_bytes >> 20U, advice));
  std::ifstream stream(path, std::ios::binary);
  std::string text{std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
  if (!stream) fail("cannot be read; check its permissions");
  return text;
}

}  // namespace pcor::internal

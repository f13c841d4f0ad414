#include "flight/flight_file.hpp"

#include <fmt/format.h>

#include <cerrno>
#include <cmath>
#include <cstring>
#include <fstream>

#include <pcor/base/error.hpp>
#include <pcor/base/shell_quote.hpp>
#include "flight/current_input.hpp"
#include "flight/netcdf_file.hpp"

namespace pcor {

namespace internal {

// icartt_file.cpp: series over time in text files of the ICARTT conventions.
bool is_icartt(const std::filesystem::path& path);
std::unique_ptr<FlightFile> open_icartt(const std::filesystem::path& path);

namespace {

[[noreturn]] void fail(const std::filesystem::path& path, const std::string& what) {
  throw Error(Error::Code::file, path.string() + what);
}

void require_readable(const std::filesystem::path& path) {
  if (path.empty()) fail(path, "the input has no name; name a netCDF file");
  std::error_code code;
  const auto status = std::filesystem::status(path, code);
  if (!std::filesystem::exists(status)) fail(path, ": no such file; check the path");
  if (std::filesystem::is_directory(status)) fail(path, " is a directory; name a netCDF file");
  if (!std::filesystem::is_regular_file(status)) fail(path, " is not a regular file; name a netCDF file");
  if (!std::ifstream(path))
    fail(path, std::string(" cannot be read: ") + std::strerror(errno) + "; check its permissions");
}

/// Scale factor or offset of packed values. @throws Error if the attribute exists and is not a number.
double packing_number(const FlightFile& file, int variable, const char* attribute, double otherwise) {
  const std::string text = file.text_attribute(variable, attribute);
  if (text.empty()) return otherwise;
  const std::vector<double> numbers = file.number_attribute(variable, attribute);
  const bool is_number = numbers.size() == 1 && std::isfinite(numbers.front());
  if (is_number && (numbers.front() != 0 || otherwise == 0)) return numbers.front();
  file.refuse(
      Error::Code::variable,
      ": the attribute {} of {} is \"{}\", which is not valid for packed values; correct it with ncatted "
      "-a {} {}",
      attribute, file.variable_name(variable), text,
      shell_quote(fmt::format("{},{},o,d,NUMBER", attribute, ncatted_name(file.variable_name(variable)))),
      shell_path(file.path().string()));
}

}  // namespace

}  // namespace internal

std::optional<int> FlightFile::find_variable(const std::string& name) const {
  for (int variable = 0; variable < variable_count(); ++variable)
    if (variable_name(variable) == name) return variable;
  return std::nullopt;
}

UnitConversion FlightFile::unpacking_of(int variable) const {
  return {internal::packing_number(*this, variable, "scale_factor", 1),
          internal::packing_number(*this, variable, "add_offset", 0)};
}

namespace internal {

std::string ncatted_name(const std::string& variable) {
  if (variable.find_first_of(".*+?^$|\\()[]{}<>") == std::string::npos) return variable;
  std::string pattern = "^";
  for (const char letter : variable) {
    if (std::strchr(".*+?^$|\\()[]{}", letter) != nullptr) pattern += '\\';
    pattern += letter;
  }
  return pattern + "$";
}

std::unique_ptr<FlightFile> open_flight_file(const std::filesystem::path& path) {
  require_readable(path);
  const CurrentInput current(path);
  if (is_netcdf(path)) return std::make_unique<NetcdfFile>(path);
  if (is_icartt(path)) return open_icartt(path);
  if (path.extension() == ".gz")
    fail(path,
         fmt::format(" is compressed; unpack it with gunzip -k {}, and name {}", shell_path(path.string()),
                     shell_path((path.parent_path() / path.stem()).string())));
  fail(path,
       " is not a netCDF file or an ICARTT file; give a file that `ncdump -k` can read, or whose first line "
       "ends in 1001");
}

}  // namespace internal

}  // namespace pcor

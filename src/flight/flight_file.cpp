#include "flight/flight_file.hpp"

#include <fmt/format.h>

#include <cerrno>
#include <cstring>
#include <fstream>

#include <pcor/base/error.hpp>
#include <pcor/base/shell_quote.hpp>
#include "flight/current_input.hpp"
#include "flight/netcdf_file.hpp"

namespace pcor::internal {

// icartt_file.cpp: series over time in text files of the ICARTT conventions.
bool is_icartt(const std::filesystem::path& path);
std::unique_ptr<FlightFile> open_icartt(const std::filesystem::path& path);

namespace {

/// A format of flight files.
struct Format {
  bool (*is_of)(const std::filesystem::path&);
  std::unique_ptr<FlightFile> (*open)(const std::filesystem::path&);
};

constexpr Format known_formats[] = {
    {is_netcdf,
     [](const std::filesystem::path& path) -> std::unique_ptr<FlightFile> {
       return std::make_unique<NetcdfFile>(path);
     }},
    {is_icartt, open_icartt},
};

void require_readable(const std::filesystem::path& path) {
  const std::string name = path.string();
  if (path.empty()) throw Error(Error::Code::file, "the input has no name; name a netCDF file");
  std::error_code code;
  const auto status = std::filesystem::status(path, code);
  if (!std::filesystem::exists(status))
    throw Error(Error::Code::file, name + ": no such file; check the path");
  if (std::filesystem::is_directory(status))
    throw Error(Error::Code::file, name + " is a directory; name a netCDF file");
  if (!std::filesystem::is_regular_file(status))
    throw Error(Error::Code::file, name + " is not a regular file; name a netCDF file");
  if (!std::ifstream(path))
    throw Error(Error::Code::file,
                name + " cannot be read: " + std::strerror(errno) + "; check its permissions");
}

}  // namespace

std::unique_ptr<FlightFile> open_flight_file(const std::filesystem::path& path) {
  require_readable(path);
  const FileInHand in_hand(path);
  for (const Format& format : known_formats) {
    if (format.is_of(path)) return format.open(path);
  }
  if (path.extension() == ".gz")
    throw Error(Error::Code::file,
                fmt::format("{} is compressed; unpack it with gunzip -k {}, and name {}", path.string(),
                            shell_quote(path.string()), (path.parent_path() / path.stem()).string()));
  throw Error(Error::Code::file, path.string() +
                                     " is not a netCDF file or an ICARTT file; give a file that `ncdump -k` "
                                     "can read, or whose first line ends in 1001");
}

}  // namespace pcor::internal

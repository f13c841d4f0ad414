#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>

namespace pcor::internal {

/// What the header of a classic netCDF file promises.
struct ClassicLayout {
  std::uintmax_t size = 0;          ///< the least number of bytes that the file must have
  std::uint64_t record_bytes = 0;   ///< of all variables over the unlimited dimension; 0: there are none
  std::uint64_t records_begin = 0;  ///< the byte at which the first record begins
};

/// Of a classic netCDF file (CDF-1, CDF-2 or CDF-5); nothing if the header cannot be what a writer wrote: it
/// has no end, or counts more than the file has room for.
///
/// To be asked before the netCDF library sees the file: of a damaged header the library believes every count
/// and takes that much memory, and where a truncated file ends it reads zeros.
std::optional<ClassicLayout> layout_of_classic(const std::filesystem::path& path);

}  // namespace pcor::internal

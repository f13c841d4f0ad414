#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>

namespace pcor::internal {

/// Sizes according to the header of a classic netCDF file.
struct ClassicLayout {
  std::uintmax_t size = 0;  ///< the least number of bytes that the file must have
  /// Total of all variables over the unlimited dimension; 0 without such variables.
  std::uint64_t record_bytes = 0;
  std::uint64_t records_begin = 0;  ///< the byte at which the first record begins
};

/// Layout of a classic netCDF file (CDF-1, CDF-2 or CDF-5); empty if the header is invalid: it has no end, or
/// its counts exceed the size of the file.
///
/// To be called before the netCDF library opens the file: the library allocates memory for every count in a
/// damaged header, and reads zeros behind the end of a truncated file.
std::optional<ClassicLayout> layout_of_classic(const std::filesystem::path& path);

}  // namespace pcor::internal

#pragma once

#include <cstdint>
#include <filesystem>

namespace pcor {

/// The least number of bytes that a classic netCDF file (CDF-1, CDF-2 or CDF-5) must have to hold what its
/// header promises. The netCDF library reads zeros where a truncated file ends, so this must be checked.
///
/// A header that cannot be read to its end gives the largest number there is; a file whose record count is
/// marked as unknown ("streaming") is taken to have no records.
std::uintmax_t promised_size_of_classic(const std::filesystem::path& path);

}  // namespace pcor

#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>

namespace pcor::internal {

/// The least number of bytes that a classic netCDF file (CDF-1, CDF-2 or CDF-5) must have to hold what its
/// header promises; nothing if the header cannot be what a writer wrote: it has no end, or counts more than
/// the file has room for.
///
/// To be asked before the netCDF library sees the file: of a damaged header the library believes every count
/// and takes that much memory, and where a truncated file ends it reads zeros.
std::optional<std::uintmax_t> promised_size_of_classic(const std::filesystem::path& path);

}  // namespace pcor::internal

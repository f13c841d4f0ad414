#pragma once

#include <cstdint>
#include <string_view>

namespace pcor::internal {

/// Digest that differs, except with probability 2^-64, if any bit differs or moves: Fowler, Noll and Vo's
/// FNV-1a.
/// @param before digest of the preceding bytes
inline std::uint64_t digest_of(std::string_view bytes, std::uint64_t before = 14695981039346656037U) {
  std::uint64_t digest = before;
  for (const char byte : bytes) digest = (digest ^ static_cast<unsigned char>(byte)) * 1099511628211U;
  return digest;
}

}  // namespace pcor::internal

#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

#include <pcor/words/error.hpp>

namespace fuzz {

/// Reads what libFuzzer gives as a text. To be refused is no fault, all else is.
template <class Read>
int reading(const std::uint8_t* bytes, std::size_t size, Read read) {
  const std::string text(bytes, bytes + size);
  try {
    read(text);
  } catch (const pcor::Error&) {
    return 0;
  }
  return 0;
}

}  // namespace fuzz

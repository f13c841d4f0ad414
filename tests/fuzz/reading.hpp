#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

#include <pcor/base/error.hpp>

namespace fuzz {

/// Calls a function that may throw pcor::Error. Any other exception is a fault.
template <class Work>
void refusable(Work work) {
  try {
    work();
  } catch (const pcor::Error&) {
    return;
  }
}

/// Passes the bytes of libFuzzer to `read` as a text.
template <class Read>
int reading(const std::uint8_t* bytes, std::size_t size, Read read) {
  const std::string text(bytes, bytes + size);
  refusable([&] { read(text); });
  return 0;
}

}  // namespace fuzz

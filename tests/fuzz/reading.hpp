#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

#include <pcor/base/error.hpp>

namespace fuzz {

/// Does what may be refused. To be refused is no fault, all else is.
template <class Work>
void refusable(Work work) {
  try {
    work();
  } catch (const pcor::Error&) {
    return;
  }
}

/// Reads what libFuzzer gives as a text.
template <class Read>
int reading(const std::uint8_t* bytes, std::size_t size, Read read) {
  const std::string text(bytes, bytes + size);
  refusable([&] { read(text); });
  return 0;
}

}  // namespace fuzz

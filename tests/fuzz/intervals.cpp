#include <pcor/regimes/regimes.hpp>

#include "reading.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  return fuzz::reading(bytes, size,
                       [](const std::string& text) { pcor::read_intervals_text(text, "intervals"); });
}

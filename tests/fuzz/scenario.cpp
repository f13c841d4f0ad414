#include <pcor/simulate/simulate.hpp>

#include "reading.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  return fuzz::reading(bytes, size,
                       [](const std::string& text) { pcor::parse_scenario(text, "a scenario"); });
}

#include <pcor/model_io/model_definition.hpp>

#include "reading.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  return fuzz::reading(
      bytes, size, [](const std::string& text) { pcor::write_model(pcor::parse_model(text, "a model")); });
}

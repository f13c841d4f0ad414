#include <pcor/units/units.hpp>

#include <cmath>
#include <cstdlib>

#include "reading.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  return fuzz::reading(bytes, size, [](const std::string& text) {
    for (const char* requested :
         {"hPa", "K", "m/s", "degree", "1", "seconds since 1970-01-01 00:00:00 UTC"}) {
      fuzz::refusable([&] {
        const auto conversion = pcor::UnitConversion::between(text, requested, {"PSFD", "a file", ""});
        const bool valid = std::isnormal(conversion.scale()) && std::isfinite(conversion.offset());
        if (!valid) std::abort();
      });
    }
  });
}

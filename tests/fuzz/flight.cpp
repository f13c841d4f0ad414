#include <pcor/flight/flight.hpp>

#include <cmath>
#include <cstdlib>
#include <fstream>
#include <vector>

#include "reading.hpp"
#include "support/temporary_directory.hpp"

namespace {

constexpr std::size_t max_samples = 1 << 20;

/// Writes the bytes to a file, because the HDF5 library requires a path. The next call overwrites the file.
std::filesystem::path file_of(const std::uint8_t* bytes, std::size_t size) {
  static const pcor::test::TemporaryDirectory folder;
  std::ofstream file(folder / "flight.nc", std::ios::binary);
  file.write(reinterpret_cast<const char*>(bytes), static_cast<std::streamsize>(size));
  file.close();
  if (!file) std::abort();
  return folder / "flight.nc";
}

void read_values(const pcor::Flight& flight, const pcor::VariableInfo& variable, int rate) {
  const std::size_t count = flight.records() * static_cast<std::size_t>(rate);
  if (count > max_samples) return;
  std::vector<double> values(count);
  flight.read_at_rate(rate, variable.name, {0, flight.records()}, {}, values.data());
  for (const double value : values)
    if (std::isinf(value)) std::abort();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  const std::filesystem::path path = file_of(bytes, size);
  fuzz::refusable([&] {
    const pcor::Flight flight(path);
    for (const std::string& name : flight.variables()) {
      const pcor::VariableInfo& variable = flight.variable(name);
      if (!variable.is_series) continue;
      for (const int rate : {1, variable.rate, 2 * variable.rate})
        fuzz::refusable([&] { read_values(flight, variable, rate); });
    }
  });
  return 0;
}

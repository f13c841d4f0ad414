#include "archived_steps.hpp"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <limits>
#include <sstream>

#include "pcor/offline/error.hpp"
#include "pcor/physics/constants.hpp"

namespace pcor {
namespace {

constexpr const char* variable = "HYDSTEP";
constexpr const char* attribute = "temperature_calibration";

using Coefficients = std::array<double, 3>;

Coefficients calibration_in(const Flight& flight) {
  for (const auto& [name, text] : flight.variable(variable).attributes) {
    Coefficients a{};
    if (name == attribute && std::istringstream(text) >> a[0] >> a[1] >> a[2]) return a;
  }
  throw Error(
      fmt::format("{}: {} does not say which correction of the temperature is in ATX (attribute {}); write "
                  "the file again with pcor process --hydrostatic",
                  flight.path().string(), variable, attribute));
}

/// The temperature, K, that the correction took to `corrected`, K: Newton's method from a step that is exact
/// for a constant.
double uncorrected(double corrected, const Coefficients& a) {
  const double target = corrected - constants::ice_point;
  double t = target - a[0];
  for (int step = 0; step < 6; ++step)
    t -= (t + a[0] + a[1] * t + a[2] * t * t - target) / (1.0 + a[1] + 2.0 * a[2] * t);
  return t + constants::ice_point;
}

}  // namespace

std::vector<double> archived_steps(const Flight& flight, FlightAir& air) {
  if (!flight.has(variable)) {
    throw Error(
        fmt::format("{}: there is no {}; write it with pcor process --hydrostatic, or leave out --archived",
                    flight.path().string(), variable));
  }
  const UnitConversion conversion = flight.conversion(variable, "m/K");
  const auto rate = static_cast<std::size_t>(flight.variable(variable).rate);
  std::vector<double> steps(air.size(), 0.0);
  std::vector<double> values;
  for (const RecordBlock block : blocks_of(flight.records())) {
    values.resize(block.count * rate);
    flight.read(variable, block, conversion, values.data());
    for (std::size_t i = 0; i < values.size(); ++i) {
      // From the mean over a record to that over the next: a step within a record is in its later samples
      // only, and the rest of it comes with the next record.
      const std::size_t record = block.first + i / rate;
      const double later = static_cast<double>(i % rate) / static_cast<double>(rate);
      steps[record] += values[i] * (1.0 - later);
      if (later > 0.0 && record + 1 < steps.size()) steps[record + 1] += values[i] * later;
    }
  }
  const Coefficients calibration = calibration_in(flight);
  for (double& temperature : air.temperature) temperature = uncorrected(temperature, calibration);
  return steps;
}

}  // namespace pcor

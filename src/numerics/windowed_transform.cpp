#include "numerics/windowed_transform.hpp"

#include <cmath>
#include <unsupported/Eigen/FFT>

#include <pcor/numerics/line_fit.hpp>

namespace pcor::internal {

WindowedTransform windowed_transform(const double* values, std::size_t count) {
  constexpr double pi = 3.14159265358979323846;
  std::vector<double> positions(count);
  for (std::size_t i = 0; i < count; ++i) positions[i] = static_cast<double>(i);
  const LineFit line = ordinary_fit(positions, std::vector<double>(values, values + count));
  WindowedTransform transform;
  std::vector<double> windowed(count);
  for (std::size_t i = 0; i < count; ++i) {
    const double window = 0.5 - 0.5 * std::cos(2.0 * pi * (positions[i] + 0.5) / static_cast<double>(count));
    windowed[i] = window * (values[i] - line.offset - line.slope * positions[i]);
    transform.power += window * window;
  }
  Eigen::FFT<double> fourier;
  fourier.fwd(transform.amplitudes, windowed);
  transform.amplitudes.resize(count / 2 + 1);
  return transform;
}

}  // namespace pcor::internal

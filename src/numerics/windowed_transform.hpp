#pragma once

#include <complex>
#include <cstddef>
#include <vector>

namespace pcor::internal {

/// The Fourier transform of a segment of a series, without its line, through Hann's window.
struct WindowedTransform {
  std::vector<std::complex<double>> amplitudes;  ///< amplitudes from 0 to half of the sampling rate
  double power = 0.0;                            ///< sum of the squares of the window
};

/// @param values of `count` samples, an even number, without missing ones
WindowedTransform windowed_transform(const double* values, std::size_t count);

}  // namespace pcor::internal

#pragma once

#include <vector>

namespace pcor::internal {

/// How much of a series lies at which period.
struct OctaveSpectrum {
  std::vector<double> period{};  ///< s, longest first: the middles of bands of a fifth of an octave or more
  std::vector<double> rms{};     ///< of the part within an octave about the period, in the unit of the series
  std::vector<double> error{};   ///< its standard error
};

/// The spectrum is a mean over segments without their lines, through Hann's window, of the longest length,
/// from 64 to 1024 samples, of which there are at least eight. NaN parts the series.
/// @param time s, increasing in each flight @param step of the samples, s
/// @returns nothing in its series where there are not eight segments
OctaveSpectrum octave_spectrum(const std::vector<double>& values, const std::vector<double>& time,
                               double step);

}  // namespace pcor::internal

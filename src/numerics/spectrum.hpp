#pragma once

#include <cstddef>
#include <vector>

#include <pcor/numerics/noise.hpp>

namespace pcor::internal {

/// The power of a segment of a series, without its line, through Hann's window.
struct Periodogram {
  std::vector<double> squares;  ///< squared amplitudes of both signs, from 0 to half of the sampling rate
  double window = 0.0;          ///< sum of the squares of the window
};

/// @param values of `count` samples, an even number, without missing ones
Periodogram periodogram(const double* values, std::size_t count);

/// First samples of the parts of `segments` with this length, an even number, which overlap by half.
std::vector<std::size_t> overlapping_parts(const std::vector<Segment>& segments, std::size_t length);

/// Distribution of the variance of a series over periods.
struct OctaveSpectrum {
  std::vector<double> period{};  ///< s, longest first: the middles of bands of a fifth of an octave or more
  std::vector<double> rms{};     ///< rms of the part within an octave about the period, in the unit of the
                                 ///< series
  std::vector<double> error{};   ///< its standard error
};

/// The spectrum is a mean over detrended segments, with Hann's window, of the longest length, from 64 to 1024
/// samples, that gives at least eight segments. NaN splits the series.
/// @param time s, increasing in each flight @param step sampling interval, s
/// @returns empty series if there are fewer than eight segments
OctaveSpectrum octave_spectrum(const std::vector<double>& values, const std::vector<double>& time,
                               double step);

}  // namespace pcor::internal

#pragma once

#include <vector>

namespace pcor::internal {

/// How one series follows another, period by period.
struct CrossSpectrum {
  std::vector<double> period{};       ///< s, longest first: means of bands of a third of an octave or more
  std::vector<double> coherence{};    ///< 0 to 1: the part of one's power that follows from the other
  std::vector<double> delay{};        ///< of the first behind the second, s
  std::vector<double> delay_error{};  ///< its standard error, s
  std::vector<double> time{};         ///< s, about a step of the second from 0 to 1
  std::vector<double> step{};         ///< what the first shows then
};

/// The spectra are means over segments of 256 samples, without their lines, through Hann's window;
/// differences of neighbours are taken of both series, so that slow changes, of which air has the most, do
/// not leak into short periods. The standard error of a phase is sqrt((1 - c) / (2 n c)) of coherence c and n
/// segments times frequencies (Bendat and Piersol, Random Data, ch. 9). Frequencies of a coherence that n
/// independent series reach by chance in 5 % take no part in the step. NaN parts both series.
/// @param time s, increasing in each flight @param step of the samples, s
/// @returns nothing in its series where there is not one segment
CrossSpectrum cross_spectrum(const std::vector<double>& first, const std::vector<double>& second,
                             const std::vector<double>& time, double step);

}  // namespace pcor::internal

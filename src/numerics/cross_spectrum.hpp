#pragma once

#include <vector>

namespace pcor::internal {

/// How one series follows another, period by period.
struct CrossSpectrum {
  std::vector<double> period{};       ///< s, longest first: means of bands of a third of an octave or more
  std::vector<double> coherence{};    ///< 0 to 1: the part of one's power that follows from the other
  std::vector<double> delay{};        ///< delay of the first series relative to the second, s
  std::vector<double> delay_error{};  ///< its standard error, s
  std::vector<double> time{};         ///< s, about a step of the second from 0 to 1
  std::vector<double> step{};         ///< what the first shows then
};

/// The spectra are means over segments of 256 samples, detrended, with Hann's window; both series are
/// differenced first, so that slow changes, which dominate in air, do not leak into short periods. The
/// standard error of a phase is sqrt((1 - c) / (2 n c)) for coherence c and n segments times frequencies
/// (Bendat and Piersol, Random Data, ch. 9). Frequencies with a coherence that n independent series reach by
/// chance in 5 % of cases are not used for the step. NaN splits both series.
/// @param time s, increasing in each flight @param step sampling interval, s
/// @returns empty series if no complete segment exists
CrossSpectrum cross_spectrum(const std::vector<double>& first, const std::vector<double>& second,
                             const std::vector<double>& time, double step);

}  // namespace pcor::internal

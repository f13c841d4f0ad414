#pragma once

#include <vector>

#include <pcor/residuals/samples.hpp>

namespace pcor::internal {

/// Dynamic pressure predicted from the radome: the least-squares combination of 1, the radome pressure QCR,
/// ADIFR^2 / QCR, BDIFR^2 / QCR and QCR^2 / p.
///
/// @param dynamic_pressure hPa, a value for each sample, NaN if missing
/// @param samples of the model, with the radome's pressures if they are recorded
/// @return hPa; unchanged if the radome has no value or departs by more than 15 %, and everywhere if fewer
/// than 300 samples have a value or the combination misses the pressure by more than 5 % (rms)
std::vector<double> predicted_by_radome(std::vector<double> dynamic_pressure, const ModelSamples& samples);

/// Static pressure predicted from the height: its fast part is that of a least-squares polynomial of ln p in
/// the recorded height, and its slow part (a Gaussian of 300 s) is its own. Noise with a memory of a minute
/// is reduced to a sixth, while weather and drift of the height stay.
///
/// @param static_pressure hPa, a value for each sample, NaN if missing
/// @param altitude m, a value for each sample, NaN if missing; empty: not recorded
/// @param step s, from sample to sample
/// @return hPa; unchanged if the height has no value or departs by more than 6 %, and everywhere if fewer
/// than 300 samples have a value or the polynomial misses the pressure by more than 2 % (rms)
std::vector<double> predicted_by_height(std::vector<double> static_pressure,
                                        const std::vector<double>& altitude, double step);

/// Samples with predicted pressures in place of the recorded ones, for the model and for a second system.
///
/// A column of a fit that is computed from the tested pressures correlates with the residual, since it
/// contains the same noise. The coefficients of a prediction come from the whole flight, so hardly any of
/// this noise remains. Rates of change stay as recorded: a centred rate of noise does not correlate with the
/// noise itself. A pressure altitude predicts nothing: it is one of the tested pressures.
///
/// @param recorded the same samples with the pressures as recorded
FlightSamples with_predicted_pressures(FlightSamples samples, const FlightSamples& recorded);

}  // namespace pcor::internal

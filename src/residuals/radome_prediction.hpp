#pragma once

#include <vector>

#include <pcor/residuals/samples.hpp>

namespace pcor::internal {

/// Dynamic pressure predicted from the radome: the least-squares combination of 1, the radome pressure QCR,
/// ADIFR^2 / QCR, BDIFR^2 / QCR and QCR^2 / p.
///
/// A column of a fit computed from the tested pressures correlates with the residual, since it contains the
/// same noise. The prediction contains only the noise of the radome.
///
/// @param dynamic_pressure hPa, a value for each sample, NaN if missing
/// @param samples of the model, with the radome's pressures if they are recorded
/// @return hPa; unchanged if the radome has no value, and everywhere if fewer than 300 samples have one
std::vector<double> predicted_by_radome(std::vector<double> dynamic_pressure, const ModelSamples& samples);

}  // namespace pcor::internal

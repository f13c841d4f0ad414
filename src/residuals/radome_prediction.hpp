#pragma once

#include <vector>

#include <pcor/residuals/samples.hpp>

namespace pcor::internal {

/// A dynamic pressure as the radome predicts it: the least-squares combination of 1, the radome's own
/// pressure QCR, ADIFR^2 / QCR, BDIFR^2 / QCR and QCR^2 / p.
///
/// A column of a fit that is made of the pressures under test goes with the residual, since it holds the same
/// noise. The prediction holds that of the radome alone.
///
/// @param dynamic_pressure hPa, a value for each sample, NaN where missing
/// @param samples of the model, with the radome's pressures where they are recorded
/// @return hPa; as it came where the radome has no value, and everywhere if fewer than 300 samples have one
std::vector<double> predicted_by_radome(std::vector<double> dynamic_pressure, const ModelSamples& samples);

}  // namespace pcor::internal

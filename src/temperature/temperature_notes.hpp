#pragma once

#include <string>
#include <vector>

#include <pcor/base/note.hpp>
#include <pcor/effects/psfd_bias.hpp>
#include <pcor/effects/temp_offset.hpp>
#include <pcor/temperature/temperature.hpp>
#include "temperature/height_record.hpp"

namespace pcor::internal {

/// Ratio of an estimate to its standard error that chance does not reach.
inline constexpr double significant_ratio = 3.0;

/// Usual zero of a static transducer, hPa. It is constant, and models were fitted to pressures that have it.
inline constexpr double usual_zero = effects::PsfdBias::info().parameters[0].typical;

/// Usual calibration error of a thermometer, K.
inline constexpr double usual_thermometer_error =
    effects::TempOffset::info().parameters[0].calibration_uncertainty;

/// Whether heights detect an error of the static-pressure model that is larger than its prior allows.
bool is_beyond_prior(const LawError& error);

/// Parts that differ, and errors of the pressure and the humidity that heights detect.
std::vector<std::string> temperature_warnings(const TemperatureResult& result);

/// Noise that is large, and a noise model that is not exact.
Notes noise_notes(const TemperatureResult& result);

/// Assumptions of the method. @param attack_is_unknown an error with the angle of attack is not corrected
Notes method_notes(const TemperatureOptions& options, bool attack_is_unknown);

/// Missing samples, steps and spikes of the heights, and the notes on each flight.
Notes record_notes(const std::vector<HeightRecord>& records, IsobarSlope slope);

}  // namespace pcor::internal

#pragma once

#include <vector>

#include <pcor/laws/model_file.hpp>
#include <pcor/residuals/samples.hpp>

namespace pcor::internal {

/// What an effect of a model finds over a time; nothing for a formula.
Memory memory_of(const ModelEffect& effect);

/// The true airspeed by corrected pressures and temperature, m/s, along the beam of the laser where there is
/// one, of a model with these coefficients; with its own where none are given.
std::vector<double> airspeed_along_beam(const ModelFile& model, const ModelSamples& samples,
                                        const double* parameters = nullptr);

/// Finds the columns that hang on a coefficient of the model, those of the samples that it has there, and how
/// they change with it: from the airspeed along the beam that the samples have. @param parameters of the
/// model @param time of the records, s @param step s
void find_moving_columns(const ModelFile& model, const double* parameters, const std::vector<double>& time,
                         double step, ModelSamples& samples);

}  // namespace pcor::internal

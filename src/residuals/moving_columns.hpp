#pragma once

#include <vector>

#include <pcor/laws/model_file.hpp>
#include <pcor/residuals/samples.hpp>

namespace pcor::internal {

/// What an effect of a model finds over a time; nothing for a formula.
Memory memory_of(const ModelEffect& effect);

/// The mean rate of change of a series over `seconds`, per second, as `RateFilter` has it. Gaps in time are
/// bridged by nothing: the rates beside them are of what is on one side.
std::vector<double> mean_rate(const std::vector<double>& values, const std::vector<double>& time, double step,
                              double shortest_period, double seconds = 0.0);

/// The shortest period, s, at which a series is rather more signal than noise: to cut its rate of change off
/// there leaves least error (Wiener), and one that can be fitted to. The noise is where the spectrum is flat.
double shortest_period_of(const std::vector<double>& values, const std::vector<double>& time, double step);

/// The true airspeed by corrected pressures and temperature, m/s, along the beam of the laser where there is
/// one, of a model with these coefficients; with its own where none are given.
std::vector<double> airspeed_along_beam(const ModelFile& model, const ModelSamples& samples,
                                        const double* parameters = nullptr);

/// Finds the columns that hang on a coefficient of the model, those of the samples that it has there, and how
/// they change with it. @param parameters of the model
void find_moving_columns(const ModelFile& model, const double* parameters, const std::vector<double>& time,
                         double step, ModelSamples& samples);

}  // namespace pcor::internal

#pragma once

#include <vector>

#include <pcor/model_io/model_definition.hpp>
#include <pcor/residuals/samples.hpp>
#include "residuals/model_on_samples.hpp"

namespace pcor::internal {

/// History input of an effect; empty for a formula.
Memory memory_of(const ModelEffect& effect);

/// True airspeed from corrected pressures and temperature, m/s, projected on the beam of the laser if there
/// is one, with the given coefficients or, if none are given, the coefficients of the model.
std::vector<double> airspeed_along_beam(const ModelDefinition& model, const ModelSamples& samples,
                                        const double* parameters = nullptr);

/// History input of a model (`EffectInfo::memory`): the mean rate of the airspeed along the beam, m/s2, or
/// the wetness of the thermometer after liquid water (`Wetness`), which restarts after a gap in time. Empty
/// if the samples lack its inputs. @param time of the records, s @param step sampling interval, s
/// @param seconds of the mean, or of drying, where values below zero are treated as zero
std::vector<double> history_input(Quantity quantity, const ModelSamples& samples,
                                  const std::vector<double>& time, double step, double seconds);

/// Computes the columns of the samples that depend on a coefficient of the model, and their derivatives with
/// respect to it (`history_input`). @param parameters of the model @param time of the records, s
/// @param step sampling interval, s
void find_parameter_dependent_columns(const Model& model, const double* parameters,
                                      const std::vector<double>& time, double step, ModelSamples& samples);

/// Columns of a model at some coefficients: columns of the samples, except columns that depend on
/// coefficients and were computed at other values, which are computed into `store`.
std::vector<Batch::Input> columns_at(const double* parameters, const ModelOnSamples& model,
                                     const FlightSamples& samples, ModelSamples& store);

}  // namespace pcor::internal

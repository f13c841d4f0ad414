#pragma once

#include <vector>

#include <pcor/model_io/model_definition.hpp>
#include <pcor/residuals/samples.hpp>
#include "residuals/model_on_samples.hpp"

namespace pcor::internal {

/// What an effect of a model finds over a time; nothing for a formula.
Memory memory_of(const ModelEffect& effect);

/// How wet the thermometer is in each record (`Wetness`); after a gap in time it begins anew. @param
/// liquid_water g/m3 @param time of the records, s @param step s @param drying s, below zero as zero
std::vector<double> wetness_of(const std::vector<double>& liquid_water, const std::vector<double>& time,
                               double step, double drying);

/// The true airspeed by corrected pressures and temperature, m/s, along the beam of the laser where there is
/// one, of a model with these coefficients; with its own where none are given.
std::vector<double> airspeed_along_beam(const ModelDefinition& model, const ModelSamples& samples,
                                        const double* parameters = nullptr);

/// What a model finds over some seconds (`EffectInfo::memory`): the mean rate of the airspeed along the
/// beam, m/s2, or the wetness of the thermometer after liquid water. Empty where the samples do not have what
/// it is found from. @param time of the records, s @param step s
std::vector<double> remembered(Quantity quantity, const ModelSamples& samples,
                               const std::vector<double>& time, double step, double seconds);

/// Finds the columns that hang on a coefficient of the model, those of the samples that it has there, and how
/// they change with it (`remembered`). @param parameters of the model @param time of the records, s
/// @param step s
void find_moving_columns(const Model& model, const double* parameters, const std::vector<double>& time,
                         double step, ModelSamples& samples);

/// The columns of a model at some coefficients: those of the samples, but for those that hang on coefficients
/// and were found at others.
class ColumnsAt {
 public:
  /// The model and the samples have to outlive it.
  ColumnsAt(const ModelOnSamples& model, const FlightSamples& samples, const double* parameters);

  ColumnsAt(const ColumnsAt&) = delete;
  ColumnsAt& operator=(const ColumnsAt&) = delete;

  const std::vector<Batch::Input>& inputs() const { return inputs_; }

 private:
  ModelSamples moved_;
  std::vector<Batch::Input> inputs_;
};

}  // namespace pcor::internal

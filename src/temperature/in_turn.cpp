#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <vector>

#include <pcor/base/error.hpp>
#include <pcor/temperature/temperature.hpp>
#include "campaign/flight_air.hpp"
#include "fit/fitted_model.hpp"
#include "model_io/calibration.hpp"
#include "parallel/flight_partition.hpp"

namespace pcor {

using namespace internal;

namespace {

constexpr int max_rounds = 12;
constexpr double settled_defect = 1e-3;       // hPa
constexpr double settled_temperature = 1e-3;  // K

/// The rms difference of delta-p of two models over the flights, in the air, hPa.
double defect_change(const FlightSet& flights, const ModelDefinition& before, const ModelDefinition& after,
                     const TemperatureOptions& options) {
  const auto sum = flights.partition().all_reduce_flights<Eigen::Vector2d>([&](std::size_t number) {
    const FlightAir first = read_flight_air(flights, number, before, options.mask);
    const FlightAir second = read_flight_air(flights, number, after, options.mask);
    Eigen::Vector2d squares_and_count = Eigen::Vector2d::Zero();
    for (std::size_t i = 0; i < first.size(); ++i) {
      const double change = second.static_defect[i] - first.static_defect[i];
      if (first.flying[i] && !std::isnan(change)) squares_and_count += Eigen::Vector2d(change * change, 1.0);
    }
    return squares_and_count;
  });
  return std::sqrt(sum[0] / sum[1]);
}

}  // namespace

IterativeCalibration calibrate_iteratively(const FlightSet& flights, const ModelDefinition& model,
                                           const References& references, const RefitOptions& refit_options,
                                           const TemperatureOptions& temperature_options) {
  if (temperature_options.archived) {
    throw Error(
        Error::Code::usage,
        "the pressures of archived flights are fixed; to fit pressure and temperature iteratively, give the "
        "recorded flights");
  }
  IterativeCalibration result;
  TemperatureOptions options = temperature_options;
  std::vector<DegreeChoice> degrees;
  Notes notes_on_degree;
  ModelDefinition current = model;
  std::vector<double> coefficients;
  for (const ModelEffect& effect : model.model.effects) {
    if (effect.id == calibration_id) coefficients = effect.parameters;
  }
  while (!result.converged && result.rounds.size() < max_rounds) {
    result.pressure = refit(flights, current, references, refit_options);
    result.temperature = fit_temperature(flights, result.pressure.model, options);
    if (result.rounds.empty()) {
      degrees = result.temperature.degrees;
      notes_on_degree = result.temperature.notes_on_degree;
    }
    // The degree is chosen once, to prevent oscillation.
    options.degree = static_cast<int>(result.temperature.likelihood.coefficients.size()) - 1;

    CalibrationRound round;
    round.rms_hpa = result.pressure.rms;
    round.coefficients = result.temperature.likelihood.coefficients;
    round.defect_change = defect_change(flights, current, result.pressure.model, options);
    for (const TemperatureCorrection& at : result.temperature.corrections) {
      const double change =
          correction_at(at.temperature, round.coefficients) - correction_at(at.temperature, coefficients);
      round.temperature_change = std::max(round.temperature_change, std::abs(change));
    }
    result.converged = round.defect_change < settled_defect && round.temperature_change < settled_temperature;
    coefficients = round.coefficients;
    current = result.temperature.model;
    result.rounds.push_back(std::move(round));
  }
  record_provenance(result.temperature.model, model, "fitted to", flights.title());
  result.temperature.degrees = std::move(degrees);
  if (result.rounds.size() > 1) {
    Notes& notes = result.temperature.notes;
    const bool has_graver = !result.temperature.rejection_reason.empty();
    notes.insert(notes.begin() + (has_graver ? 1 : 0), notes_on_degree.begin(), notes_on_degree.end());
    result.temperature.notes_on_degree = std::move(notes_on_degree);
  }
  return result;
}

}  // namespace pcor

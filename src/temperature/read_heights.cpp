#include "temperature/read_heights.hpp"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <sstream>

#include <pcor/physics/constants.hpp>
#include "campaign/model_parameters.hpp"
#include "model_io/archived_model.hpp"
#include "model_io/calibration.hpp"
#include "model_io/sensor_uncertainty.hpp"
#include "numerics/decompositions.hpp"
#include "numerics/triangular_factor.hpp"
#include "residuals/model_on_samples.hpp"
#include "roles/recorded_model.hpp"
#include "roles/recorded_series.hpp"
#include "roles/usual_variables.hpp"
#include "roles/variable_naming.hpp"

namespace pcor::internal {
namespace {

constexpr double dry_above = 5000.0;  // m; above it vapour makes less than 0.2 K of virtual temperature
/// The part of a thickness that vapour makes in the driest air below: 0.03 hPa at 600 hPa.
constexpr double min_part = 1e-5;

/// [variables] and [humidity] that would make the air moist.
std::string remedy(const ModelDefinition& model, const Flight& flight) {
  for (const Quantity role : humidity_roles) {
    const auto named = model.variables.find(role);
    if (named == model.variables.end()) continue;
    if (!model.model.moist) return "give the model [humidity] moist = true";
    return fmt::format("{} contains no water vapour: name another humidity in the model's [variables]",
                       named->second);
  }
  const VariableNaming& naming = naming_of(model, flight);
  for (const Quantity role : humidity_roles) {
    const std::string variable = first_with_values(flight, naming, info_of(role).name);
    if (!variable.empty()) {
      return fmt::format(
          "give the model [variables] {} = \"{}\", which the flight records, and [humidity] moist = true",
          info_of(role).name, variable);
    }
  }
  return "name the flight's vapor_pressure, dew_point or frost_point in the model's [variables], and give it "
         "[humidity] moist = true";
}

/// One standard deviation of the coefficients along each principal axis of their covariance, scaled alike.
std::vector<Eigen::VectorXd> standard_deviations(const Eigen::MatrixXd& covariance) {
  const Eigen::VectorXd scale = covariance.diagonal().cwiseSqrt();
  const Eigen::VectorXd inverse = (scale.array() > 0.0).select(scale.cwiseInverse(), 0.0);
  const SymmetricEigen axes(inverse.asDiagonal() * covariance * inverse.asDiagonal());
  std::vector<Eigen::VectorXd> changes;
  for (Eigen::Index k = 0; k < scale.size(); ++k) {
    if (axes.eigenvalues()[k] > 0.0)
      changes.emplace_back(std::sqrt(axes.eigenvalues()[k]) * scale.cwiseProduct(axes.eigenvectors().col(k)));
  }
  return changes;
}

/// True if an uncertainty is stated of a coefficient of the law itself, not of a sensor.
bool states_law(const ModelDefinition& model, const Eigen::MatrixXd& covariance) {
  Eigen::Index position = 0;
  for (const ModelEffect& effect : model.model.effects) {
    for (std::size_t p = 0; p < effect.parameters.size(); ++p, ++position) {
      if (location_of(effect) == EffectLocation::static_defect && covariance(position, position) > 0.0)
        return true;
    }
  }
  return false;
}

constexpr const char* steps_variable = "HYDSTEP";
constexpr const char* calibration_attribute = "temperature_calibration";
constexpr const char* model_attribute = "model";

using Coefficients = std::array<double, 3>;

[[noreturn]] void refuse_without(const Flight& flight, const char* what, const char* attribute) {
  throw Error(
      Error::Code::variable,
      fmt::format(
          "{}: {} does not state {} (attribute {}); write the file again with pcor process --hydrostatic",
          flight.path().string(), steps_variable, what, attribute));
}

Coefficients calibration_in(const Flight& flight) {
  Coefficients a{};
  std::istringstream text(flight.variable(steps_variable).attribute(calibration_attribute));
  if (!(text >> a[0] >> a[1] >> a[2]))
    refuse_without(flight, "the temperature correction in ATX", calibration_attribute);
  return a;
}

void require_same_model(const Flight& flight, const ModelDefinition& model) {
  const std::string archived = flight.variable(steps_variable).attribute(model_attribute);
  if (archived.empty()) refuse_without(flight, "its model", model_attribute);
  const std::string difference = archived_difference(archived, archived_model(model, CorrectWith::model));
  if (difference.empty()) return;
  throw Error(
      Error::Code::model,
      fmt::format(
          "{}: its pressures are not those of the model '{}' ({}); process the flight again with this model "
          "and --hydrostatic, give the model that it was processed with, or omit --archived for raw flights",
          flight.path().string(), model.model.name, difference));
}

/// The temperature, K, that the correction took to `corrected`, K: Newton's method from a step that is exact
/// for a constant.
double uncorrected(double corrected, const Coefficients& a) {
  const double target = corrected - constants::ice_point;
  double t = target - a[0];
  for (int step = 0; step < 6; ++step)
    t -= (t + a[0] + a[1] * t + a[2] * t * t - target) / (1.0 + a[1] + 2.0 * a[2] * t);
  return t + constants::ice_point;
}

/// -(R_a/g0) ln(p_i/p_(i-1)) from the mean of the record before to that of every record, as `pcor process
/// --hydrostatic` wrote it, m/K; NaN if missing. Takes the correction of the temperature that the file's
/// ATX has already off the temperature of `air`.
/// @throws Error if the file was not written so, or with a model whose pressures are others than those of
/// `model`; the correction of the temperature may be another.
std::vector<double> archived_steps(const Flight& flight, const ModelDefinition& model, FlightAir& air) {
  if (!flight.has(steps_variable)) {
    throw Error(
        Error::Code::variable,
        fmt::format("{}: there is no {}; write it with pcor process --hydrostatic, or omit --archived",
                    flight.path().string(), steps_variable));
  }
  require_same_model(flight, model);
  const UnitConversion conversion = flight.conversion(steps_variable, "m/K");
  const auto rate = static_cast<std::size_t>(flight.variable(steps_variable).rate);
  std::vector<double> steps(air.size(), 0.0);
  std::vector<double> values;
  for (const RecordBlock block : blocks_of(flight.records())) {
    values.resize(block.count * rate);
    flight.read(steps_variable, block, conversion, values.data());
    for (std::size_t i = 0; i < values.size(); ++i) {
      // From the mean over a record to that over the next: a step within a record is in its later samples
      // only, and the rest of it comes with the next record.
      const std::size_t record = block.first + i / rate;
      const double later = static_cast<double>(i % rate) / static_cast<double>(rate);
      steps[record] += values[i] * (1.0 - later);
      if (later > 0.0 && record + 1 < steps.size()) steps[record + 1] += values[i] * later;
    }
  }
  const Coefficients calibration = calibration_in(flight);
  for (double& temperature : air.temperature) temperature = uncorrected(temperature, calibration);
  return steps;
}

HeightRecord record_of(const FlightSet& flights, std::size_t number, const ModelDefinition& model,
                       const TemperatureOptions& options) {
  ModelDefinition stated = without_calibration(model);
  HeightRecordOptions record_options;
  record_options.min_climb_rate = options.min_climb_rate;
  record_options.has_radome = model.variables.count(Quantity::attack_differential_pressure) > 0;
  record_options.recovers = model.variables.count(Quantity::recovery_temperature) > 0;
  FlightAir air;
  std::vector<double> steps;
  if (options.archived) {
    const Flight& flight = flights[number];
    std::optional<ModelDefinition> recorded = recorded_model(flight);
    if (!recorded || recorded->variables.count(Quantity::ambient_temperature) == 0) {
      throw Error(
          Error::Code::variable,
          fmt::format(
              "{}: --archived needs PSXC, QCXC and ATX as pcor process writes them; omit it for raw flights",
              flight.path().string()));
    }
    for (const Quantity role : motion_quantities) {
      if (model.variables.count(role) > 0) recorded->variables[role] = model.variables.at(role);
      if (model.units.count(role) > 0) recorded->units[role] = model.units.at(role);
    }
    air = read_flight_air(flights, number, *recorded, options.mask);
    steps = archived_steps(flight, model, air);
  } else {
    air = read_flight_air(flights, number, stated, options.mask);
  }
  HeightRecord record = height_record(air, steps, record_options);
  if (options.archived) {  // Inputs of the model are not archived: only its remaining error is known.
    stated.covariance = {};
    stated.fits.clear();
  }
  record.law_variance = stated_law_variance(stated, air);
  return record;
}

}  // namespace

std::string dry_air_problem(const HeightRecord& record, const ModelDefinition& model, const Flight& flight) {
  double lowest = std::numeric_limits<double>::infinity();
  double highest = -lowest;
  double by_vapor = 0.0;
  for (const HeightBlock& block : record.blocks) {
    lowest = std::min(lowest, block.height);
    highest = std::max(highest, block.height);
    by_vapor = std::max(by_vapor, std::abs(block.columns[with_vapor]));
  }
  if (lowest > dry_above || by_vapor > min_part * (highest - lowest)) return "";
  return fmt::format(
      "{}: it climbs or descends down to {:.0f} m in air assumed dry; below {:.0f} m neglected vapour "
      "resembles a thermometer error of up to 3 K; {}",
      record.name, lowest, dry_above, remedy(model, flight));
}

std::optional<double> stated_law_variance(const ModelDefinition& model, const FlightAir& air) {
  const ModelUncertainty stated = stated_uncertainty(model);
  const bool has_rest = stated.static_defect > 0.0 || stated.static_defect_ratio > 0.0;
  const Eigen::MatrixXd covariance = stated_covariance(model);
  if (!has_rest && !states_law(model, covariance)) return std::nullopt;
  double sum = 0.0;
  const auto add_mean_square = [&](const auto& value) {
    double count = 0.0;
    double squares = 0.0;
    for (std::size_t i = 0; i < air.size(); ++i) {
      const double here = value(i);
      if (!air.flying[i] || std::isnan(here)) continue;
      squares += here * here;
      count += 1.0;
    }
    if (count > 0.0) sum += squares / count;
  };
  add_mean_square([&](std::size_t i) {
    return std::hypot(stated.static_defect, stated.static_defect_ratio * air.pressure[i]);
  });
  if (stated.has_systematic()) {
    const ModelOnSamples law(model, air.samples->model);
    std::vector<double> parameters = law.parameters();
    Eigen::Map<Eigen::VectorXd> moved(parameters.data(), as_index(parameters.size()));
    const Eigen::VectorXd start = moved;
    std::vector<double> defect(air.size());
    for (const Eigen::VectorXd& change : standard_deviations(covariance)) {
      moved = start + change;
      law.batch().run(law.columns(), {{Quantity::static_defect, defect.data()}}, defect.size(),
                      parameters.data());
      add_mean_square([&](std::size_t i) { return defect[i] - air.static_defect[i]; });
    }
  }
  return sum;
}

FlightHeightRecord read_heights(const FlightSet& flights, std::size_t number, const ModelDefinition& model,
                                const TemperatureOptions& options) {
  FlightHeightRecord part;
  try {
    part.record = record_of(flights, number, model, options);
    part.dry = dry_air_problem(*part.record, model, flights[number]);
    if (!part.dry.empty() && !options.dry_air)
      throw Error(Error::Code::variable, part.dry + "; --force continues with dry air");
    if (options.skip_returning && part.record->returns)
      throw Error(Error::Code::samples, "it ends at its start point (--skip-returning)");
  } catch (const Error& error) {
    part.record.reset();
    part.excluded = error.what();
    part.code = error.code();
  }
  return part;
}

}  // namespace pcor::internal

#pragma once

#include <Eigen/Dense>
#include <array>
#include <cstddef>
#include <functional>
#include <optional>
#include <string_view>
#include <vector>

#include <pcor/model_io/model_definition.hpp>
#include <pcor/residuals/reference.hpp>
#include <pcor/residuals/samples.hpp>
#include "numerics/latent_filter.hpp"

namespace pcor::internal {

/// Quantity compared with GPS: the airspeed and a wind, or the hydrostatic height.
enum class GpsKind { wind, height };

/// Kind of a GPS reference; nullopt for any other reference.
std::optional<GpsKind> gps_kind(const Reference& reference);

/// Nuisance parameters of the rows, with their priors: `gps_shared_nuisances` instrument errors, common to
/// all flights, then parameters of each flight.
struct GpsNuisance {
  std::string_view name;
  double deviation;
  std::string_view same_as = {};  ///< coefficient for the same error (`corrects_error_of`)
};

inline constexpr std::array<GpsNuisance, 11> gps_nuisances{{
    {"thermometer, K", 0.3, "temp-offset.offset"},
    {"recovery factor", 0.005, "recovery-factor.da"},
    {"heading, deg", 0.2},
    {"sideslip, deg", 0.3},
    {"attack, deg", 0.3},
    {"lag of the velocity, s", 0.2},
    {"lag of the height, s", 0.2},
    {"shear of the east wind, m/s per km", 3.0},
    {"shear of the north wind, m/s per km", 3.0},
    {"slope of isobars to the east, m per 100 km", 10.0},
    {"slope of isobars to the north, m per 100 km", 10.0},
}};

inline constexpr Eigen::Index gps_nuisance_count = gps_nuisances.size();
inline constexpr Eigen::Index gps_shared_nuisances = 7;

/// Standard deviations of the priors of all nuisances.
Eigen::VectorXd gps_nuisance_deviations();

/// Rows of one flight. Each has the derivatives with respect to the requested coefficients of the model and
/// all nuisances, and the residual; NaN if a sample is excluded. Columns contain no gusts, and little noise:
/// noise that a column shares with its row would bias the coefficient for any length of the flight.
struct GpsRows {
  GpsKind kind = GpsKind::wind;
  std::vector<double> time;      ///< time of each sample, s
  std::vector<double> rise;      ///< height change since the previous sample, m
  std::vector<double> level;     ///< wind: variance of a gust of one second predicted by its spectrum
  std::vector<double> airspeed;  ///< wind: airspeed without gusts, m/s
  std::vector<double> east;      ///< wind: east component of the direction of the airspeed, without gusts
  std::vector<double> north;
  std::vector<double> warmth;     ///< height: 1/T, 1/K
  std::vector<double> thickness;  ///< height change by a pressure change, m/hPa
  std::vector<bool> is_break;     ///< height: the height since the sample before is not known
  RowByRow rows;                  ///< wind: of the east, then of the north component of all samples
  Eigen::MatrixXd defect;  ///< derivatives of the corrected static pressure by the requested coefficients
};

/// Effects that the model lacks: each coefficient adds an amount at a location of the model.
struct EffectAmounts {
  std::vector<std::size_t> amounts_of_model{};  ///< parameters of the model, the amounts at its locations
  std::vector<std::size_t> at{};                ///< index of the location of each coefficient among these
  /// Amounts per unit of each coefficient, one row per sample, at these inputs of the model; finite.
  std::function<Eigen::MatrixXd(const ModelSamples& inputs)> amounts{};
};

/// Rows at the given coefficients.
///
/// Wind, m/s: ground velocity minus the velocity through the air, V u(heading, pitch, roll, attack,
/// sideslip), each component. Height, m: GPS height minus height by the hydrostatic equation.
///
/// The columns of the wind use pressures without gusts: V low-passed by a Gaussian of 45 s, its direction by
/// one of 15 s; rates of change low-passed by 45 s, because the aircraft responds to gusts; flow angles and
/// other inputs of effects contain 87 % of an oscillation of 4 s and less of faster ones. In the columns of
/// the height, the terms with the temperature and the rise use pressures low-passed by 15 s, because even a
/// thousandth of the noise of pressure or GPS in them would appear as a temperature error of a few tenths of
/// a kelvin.
/// @param used samples of the fit @param parameters all parameters of the model; the rows have derivatives by
/// `requested` @param effects have further columns, after those of `requested` @param warmer estimate of the
/// thermometer's nuisance, K: the residual is reduced by the fast part of this error, which the low-passed
/// column omits
GpsRows gps_rows(GpsKind kind, const FlightSamples& samples, const ModelDefinition& model,
                 const std::vector<std::size_t>& used, const double* parameters,
                 const std::vector<std::size_t>& requested, const EffectAmounts& effects = {},
                 double warmer = 0.0);

}  // namespace pcor::internal

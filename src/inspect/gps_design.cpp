#include <pcor/inspect/inspect.hpp>

#include <Eigen/Dense>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <vector>

#include <pcor/base/error.hpp>
#include <pcor/effects/catalogue.hpp>
#include <pcor/residuals/residuals.hpp>
#include "campaign/gps_noise.hpp"
#include "campaign/gps_rows.hpp"
#include "campaign/gps_system.hpp"
#include "numerics/decompositions.hpp"
#include "numerics/missing.hpp"
#include "numerics/triangular_factor.hpp"
#include "residuals/masks.hpp"

namespace pcor {

using namespace internal;

namespace {

/// The error of delta-p by some of the coefficients without its part that is proportional to `level`, hPa,
/// rms.
double error_beyond(const Eigen::VectorXd& level, const Eigen::MatrixXd& defects,
                    const Eigen::MatrixXd& covariance, const std::vector<Eigen::Index>& some) {
  if (some.empty()) return nan;
  const Eigen::MatrixXd columns = defects(Eigen::all, some);
  const Eigen::MatrixXd off = columns - level * (level.transpose() * columns) / level.squaredNorm();
  const Eigen::MatrixXd part = covariance(some, some);
  return std::sqrt((off * part).cwiseProduct(off).sum() / static_cast<double>(off.rows()));
}

}  // namespace

std::optional<GpsDesign> gps_design(const Flight& flight, const ModelDefinition& model) {
  std::vector<Eigen::Index> with_attack;
  std::vector<Eigen::Index> with_speed;
  std::vector<double> deviations;
  std::optional<Eigen::Index> constant;
  for (const ModelEffect& effect : model.model.effects) {
    if (effect.is_formula()) return std::nullopt;
    const EffectInfo& info = *effect_named(effect.id);
    for (std::size_t p = 0; p < effect.parameters.size(); ++p) {
      const Eigen::Index position = as_index(deviations.size());
      if (effect.id == "static-constant") constant = position;
      const bool by_attack = effect.id == "static-alpha" || effect.id == "static-attack";
      (by_attack ? with_attack : with_speed).push_back(position);
      deviations.push_back(gps_prior_in_typical_sizes * std::abs(info.parameters[p].typical));
    }
  }
  const Eigen::Index count = as_index(deviations.size());
  for (const GpsNuisance& nuisance : gps_nuisances) deviations.push_back(nuisance.deviation);
  std::vector<std::size_t> requested(static_cast<std::size_t>(count));
  std::iota(requested.begin(), requested.end(), 0);
  GpsDesign design;
  Eigen::MatrixXd defects;
  const Eigen::VectorXd variances =
      Eigen::Map<const Eigen::ArrayXd>(deviations.data(), as_index(deviations.size())).square();
  Eigen::MatrixXd information = variances.cwiseInverse().asDiagonal();
  for (const GpsKind kind : {GpsKind::wind, GpsKind::height}) {
    try {
      const auto reference = kind == GpsKind::wind ? wind_reference(model) : height_reference(model);
      const auto samples = std::make_shared<FlightSamples>(read_samples(flight, model, *reference));
      const Residuals residuals(samples, model, *reference);
      const GpsRows rows = gps_rows(kind, *samples, model, used_samples(residuals.mask()),
                                    residuals.parameters().data(), requested);
      if (rows.defect.rows() == 0) continue;
      const WhiteRows white = GpsNoise(kind).white(rows, Eigen::VectorXd::Zero(rows.rows.rows()));
      const auto columns = white.rows.leftCols(information.cols());
      information.noalias() += columns.transpose() * columns;
      defects = rows.defect;
      (kind == GpsKind::wind ? design.by_wind : design.by_height) = true;
    } catch (const Error& error) {
      if (error.code() == Error::Code::file) throw;
    }
  }
  if (!design.by_wind && !design.by_height) return std::nullopt;
  const Eigen::MatrixXd covariance = symmetric_solution(
      information, Eigen::MatrixXd(Eigen::MatrixXd::Identity(information.rows(), information.cols())));
  const Eigen::RowVectorXd mean = defects.colwise().mean();
  // Heights do not determine a delta-p proportional to the pressure: it belongs to the level.
  const Eigen::VectorXd level =
      constant ? Eigen::VectorXd(defects.col(*constant)) : Eigen::VectorXd::Ones(defects.rows());
  design.level = std::sqrt(mean * covariance.topLeftCorner(count, count) * mean.transpose());
  // A direction is undetermined if the flight hardly reduces its prior error, or if it varies too little.
  constexpr double summary = 0.5;
  const Eigen::MatrixXd prior = variances.head(count).asDiagonal();
  const auto error_of = [&](const std::vector<Eigen::Index>& with) {
    const double error = error_beyond(level, defects, covariance, with);
    const double before = error_beyond(level, defects, prior, with);
    // Columns proportional to the level have only rounding errors beyond it.
    constexpr double rounding = 1e-9;  // hPa
    return !(before > rounding) ? nan : error > summary * before ? infinity : error;
  };
  design.slope = error_of(with_speed);
  design.attack = error_of(with_attack);
  return design;
}

}  // namespace pcor

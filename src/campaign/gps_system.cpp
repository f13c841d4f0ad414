#include "campaign/gps_system.hpp"

#include <cmath>

#include <pcor/residuals/residuals.hpp>
#include "campaign/gps_noise.hpp"
#include "numerics/triangular_factor.hpp"
#include "parallel/flight_partition.hpp"

namespace pcor::internal {
namespace {

constexpr double minute = 60.0;                // s
constexpr double prior_in_usual_sizes = 1.25;  // the same as in a fit
constexpr Eigen::Index own_nuisances = gps_nuisance_count - gps_shared_nuisances;

const GpsNuisance& nuisance(Eigen::Index n) { return gps_nuisances[static_cast<std::size_t>(n)]; }

/// Prior of the coefficients of the law and of all nuisances.
GpsPrior prior_of(const GpsColumns& columns) {
  const Eigen::Index own = as_index(columns.own);
  GpsPrior prior{Eigen::VectorXd::Zero(own + gps_nuisance_count), Eigen::VectorXd(own + gps_nuisance_count)};
  for (Eigen::Index k = 0; k < own; ++k)
    prior.deviation[k] = prior_in_usual_sizes * columns.usual[static_cast<std::size_t>(k)];
  for (Eigen::Index n = 0; n < gps_nuisance_count; ++n) prior.deviation[own + n] = nuisance(n).deviation;
  return prior;
}

/// The same rows without the columns of tested effects.
GpsRows without_tested(const GpsRows& rows, const GpsColumns& columns) {
  GpsRows result = rows;
  const Eigen::Index own = as_index(columns.own);
  const Eigen::Index tested = as_index(columns.places.size()) - own;
  result.rows.resize(rows.rows.rows(), rows.rows.cols() - tested);
  result.rows << rows.rows.leftCols(own), rows.rows.rightCols(rows.rows.cols() - own - tested);
  return result;
}

/// Coefficients, shared nuisances and residual after the fit of the nuisances of the flight. The rows of the
/// prior of these nuisances follow the rows of the flight.
RowByRow eliminate_own(const RowByRow& white, Eigen::Index coefficients) {
  const Eigen::Index kept = coefficients + gps_shared_nuisances;
  const Eigen::Index size = white.rows();
  RowByRow own = RowByRow::Zero(size + own_nuisances, own_nuisances);
  own.topRows(size) = white.middleCols(kept, own_nuisances);
  for (Eigen::Index k = 0; k < own_nuisances; ++k)
    own(size + k, k) = 1.0 / nuisance(gps_shared_nuisances + k).deviation;
  RowByRow rows = RowByRow::Zero(size + own_nuisances, kept + 1);
  rows.topRows(size) << white.leftCols(kept), white.rightCols(1);
  const Eigen::MatrixXd squares = own.transpose() * own;
  const Eigen::MatrixXd products = own.transpose() * rows;
  rows.noalias() -= own * squares.ldlt().solve(products);
  return rows;
}

}  // namespace

GpsFlightSystem gps_flight_system(const std::shared_ptr<const FlightSamples>& samples,
                                  const ModelDefinition& model, const Reference& reference,
                                  const MaskOptions& mask, const GpsColumns& columns) {
  const Residuals residuals(samples, model, reference, mask);
  std::vector<std::size_t> used;
  for (std::size_t i = 0; i < residuals.size(); ++i) {
    if (residuals.mask()[i] == Mask::none) used.push_back(i);
  }
  const GpsKind kind = *gps_kind(reference);
  const GpsRows rows = gps_rows(kind, *samples, model, used, residuals.parameters().data(), columns.places);
  GpsFlightSystem system;
  if (rows.defect.rows() == 0) return system;
  const GpsRows own = without_tested(rows, columns);
  Eigen::VectorXd outliers = Eigen::VectorXd::Zero(rows.rows.rows());
  GpsNoise noise(kind);
  GpsPrior prior = prior_of(columns);
  widen(prior, noise.white(own, outliers));
  noise.maximise(own, outliers, prior);
  if (find_outliers(noise.white(own, outliers), prior, outliers)) noise.maximise(own, outliers, prior);
  const WhiteRows white = noise.white(rows, outliers);
  system.rows = eliminate_own(white.rows, as_index(columns.places.size()));
  const auto minute_of = [&](std::size_t sample) {
    return static_cast<Eigen::Index>(std::floor((samples->time[sample] - samples->time.front()) / minute));
  };
  for (Eigen::Index i = 0; i < white.rows.rows(); ++i)
    system.minutes.push_back(minute_of(static_cast<std::size_t>(i) % samples->time.size()));
  system.minutes.resize(static_cast<std::size_t>(system.rows.rows()), 0);
  return system;
}

GpsSystem gps_system(const FlightSet& flights, const ModelDefinition& model, const References& references,
                     const MaskOptions& mask, const GpsColumns& columns) {
  const Eigen::Index count = as_index(columns.places.size());
  GpsSystem system;
  system.prior = RowByRow::Zero(gps_shared_nuisances, count + gps_shared_nuisances + 1);
  for (Eigen::Index n = 0; n < gps_shared_nuisances; ++n)
    system.prior(n, count + n) = 1.0 / nuisance(n).deviation;
  for (std::size_t r = 0; r < references.size(); ++r) {
    if (!gps_kind(*references[r])) continue;
    for (std::size_t f = 0; f < flights.size(); ++f) {
      if (!flights.share().owns(f)) continue;
      const auto samples = flights.samples(f, model, *references[r], mask);
      system.flights.push_back(gps_flight_system(samples, model, *references[r], mask, columns));
      system.flights.back().flight = f;
      system.flights.back().reference = r;
    }
  }
  return system;
}

}  // namespace pcor::internal

#include "campaign/gps_system.hpp"

#include <fmt/format.h>

#include <cmath>
#include <numeric>

#include "campaign/gps_noise.hpp"
#include "campaign/model_parameters.hpp"
#include "numerics/decompositions.hpp"
#include "numerics/triangular_factor.hpp"
#include "residuals/model_on_samples.hpp"

namespace pcor::internal {
namespace {

constexpr Eigen::Index flight_nuisances = gps_nuisance_count - gps_shared_nuisances;

/// The same rows without the columns of effects.
GpsRows without_effects(const GpsRows& rows, Eigen::Index law) {
  GpsRows result = rows;
  result.rows.resize(rows.rows.rows(), law + gps_nuisance_count + 1);
  result.rows << rows.rows.leftCols(law), rows.rows.rightCols(gps_nuisance_count + 1);
  return result;
}

/// Subtracts the best fit of the nuisances of the flight, and appends the rows of their prior.
/// @param white nuisances in units of their priors
Eigen::MatrixXd eliminate_flight_nuisances(const Eigen::MatrixXd& white) {
  const Eigen::Index kept = white.cols() - 1 - flight_nuisances;
  const Eigen::Index size = white.rows();
  Eigen::MatrixXd nuisances = Eigen::MatrixXd::Zero(size + flight_nuisances, flight_nuisances);
  nuisances.topRows(size) = white.middleCols(kept, flight_nuisances);
  nuisances.bottomRows(flight_nuisances).setIdentity();
  Eigen::MatrixXd rows = Eigen::MatrixXd::Zero(size + flight_nuisances, kept + 1);
  rows.topRows(size) << white.leftCols(kept), white.rightCols(1);
  rows.noalias() -= nuisances * symmetric_solution(nuisances.transpose() * nuisances,
                                                   Eigen::MatrixXd(nuisances.transpose() * rows));
  return rows;
}

}  // namespace

void GpsSystem::keep(const std::vector<Eigen::Index>& kept, Eigen::Index first, Eigen::Index count) {
  if (rows.size() == 0) return;
  std::vector<Eigen::Index> all;
  for (Eigen::Index c = 0; c < first; ++c) all.push_back(c);
  for (const Eigen::Index c : kept) all.push_back(first + c);
  for (Eigen::Index c = first + count; c < rows.cols(); ++c) all.push_back(c);
  rows = Eigen::MatrixXf(rows(Eigen::all, all));
}

GpsSystem gps_system(const GpsRows& rows, const std::vector<double>& typical_sizes) {
  GpsSystem system;
  const Eigen::Index law = as_index(typical_sizes.size());
  GpsPrior prior{Eigen::VectorXd::Zero(law + gps_nuisance_count), Eigen::VectorXd(law + gps_nuisance_count)};
  for (Eigen::Index k = 0; k < law; ++k)
    prior.deviation[k] = gps_prior_in_typical_sizes * typical_sizes[static_cast<std::size_t>(k)];
  prior.deviation.tail(gps_nuisance_count) = gps_nuisance_deviations();
  const GpsRows law_rows = without_effects(rows, law);
  Eigen::VectorXd outliers = Eigen::VectorXd::Zero(rows.rows.rows());
  GpsNoise noise(rows.kind);
  widen(prior, noise.white(law_rows, outliers));
  noise.maximise(law_rows, outliers, prior);
  if (find_outliers(noise.white(law_rows, outliers), prior, outliers))
    noise.maximise(law_rows, outliers, prior);
  WhiteRows white = noise.white(rows, outliers);
  std::vector<Eigen::Index> with_value;
  for (Eigen::Index row = 0; row < white.rows.rows(); ++row) {
    if (!(white.variance[row] > 0.0)) continue;
    with_value.push_back(row);
    system.record.push_back(static_cast<std::size_t>(row) % rows.time.size());
  }
  if (with_value.empty()) return system;
  const Eigen::Index nuisances = white.rows.cols() - 1 - gps_nuisance_count;
  for (Eigen::Index n = 0; n < gps_nuisance_count; ++n)
    white.rows.col(nuisances + n) *= prior.deviation[law + n];
  system.rows = eliminate_flight_nuisances(white.rows(with_value, Eigen::all)).cast<float>();
  system.record.resize(static_cast<std::size_t>(system.rows.rows()), system.record.front());
  return system;
}

double thermometer_of(const GpsSystem& system, const std::vector<double>& typical_sizes) {
  const Eigen::Index law = as_index(typical_sizes.size());
  const Eigen::Index columns = system.rows.cols() - 1;
  std::vector<Eigen::Index> indices(typical_sizes.size());
  std::iota(indices.begin(), indices.end(), Eigen::Index{0});
  for (Eigen::Index n = columns - gps_shared_nuisances; n <= columns; ++n) indices.push_back(n);
  const Eigen::MatrixXd rows = system.rows(Eigen::all, indices).cast<double>();
  Eigen::MatrixXd products = rows.transpose() * rows;
  for (Eigen::Index k = 0; k < law; ++k) {
    const double deviation = gps_prior_in_typical_sizes * typical_sizes[static_cast<std::size_t>(k)];
    if (deviation > 0.0) products(k, k) += 1.0 / (deviation * deviation);
  }
  products.diagonal().segment(law + 1, gps_shared_nuisances - 1).array() += 1.0;
  // With its own prior the law, whose change of temperature looks the same, would take most of the error.
  constexpr double wider = 10.0;
  products(law, law) += 1.0 / (wider * wider);
  const Eigen::Index count = law + gps_shared_nuisances;
  return gps_nuisances.front().deviation *
         pseudo_solution(products.topLeftCorner(count, count), products.col(count).head(count))[law];
}

std::string format_disagreement(double variance) {
  constexpr double notable = 2.0;
  const double factor = std::sqrt(variance);
  if (factor < notable) return "";
  return fmt::format(
      "exclude changes of the weather (--intervals) or give a further reference: halves of the flights, or "
      "references, disagree {:.1f} times more than the noise of GPS explains; the stated errors contain this",
      factor);
}

std::vector<Eigen::MatrixXd> gps_products_of_parts(GpsKind kind, const FlightSamples& samples,
                                                   const ModelDefinition& model,
                                                   const std::vector<std::size_t>& used,
                                                   const std::vector<std::vector<std::size_t>>& parts) {
  const std::vector<std::size_t> law = free_parameters(model);
  ModelDefinition with_amount = model;
  with_amount.model.additions = {EffectLocation::static_defect};
  const std::vector<double> all = ModelOnSamples(with_amount, samples.model).parameters();
  EffectAmounts effects;
  effects.amounts_of_model = {all.size() - 1};
  effects.at.assign(parts.size(), 0);
  effects.amounts = [&](const ModelSamples&) {
    Eigen::MatrixXd amounts = Eigen::MatrixXd::Zero(as_index(samples.time.size()), as_index(parts.size()));
    for (std::size_t part = 0; part < parts.size(); ++part) amounts(parts[part], as_index(part)).setOnes();
    amounts.col(0).setOnes();  // heights also pass through samples that are not used
    return amounts;
  };
  // The coefficients of the law are free in the noise, with wide priors.
  const auto system_at = [&](double warmer) {
    return gps_system(gps_rows(kind, samples, with_amount, used, all.data(), law, effects, warmer),
                      std::vector<double>(law.size(), 0.0));
  };
  GpsSystem system = system_at(0.0);
  if (system.rows.size() == 0) return {};
  // Without columns of the law: its coefficients stay at the model's.
  if (kind == GpsKind::height) system = system_at(thermometer_of(system, {}));
  const Eigen::MatrixXd rows = system.rows.cast<double>();
  const auto of_parts = rows.middleCols(as_index(law.size()), as_index(parts.size()));
  std::vector<Eigen::MatrixXd> products;
  for (Eigen::Index part = 0; part < of_parts.cols(); ++part) {
    if (parts[static_cast<std::size_t>(part)].empty()) {
      products.emplace_back();
      continue;
    }
    Eigen::MatrixXd columns(rows.rows(), gps_shared_nuisances + 3);
    columns << rows.middleCols(rows.cols() - 1 - gps_shared_nuisances, gps_shared_nuisances), of_parts.col(0),
        of_parts.col(part), rows.rightCols(1);
    products.emplace_back(columns.transpose() * columns);
  }
  return products;
}

}  // namespace pcor::internal

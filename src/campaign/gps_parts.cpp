#include "campaign/gps_parts.hpp"

#include "campaign/gps_system.hpp"
#include "campaign/model_parameters.hpp"
#include "numerics/triangular_factor.hpp"

namespace pcor::internal {

std::vector<Eigen::MatrixXd> gps_products_of_parts(GpsKind kind, const FlightSamples& samples,
                                                   const ModelDefinition& model,
                                                   const std::vector<std::size_t>& used,
                                                   const std::vector<std::vector<std::size_t>>& parts) {
  const std::vector<std::size_t> law = free_parameters(model);
  ModelDefinition with_amount = model;
  with_amount.model.additions = {EffectLocation::static_defect};
  std::vector<double> all;
  for (const ModelEffect& effect : model.model.effects)
    all.insert(all.end(), effect.parameters.begin(), effect.parameters.end());
  all.push_back(0.0);  // the amount
  AddedEffects effects;
  effects.amounts_of_model = {all.size() - 1};
  effects.at.assign(parts.size(), 0);
  effects.amounts = [&](const ModelSamples&) {
    Eigen::MatrixXd amounts = Eigen::MatrixXd::Zero(as_index(samples.time.size()), as_index(parts.size()));
    for (std::size_t part = 0; part < parts.size(); ++part) {
      for (const std::size_t i : parts[part]) amounts(as_index(i), as_index(part)) = 1.0;
    }
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
    Eigen::MatrixXd own(rows.rows(), gps_shared_nuisances + 3);
    own << rows.middleCols(rows.cols() - 1 - gps_shared_nuisances, gps_shared_nuisances), of_parts.col(0),
        of_parts.col(part), rows.rightCols(1);
    products.emplace_back(own.transpose() * own);
  }
  return products;
}

}  // namespace pcor::internal

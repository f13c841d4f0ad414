#include "improve/average.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <string>

#include "improve/model_trials.hpp"
#include "numerics/missing.hpp"
#include "numerics/triangular_factor.hpp"

namespace pcor::internal {
namespace {

std::vector<std::string> names_of(const ModelFile& model) {
  std::vector<std::string> names;
  for (const ModelEffect& effect : model.model.effects) {
    for (const std::string& name : parameter_names(effect)) names.push_back(effect.id + "." + name);
  }
  return names;
}

Eigen::VectorXd values_in(const ModelFile& model, const ModelFile& whole) {
  const std::vector<double> values = coefficients_in(model, whole);
  return Eigen::Map<const Eigen::VectorXd>(values.data(), as_index(values.size()));
}

/// The covariance of a model's coefficients among those of a union; zero for those that it does not have.
Eigen::MatrixXd covariance_in(const ModelFile& model, const std::vector<std::string>& names) {
  const std::vector<std::string> own = names_of(model);
  const std::vector<double> covariance = uncertainty_of(model).covariance;
  std::vector<Eigen::Index> places;
  for (const std::string& name : own)
    places.push_back(std::find(names.begin(), names.end(), name) - names.begin());
  Eigen::MatrixXd result = Eigen::MatrixXd::Zero(as_index(names.size()), as_index(names.size()));
  for (std::size_t i = 0; i < own.size(); ++i) {
    for (std::size_t j = 0; j < own.size(); ++j)
      result(places[i], places[j]) = covariance[i * own.size() + j];
  }
  return result;
}

/// Writes coefficients and covariance into the model. Those without any variance stay out of its covariance.
void set(ModelFile& model, const Eigen::VectorXd& values, const Eigen::MatrixXd& covariance) {
  const std::vector<std::string> names = names_of(model);
  model.covariance = {};
  std::vector<Eigen::Index> inside;
  Eigen::Index place = 0;
  for (std::size_t e = 0; e < model.model.effects.size(); ++e) {
    ModelEffect& effect = model.model.effects[e];
    model.fits[e].resize(effect.parameters.size());
    for (std::size_t i = 0; i < effect.parameters.size(); ++i, ++place) {
      effect.parameters[i] = values[place];
      model.fits[e][i].standard_error.reset();
      if (!(covariance(place, place) > 0.0)) continue;
      model.fits[e][i].standard_error = std::sqrt(covariance(place, place));
      model.covariance.parameters.push_back(names[static_cast<std::size_t>(place)]);
      inside.push_back(place);
    }
  }
  for (const Eigen::Index a : inside) {
    std::vector<double>& row = model.covariance.matrix.emplace_back();
    for (const Eigen::Index b : inside) row.push_back(covariance(a, b));
  }
}

/// The weighted mean of rivals at every sample.
std::vector<double> mean_of(const std::vector<std::vector<double>>& rivals,
                            const std::vector<double>& weights) {
  std::vector<double> mean(rivals.front().size(), 0.0);
  for (std::size_t k = 0; k < rivals.size(); ++k) {
    for (std::size_t i = 0; i < mean.size(); ++i) mean[i] += weights[k] * rivals[k][i];
  }
  return mean;
}

/// The mean product over samples in which both are there; 0 where there are none.
double mean_product(const std::vector<double>& a, const std::vector<double>& b) {
  double sum = 0.0;
  double count = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    if (std::isnan(a[i]) || std::isnan(b[i])) continue;
    sum += a[i] * b[i];
    count += 1.0;
  }
  return count > 0.0 ? sum / count : 0.0;
}

}  // namespace

ModelFile averaged(const ModelFile& best, const std::vector<Mixture>& mixtures) {
  std::vector<ModelFile> all{best};
  for (const Mixture& mixture : mixtures) {
    for (const WeighedModel& each : mixture.rivals) all.push_back(each.model);
  }
  ModelFile whole = union_of(all);
  const std::vector<std::string> names = names_of(whole);
  const auto size = as_index(names.size());
  const Eigen::VectorXd start = values_in(best, whole);
  Eigen::VectorXd values = start;
  Eigen::MatrixXd covariance = Eigen::MatrixXd::Zero(size, size);
  for (const Mixture& mixture : mixtures) {
    const Eigen::VectorXd without = mixture.share < 1.0 ? values_in(mixture.without, whole) : start;
    Eigen::VectorXd delivered = (1.0 - mixture.share) * without;
    for (const WeighedModel& each : mixture.rivals)
      delivered += mixture.share * each.weight * values_in(each.model, whole);
    for (const WeighedModel& each : mixture.rivals) {
      const Eigen::VectorXd off = values_in(each.model, whole) - delivered;
      covariance += each.weight * (off * off.transpose() +
                                   covariance_in(each.model, names) / static_cast<double>(mixtures.size()));
    }
    values += delivered - start;
  }
  set(whole, values, covariance);
  for (std::size_t e = 0; e < whole.model.effects.size(); ++e) {
    const std::string& effect = whole.model.effects[e].id;
    const bool in_all =
        std::all_of(all.begin(), all.end(), [&effect](const ModelFile& model) { return has(model, effect); });
    if (in_all) continue;
    for (ParameterFit& parameter : whole.fits[e]) parameter.fixed = true;
  }
  return whole;
}

double harmless_share(const std::vector<std::vector<double>>& rivals, const std::vector<double>& weights,
                      double tolerance) {
  const std::vector<double> mean = mean_of(rivals, weights);
  const double size = mean_product(mean, mean);
  double share = 1.0;
  if (size == 0.0) return share;
  for (const std::vector<double>& rival : rivals) {
    // The largest root of |share * mean - rival| = |rival| + tolerance.
    const double along = mean_product(mean, rival);
    const double slack = tolerance * (2.0 * std::sqrt(mean_product(rival, rival)) + tolerance);
    share = std::min(share, std::max(0.0, (along + std::sqrt(along * along + size * slack)) / size));
  }
  return share;
}

double spread_of(const std::vector<std::vector<double>>& rivals, const std::vector<double>& weights) {
  const std::vector<double> mean = mean_of(rivals, weights);
  double square = 0.0;
  for (std::size_t k = 0; k < rivals.size(); ++k) {
    std::vector<double> off = rivals[k];
    for (std::size_t i = 0; i < off.size(); ++i) off[i] -= mean[i];
    square += weights[k] * mean_product(off, off);
  }
  return std::sqrt(square);
}

}  // namespace pcor::internal

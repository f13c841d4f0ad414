#include "fit/prior.hpp"

#include <algorithm>
#include <cmath>

#include "numerics/decompositions.hpp"
#include "numerics/triangular_factor.hpp"

namespace pcor::internal {
namespace {

void add_stated(const ModelFile& file, const std::string& prefix, const std::vector<FitParameter>& parameters,
                Eigen::MatrixXd& covariance) {
  const auto place_of = [&](const std::string& name) {
    const auto found = std::find_if(parameters.begin(), parameters.end(), [&](const FitParameter& parameter) {
      return parameter.name == prefix + name;
    });
    return as_index(static_cast<std::size_t>(found - parameters.begin()));
  };
  for (std::size_t e = 0; e < file.model.effects.size(); ++e) {
    const std::vector<std::string> names = parameter_names(file.model.effects[e]);
    for (std::size_t i = 0; i < names.size(); ++i) {
      const double error = file.fit(e, i).standard_error.value_or(0.0);
      const Eigen::Index place = place_of(file.model.effects[e].id + "." + names[i]);
      if (place < covariance.rows()) covariance(place, place) = error * error;
    }
  }
  const std::vector<std::string>& names = file.covariance.parameters;
  for (std::size_t a = 0; a < names.size(); ++a) {
    for (std::size_t b = 0; b < names.size(); ++b) {
      const Eigen::Index row = place_of(names[a]);
      const Eigen::Index column = place_of(names[b]);
      if (row < covariance.rows() && column < covariance.cols())
        covariance(row, column) = file.covariance.matrix[a][b];
    }
  }
}

}  // namespace

Eigen::MatrixXd stated_covariance(const ModelFile& model, const Reference& reference,
                                  const std::vector<FitParameter>& parameters) {
  const Eigen::Index size = as_index(parameters.size());
  Eigen::MatrixXd covariance = Eigen::MatrixXd::Zero(size, size);
  add_stated(model, "", parameters, covariance);
  if (reference.model() != nullptr) add_stated(*reference.model(), "reference:", parameters, covariance);
  return covariance;
}

Eigen::MatrixXd prior_rows(const FitTask& task, const std::vector<std::size_t>& wanted) {
  const Eigen::Index size = as_index(wanted.size());
  if (!task.uses_prior()) return Eigen::MatrixXd(0, size);
  Eigen::MatrixXd rows = Eigen::MatrixXd::Zero(size, size);
  std::vector<Eigen::Index> stated;
  for (Eigen::Index k = 0; k < size; ++k) {
    const std::size_t parameter = wanted[static_cast<std::size_t>(k)];
    const double typical = task.parameters[parameter].typical;
    if (task.doubt(as_index(parameter), as_index(parameter)) > 0.0) {
      stated.push_back(k);
    } else if (typical > 0.0) {
      rows(k, k) = 1.0 / typical;
    }
  }
  if (stated.empty()) return rows;
  std::vector<std::size_t> places;
  for (const Eigen::Index k : stated) places.push_back(wanted[static_cast<std::size_t>(k)]);
  const Eigen::MatrixXd covariance = task.doubt(places, places);
  // The inverse root, of the correlations: coefficients of one law may differ by powers of ten.
  const Eigen::VectorXd scale = covariance.diagonal().cwiseSqrt().cwiseInverse();
  constexpr double least_eigenvalue = 1e-10;  // what is nearly certain is not told apart from what is
  const SymmetricEigen solver = symmetric_eigen(scale.asDiagonal() * covariance * scale.asDiagonal());
  rows(stated, stated) =
      solver.eigenvalues().cwiseMax(least_eigenvalue).cwiseSqrt().cwiseInverse().asDiagonal() *
      solver.eigenvectors().transpose() * scale.asDiagonal();
  return rows;
}

}  // namespace pcor::internal

#include "model_io/covariance_blocks.hpp"

#include <cstddef>
#include <vector>

namespace pcor::internal {

Covariance part_of(const Covariance& covariance, const std::function<bool(const std::string&)>& kept) {
  std::vector<std::size_t> indices;
  for (std::size_t i = 0; i < covariance.parameters.size(); ++i) {
    if (kept(covariance.parameters[i])) indices.push_back(i);
  }
  Covariance part;
  for (const std::size_t i : indices) {
    part.parameters.push_back(covariance.parameters[i]);
    std::vector<double>& row = part.matrix.emplace_back();
    for (const std::size_t j : indices) row.push_back(covariance.matrix[i][j]);
  }
  return part;
}

void add_independent(Covariance& covariance, const Covariance& more) {
  const std::size_t before = covariance.parameters.size();
  covariance.parameters.insert(covariance.parameters.end(), more.parameters.begin(), more.parameters.end());
  for (std::vector<double>& row : covariance.matrix) row.resize(covariance.parameters.size(), 0.0);
  for (const std::vector<double>& added : more.matrix) {
    std::vector<double>& row = covariance.matrix.emplace_back(before, 0.0);
    row.insert(row.end(), added.begin(), added.end());
  }
}

}  // namespace pcor::internal

#pragma once

#include <Eigen/Dense>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace pcor::internal {

/// Directions of a group of columns.
struct Directions {
  Eigen::Index count;
  Eigen::Index degrees_of_freedom;  ///< number of directions that the other columns do not imitate
};

/// Quantile of the greatest score of all groups under noise alone, from random normal draws; scores are
/// equivalent chi2 of one degree of freedom (`chi2_one_dof`).
/// @param covariance of the scores of the directions of all groups, in order @param seed of the draws
double quantile_of_maximum(const Eigen::MatrixXd& covariance, const std::vector<Directions>& directions,
                           double probability, std::size_t draws, std::uint64_t seed);

}  // namespace pcor::internal

#pragma once

#include <Eigen/Dense>
#include <cstddef>
#include <optional>
#include <string_view>
#include <vector>

#include <pcor/model_io/model_definition.hpp>

namespace pcor::internal {

/// Number of parameters of a model: parameters of its effects, followed by one for each location of
/// additions.
std::size_t parameter_count(const Model& model);

/// Index of the first parameter of an effect among the parameters of a model; nullopt if the model lacks it.
std::optional<std::size_t> first_parameter_of(const ModelDefinition& model, std::string_view effect);

/// Indices, among all parameters of a model, of those that a diagnosis fits: neither fixed nor coefficients
/// of a surface, which are held.
std::vector<std::size_t> free_parameters(const ModelDefinition& model);

/// Covariance of the parameters of all effects from the standard errors and the covariance in the file, zero
/// if not stated.
Eigen::MatrixXd stated_covariance(const ModelDefinition& model);

}  // namespace pcor::internal

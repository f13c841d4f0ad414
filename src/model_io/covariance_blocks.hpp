#pragma once

#include <functional>
#include <string>

#include <pcor/model_io/model_definition.hpp>

namespace pcor::internal {

/// Rows and columns of the parameters that are `kept`, in their order.
Covariance part_of(const Covariance& covariance, const std::function<bool(const std::string&)>& kept);

/// Adds parameters without correlation with the existing ones: their covariances are zero.
void add_independent(Covariance& covariance, const Covariance& more);

}  // namespace pcor::internal

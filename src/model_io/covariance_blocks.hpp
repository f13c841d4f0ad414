#pragma once

#include <functional>
#include <string>

#include <pcor/model_io/model_definition.hpp>

namespace pcor::internal {

/// The rows and columns of the parameters that are `kept`, in their order.
Covariance part_of(const Covariance& covariance, const std::function<bool(const std::string&)>& kept);

/// Adds parameters that nothing ties to those that are there: with covariances of zero between both.
void add_independent(Covariance& covariance, const Covariance& more);

}  // namespace pcor::internal

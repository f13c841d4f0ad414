#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include <pcor/effects/catalogue.hpp>
#include <pcor/model_io/model_definition.hpp>
#include <pcor/physics/recovery_factor.hpp>

#include "base/quoting.hpp"

namespace pcor::internal {

/// Names that the reader and the writer of model files share.

inline constexpr std::string_view model_format = "pcor-model/1";

/// A parameter of a model.
struct NamedParameter {
  std::string name;  ///< like "static-qp.a2"
  std::size_t effect;
  std::size_t number;  ///< number among the parameters of the effect
};

/// All parameters of a model, in the order of the effects.
std::vector<NamedParameter> named_parameters(const Model& model);

/// Value of the parameter of the model with a name like "static-qp.a2"; zero, its neutral value, for the
/// coefficient of a sensor without an effect in the model.
double parameter_value(const Model& model, std::string_view name);

/// Role that a name in a formula means as the name of its variable: the first such role; `Quantity::count`
/// for the name of a quantity or of another variable.
Quantity role_of_variable(const ModelDefinition& file, std::string_view name);

/// Published recovery factor with this name, or nullptr.
const PublishedRecoveryFactor* published_recovery_factor(std::string_view name);

}  // namespace pcor::internal

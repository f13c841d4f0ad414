#pragma once

#include <cstddef>
#include <optional>
#include <string_view>
#include <vector>

#include <pcor/model_io/model_definition.hpp>

namespace pcor::internal {

/// How many parameters a model has: those of its effects, and behind them one for each place of additions.
std::size_t parameter_count(const Model& model);

/// The place of the first parameter of an effect among those of a model; nothing where the model lacks it.
std::optional<std::size_t> first_parameter_of(const ModelDefinition& model, std::string_view effect);

/// The places among all parameters of a model of those that are fitted.
std::vector<std::size_t> free_parameters(const ModelDefinition& model);

/// Where an effect acts.
EffectLocation location_of(const ModelEffect& effect);

}  // namespace pcor::internal

#pragma once

#include <cstddef>
#include <vector>

#include <pcor/laws/model_file.hpp>

namespace pcor::internal {

/// How many parameters a model has: those of its effects, and behind them one for each place of additions.
std::size_t parameter_count(const Model& model);

/// The places among all parameters of a model of those that are fitted.
std::vector<std::size_t> free_parameters(const ModelFile& model);

/// Where an effect acts.
Where where_of(const ModelEffect& effect);

}  // namespace pcor::internal

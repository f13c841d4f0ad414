#pragma once

#include <functional>

#include <pcor/improve/improve.hpp>

namespace pcor::internal {

/// What the loop of `improve` is made of, so that it can be tried without flights.
struct ImproveLoop {
  std::function<RefitResult(const ModelFile& model)> refit;
  std::function<Diagnosis(const ModelFile& model)> diagnose;
  std::function<ModelFile(const ModelFile& model, const ModelEffect& effect)> add;
  bool has_holdout = false;     ///< the refit tells of samples that are held out
  bool trace_variables = true;  ///< as in `ImproveOptions`
  std::size_t most_steps = 8;   ///< effects that are added at most
  std::string flights{};        ///< in words, for the source of a traced formula

  /// Climbs the ladder of errors from `model`. @throws Error as `refit` and `diagnose` for the model as it
  /// is.
  Improvement run(const ModelFile& model) const;
};

}  // namespace pcor::internal

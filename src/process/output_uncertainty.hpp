#pragma once

#include <initializer_list>
#include <memory>
#include <string>

#include <pcor/process/process.hpp>
#include <pcor/realtime/chain.hpp>

namespace pcor::internal {

/// Uncertainty of the results of a flight: the part of the model's uncertainty that the options request.
class OutputUncertainty {
 public:
  /// @throws Error if a requested part is not stated.
  OutputUncertainty(const ModelDefinition& model, std::shared_ptr<const Chain> chain,
                    const ProcessOptions& options);

  const ModelUncertainty& stated() const { return stated_; }

  /// Whether an error of delta-p is stated, or uncertainties without it were requested.
  bool states_defect_error() const;

  /// Adds notes on the contributions that are not included.
  void note_unstated(const ModelDefinition& model, Notes& notes) const;

  /// Comment of the uncertainty variables.
  std::string comment() const;

 private:
  /// Whether an uncertainty is stated of a coefficient at one of the locations, or of one of the roles.
  bool states(std::initializer_list<EffectLocation> locations, std::initializer_list<Quantity> roles) const;

  std::shared_ptr<const Chain> chain_;
  UncertaintyPart part_;
  CorrectWith correct_with_;
  ModelUncertainty stated_;
};

}  // namespace pcor::internal

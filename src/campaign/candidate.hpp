#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include <pcor/model_io/model_definition.hpp>
#include <pcor/residuals/reference.hpp>

namespace pcor::internal {

/// Standard deviation of the size of an effect in nature, in units of its typical size.
inline constexpr double spread_of_sizes = 3.0;

/// Tested parameter of a candidate.
struct CandidateParameter {
  std::size_t index = 0;  ///< index among the parameters of its effect
  std::string name;
  std::string unit;
  double typical = 0.0;  ///< 0 if unknown
  Bounds bounds{};       ///< physical bounds, as a change from the neutral value
};

/// Effect that the model, or the model of the reference system, may lack.
struct Candidate {
  ModelEffect effect;      ///< the effect, with neutral parameters and tested shapes
  std::string id;          ///< id as in a finding
  std::size_t number = 0;  ///< number of the effect in the extended model
  /// Effect on the system of each reference: its number in the extended model of that system, nullopt if
  /// absent. Empty for an effect on the model's system.
  std::vector<std::optional<std::size_t>> numbers_in_others{};
  std::string system{};  ///< name of the other system, if the references have several: "PSFRD+QCFR";
                         ///< otherwise empty
  /// Time constant of the history of its input (`EffectInfo::memory`), s.
  double memory = 0.0;
  /// Common mode of both systems: a comparison of the two systems is insensitive to it.
  bool is_shared = false;
  std::string title;
  std::vector<CandidateParameter> tested{};
  bool is_variant = false;  ///< another shape of an earlier candidate

  bool is_of_reference() const { return !numbers_in_others.empty(); }
  /// Whether the reference is sensitive to its system. For an effect on the model's system only the first
  /// reference counts, which determines all statistics; for an effect on another system, the references with
  /// that system.
  bool is_measured_by(std::size_t reference) const {
    return is_of_reference() ? numbers_in_others[reference].has_value() : reference == 0;
  }
};

/// Coefficient that is fitted with every candidate.
struct BaseCoefficient {
  std::string name;  ///< name like "static-qp.a2" or "reference:static-qp.a2"
  std::string unit;
  double value = 0.0;  ///< value in its model
  Bounds bounds{};
  bool of_reference = false;
  double typical = 0.0;  ///< typical size in its unit; 0 if unknown
};

/// Candidates, and the models extended by them.
struct CandidateModels {
  /// Model extended by every candidate, with the variables that the candidates require.
  ModelDefinition extended;
  /// References, each with the variables that candidates on its system require.
  References references{};
  /// Model of each reference, extended by every candidate on its system; nullopt without a model.
  std::vector<std::optional<ModelDefinition>> others{};
  std::vector<std::size_t> effects_of_others{};  ///< number of effects in the model of each reference without
                                                 ///< candidates
  std::vector<BaseCoefficient> base{};
  /// Index of the first base coefficient of each reference's model.
  std::vector<std::size_t> base_of_others{};
  std::vector<Candidate> candidates{};

  /// First column of a candidate among all columns, which has one for each tested parameter. @param candidate
  /// its number; the number of candidates gives the number of columns
  std::size_t first_column(std::size_t candidate) const {
    std::size_t first = 0;
    for (std::size_t c = 0; c < candidate; ++c) first += candidates[c].tested.size();
    return first;
  }
};

}  // namespace pcor::internal

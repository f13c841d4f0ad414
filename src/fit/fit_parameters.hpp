#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include <pcor/fit/refit.hpp>

namespace pcor::internal {

/// Known properties of a parameter before the fit.
struct FitParameter {
  std::string name{};    ///< like "static-qp.a2"; of the reference's model "reference:static-qp.a2"
  std::string effect{};  ///< effect of the parameter, with the prefix of the reference
  std::string unit{};
  double start = 0.0;    ///< its value in the file
  double neutral = 0.0;  ///< value that disables the effect
  double typical = 0.0;  ///< size; zero if the catalogue has no typical size
  std::string_view manoeuvre{};
  std::vector<double> tried{};  ///< other possible values of a time over which a need is estimated
  Bounds bounds{};
  bool fixed = false;
};

/// The parameters of the model, then those of a static system that is the reference, in the order of
/// `residual`. @throws Error if the options name an unknown parameter, or bounds are empty.
std::vector<FitParameter> fit_parameters(const ModelDefinition& model, const Reference& reference,
                                         const RefitOptions& options);

/// Indices of the parameters that each stage fits; the last stage fits the remaining ones, possibly no
/// parameter.
/// @throws Error if no parameter is free, or a stage names one that is not.
std::vector<std::vector<std::size_t>> fit_stages(const std::vector<FitParameter>& parameters,
                                                 const std::vector<FitStage>& stages,
                                                 const std::string& model_name);

}  // namespace pcor::internal

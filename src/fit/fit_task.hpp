#pragma once

#include <Eigen/Dense>
#include <cstddef>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include <pcor/fit/refit.hpp>
#include "fit/surface_roughness.hpp"
#include "parallel/workers.hpp"

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
  std::vector<double> tried{};  ///< values of a time constant from which the fit is started, too
  Bounds bounds{};
  bool fixed = false;
};

/// Input shared by all steps of a fit.
struct FitTask {
  const ModelDefinition& model;
  const Reference& reference;
  const RefitOptions& options;
  const FlightSet& flights;
  /// The parameters of the model, then those of a static system that is the reference, in the order of
  /// `Residuals::parameters`.
  std::vector<FitParameter> parameters{};
  Eigen::VectorXd start{};                  ///< their values in the files
  Eigen::MatrixXd stated_covariance{};      ///< covariance in the files; zero if not stated
  std::function<void()> report_progress{};  ///< called after every pass over the flights
  /// Fit tasks of the further references; these have no further references.
  std::vector<FitTask> further{};
  /// Whether the parameters after those of the model also belong to this reference's system. A system that
  /// only a further reference reads keeps the values of its file.
  bool shares_system = true;

  Eigen::VectorXd lower{};  ///< bounds of each parameter
  Eigen::VectorXd upper{};

  /// The prior of each surface of the model, of which the fit finds the size.
  std::vector<SurfaceRoughness> surfaces{};

  /// The surface of which the parameter is a coefficient; null for other parameters.
  const SurfaceRoughness* surface_of(std::size_t parameter) const {
    for (const SurfaceRoughness& surface : surfaces) {
      if (surface.has(parameter)) return &surface;
    }
    return nullptr;
  }

  /// Flights at a time, in one process.
  std::size_t threads() const { return Workers(flights.comm(), options.threads).threads; }

  bool uses_prior() const { return options.use_prior || options.fit_reference; }
};

/// The task of a fit of the model with its references; the first one is also fitted if the options request
/// it. The task refers to the arguments.
/// @throws Error if the options name an unknown parameter, or bounds are empty.
FitTask fit_task(const ModelDefinition& model, const References& references, const RefitOptions& options,
                 const FlightSet& flights);

/// Indices of the parameters that each stage fits; the last stage fits the remaining ones, possibly no
/// parameter.
/// @throws Error if no parameter is free, or a stage names one that is not.
std::vector<std::vector<std::size_t>> fit_stages(const FitTask& task);

/// Current result of a fit.
struct Solution {
  Eigen::VectorXd values{};      ///< one per parameter
  std::vector<bool> at_bound{};  ///< one per parameter
  double deviation = 1.0;        ///< robust deviation of the innovations
};

}  // namespace pcor::internal

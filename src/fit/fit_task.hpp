#pragma once

#include <Eigen/Dense>
#include <functional>
#include <vector>

#include "fit/fit_parameters.hpp"
#include "fit/surface_roughness.hpp"
#include "parallel/flight_partition.hpp"
#include "parallel/workers.hpp"

namespace pcor::internal {

/// Input shared by all steps of a fit.
struct FitTask {
  const ModelDefinition& model;
  const Reference& reference;
  const RefitOptions& options;
  const FlightSet& flights;
  std::vector<FitParameter> parameters;
  Eigen::VectorXd start;       ///< their values in the files
  Eigen::MatrixXd doubt;       ///< covariance of these values stated in the files; zero if not stated
  std::function<void()> tell;  ///< called after every pass over the flights
  /// Fit tasks of the further references; these have no further references.
  std::vector<FitTask> further{};
  /// Whether the parameters after those of the model also belong to this reference's system. A system that
  /// only a further reference reads keeps the values of its file.
  bool shares_system = true;

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

/// Current result of a fit.
struct Solution {
  Eigen::VectorXd values{};      ///< one per parameter
  std::vector<bool> at_bound{};  ///< one per parameter
  double deviation = 1.0;        ///< robust deviation of the innovations
};

}  // namespace pcor::internal

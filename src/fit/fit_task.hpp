#pragma once

#include <Eigen/Dense>
#include <functional>
#include <vector>

#include "fit/fit_parameters.hpp"
#include "fit/surface_roughness.hpp"
#include "parallel/flight_partition.hpp"
#include "parallel/workers.hpp"

namespace pcor::internal {

/// What all steps of a fit share.
struct FitTask {
  const ModelDefinition& model;
  const Reference& reference;
  const RefitOptions& options;
  const FlightSet& flights;
  std::vector<FitParameter> parameters;
  Eigen::VectorXd start;  ///< their values in the files
  Eigen::MatrixXd doubt;  ///< the covariance of these values as the files state it; zero where they do not
  std::function<void()> tell;  ///< to be called after every pass over the flights
  /// The same fit with each of the further references; without such of their own.
  std::vector<FitTask> further{};
  /// Whether the parameters after those of the model are of this reference's system, too. Those of a system
  /// that only a further reference reads stay as its file has them.
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

/// What a fit has found so far.
struct Solution {
  Eigen::VectorXd values{};      ///< of all parameters
  std::vector<bool> at_bound{};  ///< of all parameters
  double deviation = 1.0;        ///< robust, of the innovations
};

}  // namespace pcor::internal

#pragma once

#include <Eigen/Dense>
#include <array>
#include <cstddef>
#include <filesystem>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include <pcor/numerics/noise.hpp>
#include <pcor/residuals/residuals.hpp>
#include "fit/fit_task.hpp"
#include "numerics/triangular_factor.hpp"

namespace ceres {
class LossFunction;
}

namespace pcor::internal {

/// Passes over a flight take so many samples at a time, which fit into the processor's cache.
inline constexpr std::size_t samples_per_chunk = 1024;

/// Where a flight of a fit comes from: a file, or memory.
struct FlightSource {
  std::filesystem::path path{};
  std::shared_ptr<const FlightSamples> samples{};
};

/// What a stage of a fit takes from the flights.
struct FitSetup {
  Eigen::VectorXd values{};           ///< of all parameters, from which it goes on
  std::vector<std::size_t> wanted{};  ///< the parameters that are fitted
  std::vector<Regime> regimes{};      ///< only samples of these take part, where there are any
  bool with_offsets = false;          ///< every interval of these regimes has its own offset of delta-p/p
};

/// One flight of a fit: the samples that take part, their weights, and their residuals and derivatives.
class FitFlight {
 public:
  FitFlight(std::shared_ptr<const FlightSamples> samples, const FitTask& task, const FitSetup& setup);

  const Residuals& residuals() const { return residuals_; }
  const std::vector<std::size_t>& kept() const { return kept_; }
  std::size_t offsets() const { return offset_count_; }

  /// The residuals of the samples that take part. @param offsets those of this flight
  std::vector<double> values(const Eigen::VectorXd& parameters, const double* offsets) const;

  /// Residuals and derivatives of consecutive kept samples, by columns: those of the wanted parameters, of
  /// all offsets of the fit, and the residual, hPa. They point into the flight or into `store`.
  struct Rows {
    std::vector<const double*> columns{};
    std::vector<double> store{};
    const double* residual() const { return columns.back(); }
  };

  /// Puts `count` of the kept samples from `first` on into `rows`. @param offsets of all flights, those of
  /// this one from `first_offset` on
  void evaluate(std::size_t first, std::size_t count, const Eigen::VectorXd& parameters,
                const Eigen::VectorXd& offsets, std::size_t first_offset, Rows& rows) const;

  double static_pressure(std::size_t kept) const { return (*static_pressure_)[kept_[kept]]; }

  /// Measures the noise of the residuals at `parameters`, which becomes the weight of the samples.
  void measure_noise(const Eigen::VectorXd& parameters, const double* offsets);
  double noise(std::size_t kept) const { return noise_.empty() ? 1.0 : static_cast<double>(noise_[kept]); }

  /// Keeps derivatives, where the residual is linear in all that is wanted.
  void keep_derivatives();

 private:
  /// Through the chain; for LAMS, where some effect is not at the static ports, in the laser's own measure.
  void evaluate_now(std::size_t first, std::size_t count, const Eigen::VectorXd& parameters,
                    const std::vector<std::size_t>& wanted, double* residual, double* derivatives) const;
  void find_residuals(std::size_t first, std::size_t count, const Eigen::VectorXd& parameters,
                      const double* offsets, double* residual) const;

  const FitTask* task_;
  const FitSetup* setup_;
  Residuals residuals_;
  const std::vector<double>* static_pressure_;  // of the samples
  std::vector<std::size_t> kept_;
  std::vector<int> offset_;
  std::size_t offset_count_ = 0;
  std::vector<float> noise_;  // weights need no more digits
  bool linear_ = false;
  std::vector<double> kept_residual_;     // at `kept_parameters_`
  std::vector<double> kept_derivatives_;  // columns
  Eigen::VectorXd kept_parameters_;
};

/// What a pass over all flights gives.
struct Reduction {
  Eigen::MatrixXd factor;  ///< of rows (derivatives by wanted parameters and offsets, residual), weighted
  double cost = 0.0;       ///< half the sum of the loss
  /// The curvature of the loss over its slope, rho' + 2 s rho'' over rho', mean over the samples: by so much
  /// the second derivative of the cost is less than that of the weighted squares.
  double curvature = 1.0;
  std::size_t samples = 0;
  bool valid = true;  ///< false where some residual is not a number at these parameters
};

/// The flights of a fit. Passes over them run several flights at a time; their results are added in the order
/// of the flights, so they do not depend on the number of threads.
class FitFlights {
 public:
  FitFlights(std::vector<FlightSource> sources, const FitTask& task, FitSetup setup);
  FitFlights(const FitFlights&) = delete;
  FitFlights& operator=(const FitFlights&) = delete;

  const FitTask& task() const { return task_; }
  const FitSetup& setup() const { return setup_; }

  std::size_t count() const { return sources_.size(); }

  /// What a flight is called.
  std::string name(std::size_t number) const {
    const FlightSource& source = sources_[number];
    return source.samples ? source.samples->name : source.path.string();
  }

  /// For each of the parameters whether the residual is linear in it.
  const std::vector<bool>& is_linear() const { return linear_; }
  std::size_t samples() const { return samples_; }
  std::size_t offsets() const { return offsets_; }
  const std::array<std::size_t, mask_count>& masks() const { return masks_; }

  /// Visits every flight; `visit` is called by several threads, with the number of the flight and of its
  /// first offset.
  void visit(const std::function<void(std::size_t flight, std::size_t first_offset, FitFlight& fit)>& visit);

  Reduction reduce(const Eigen::VectorXd& parameters, const Eigen::VectorXd& offsets,
                   const ceres::LossFunction* loss);

  /// The factor of rows (derivatives, residual) in hPa, all samples alike.
  Eigen::MatrixXd unweighted_factor(const Eigen::VectorXd& parameters);

  /// Measures the noise of every flight, which weights its samples from now on.
  void measure_noise(const Eigen::VectorXd& parameters, const Eigen::VectorXd& offsets);

  /// The robust deviation of the weighted residuals.
  double deviation(const Eigen::VectorXd& parameters, const Eigen::VectorXd& offsets);

 private:
  std::shared_ptr<const FlightSamples> samples_of(std::size_t number) const;
  std::shared_ptr<FitFlight> made(std::size_t number, std::shared_ptr<const FlightSamples> samples);

  std::vector<FlightSource> sources_;
  const FitTask& task_;
  const FitSetup setup_;  // the flights in the cache point to it
  std::vector<std::shared_ptr<FitFlight>> cache_;
  std::vector<std::size_t> first_offset_;
  std::mutex counting_;
  std::size_t cached_bytes_ = 0;
  std::vector<bool> linear_;
  std::size_t samples_ = 0;
  std::size_t offsets_ = 0;
  std::array<std::size_t, mask_count> masks_{};
  Eigen::VectorXd noise_parameters_;
  Eigen::VectorXd noise_offsets_;
};

}  // namespace pcor::internal

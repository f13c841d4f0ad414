#include "fit/minimise.hpp"

#include <ceres/cost_function.h>
#include <ceres/problem.h>
#include <ceres/solver.h>
#include <glog/logging.h>

#include <algorithm>
#include <cmath>

#include <pcor/base/error.hpp>

namespace pcor::internal {
namespace {

using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// Suppresses Ceres messages about failed trials on standard error; its summary has the relevant information.
class QuietLog {
 public:
  QuietLog() : before_(FLAGS_minloglevel) { FLAGS_minloglevel = google::GLOG_FATAL; }
  ~QuietLog() { FLAGS_minloglevel = before_; }
  QuietLog(const QuietLog&) = delete;
  QuietLog& operator=(const QuietLog&) = delete;

 private:
  int before_;
};

/// All flights as one residual block of a few rows: the triangular factor of the weighted derivatives and
/// residuals has the same gradient and the same normal matrix as all samples, and the last row brings the
/// cost to that of the loss.
class ReducedCost final : public ceres::CostFunction {
 public:
  ReducedCost(FitFlights& flights, const Eigen::VectorXd& parameters, const ScaledLoss& loss)
      : flights_(flights),
        parameters_(parameters),
        loss_(loss),
        size_(as_index(flights.setup().wanted.size())) {
    set_num_residuals(static_cast<int>(size_) + 1);
    mutable_parameter_block_sizes()->push_back(static_cast<int>(size_));
  }

  bool Evaluate(double const* const* blocks, double* residuals, double** jacobians) const override {
    const Eigen::Map<const Eigen::VectorXd> x(blocks[0], size_);
    if (last_.size() == 0 || last_ != x) {
      parameters_(flights_.setup().wanted) = x;
      reduction_ = flights_.reduce(parameters_, loss_);
      last_ = x;
      flights_.task().tell();
    }
    if (!reduction_.valid) return false;
    Eigen::Map<Eigen::VectorXd> all(residuals, size_ + 1);
    all.head(size_) = reduction_.factor.col(size_).head(size_);
    // Curvature of the loss makes a step nearly Newton's. Gradient and cost are unchanged; far from the
    // minimum, where the curvature is not usable, the weighted squares are used alone.
    double segment = std::sqrt(std::clamp(reduction_.curvature, 0.1, 1.0));
    if (all.head(size_).squaredNorm() > 2.0 * reduction_.cost * segment * segment) segment = 1.0;
    all.head(size_) /= segment;
    const double rest = 2.0 * reduction_.cost - all.head(size_).squaredNorm();
    all[size_] = std::sqrt(std::max(rest, 0.0));
    if (jacobians != nullptr && jacobians[0] != nullptr) {
      Eigen::Map<RowMajor> jacobian(jacobians[0], size_ + 1, size_);
      jacobian.setZero();
      jacobian.topRows(size_) = segment * reduction_.factor.topLeftCorner(size_, size_);
    }
    return true;
  }

 private:
  FitFlights& flights_;
  mutable Eigen::VectorXd parameters_;
  const ScaledLoss& loss_;
  Eigen::Index size_;
  mutable Eigen::VectorXd last_;
  mutable Reduction reduction_;
};

/// Prior residuals of the unknowns about their starts.
class PriorCost final : public ceres::CostFunction {
 public:
  explicit PriorCost(const Prior& prior) : prior_(prior) {
    set_num_residuals(static_cast<int>(prior.rows.rows()));
    mutable_parameter_block_sizes()->push_back(static_cast<int>(prior.rows.cols()));
  }

  bool Evaluate(double const* const* blocks, double* residuals, double** jacobians) const override {
    const Eigen::Map<const Eigen::VectorXd> x(blocks[0], prior_.start.size());
    Eigen::Map<Eigen::VectorXd>(residuals, prior_.rows.rows()) = prior_.rows * (x - prior_.start);
    if (jacobians == nullptr || jacobians[0] == nullptr) return true;
    Eigen::Map<RowMajor>(jacobians[0], prior_.rows.rows(), prior_.rows.cols()) = prior_.rows;
    return true;
  }

 private:
  const Prior& prior_;
};

}  // namespace

void minimise(FitFlights& flights, const Eigen::VectorXd& parameters, const ScaledLoss& loss,
              const Prior& prior, Eigen::VectorXd& x) {
  ceres::Problem problem;
  problem.AddParameterBlock(x.data(), static_cast<int>(x.size()));
  problem.AddResidualBlock(new ReducedCost(flights, parameters, loss), nullptr, x.data());
  if (prior.rows.rows() > 0) problem.AddResidualBlock(new PriorCost(prior), nullptr, x.data());
  int place = 0;
  for (const std::size_t p : flights.setup().wanted) {
    const Bounds& bounds = flights.task().parameters[p].bounds;
    if (std::isfinite(bounds.lower)) problem.SetParameterLowerBound(x.data(), place, bounds.lower);
    if (std::isfinite(bounds.upper)) problem.SetParameterUpperBound(x.data(), place, bounds.upper);
    ++place;
  }
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::DENSE_QR;
  // The problem is linear or nearly so: the first step may reach the solution.
  options.initial_trust_region_radius = 1e12;
  options.max_num_iterations = 200;
  options.function_tolerance = 1e-12;
  options.parameter_tolerance = 1e-9;
  options.gradient_tolerance = 1e-14;
  options.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  {
    const QuietLog quiet;
    ceres::Solve(options, &problem, &summary);
  }
  if (!summary.IsSolutionUsable() || !x.allFinite()) {
    throw Error(
        "the fit found no coefficients: from their values in the model the residuals are not numbers; give "
        "other starting values, or look for them with --search");
  }
}

}  // namespace pcor::internal

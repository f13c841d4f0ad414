#include "fit/minimise.hpp"

#include <ceres/cost_function.h>
#include <ceres/normal_prior.h>
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
  ReducedCost(const LossProblem& problem, Eigen::Index size) : problem_(problem), size_(size) {
    set_num_residuals(static_cast<int>(size) + 1);
    mutable_parameter_block_sizes()->push_back(static_cast<int>(size));
  }

  bool Evaluate(double const* const* blocks, double* residuals, double** jacobians) const override {
    const Eigen::Map<const Eigen::VectorXd> x(blocks[0], size_);
    const Reduction reduction = problem_.reduce(x);
    if (!reduction.valid) return false;
    Eigen::Map<Eigen::VectorXd> all(residuals, size_ + 1);
    all.head(size_) = reduction.factor.col(size_).head(size_);
    const double rest = 2.0 * reduction.cost - all.head(size_).squaredNorm();
    all[size_] = std::sqrt(std::max(rest, 0.0));
    if (jacobians != nullptr && jacobians[0] != nullptr) {
      Eigen::Map<RowMajor> jacobian(jacobians[0], size_ + 1, size_);
      jacobian.setZero();
      jacobian.topRows(size_) = reduction.factor.topLeftCorner(size_, size_);
    }
    return true;
  }

 private:
  const LossProblem& problem_;
  Eigen::Index size_;
};

}  // namespace

void minimise(const LossProblem& problem, Eigen::VectorXd& x) {
  ceres::Problem solved;
  solved.AddParameterBlock(x.data(), static_cast<int>(x.size()));
  solved.AddResidualBlock(new ReducedCost(problem, x.size()), nullptr, x.data());
  if (problem.prior_rows.rows() > 0) {
    solved.AddResidualBlock(new ceres::NormalPrior(problem.prior_rows, problem.prior_centre), nullptr,
                            x.data());
  }
  for (Eigen::Index k = 0; k < x.size(); ++k) {
    const int position = static_cast<int>(k);
    if (std::isfinite(problem.lower[k])) solved.SetParameterLowerBound(x.data(), position, problem.lower[k]);
    if (std::isfinite(problem.upper[k])) solved.SetParameterUpperBound(x.data(), position, problem.upper[k]);
  }
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::DENSE_QR;
  // The problem is nearly linear: the first step may reach the solution.
  options.initial_trust_region_radius = 1e12;
  options.max_num_iterations = 200;
  options.function_tolerance = 1e-12;
  options.parameter_tolerance = 1e-9;
  options.gradient_tolerance = 1e-14;
  options.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  {
    const QuietLog quiet;
    ceres::Solve(options, &solved, &summary);
  }
  if (!summary.IsSolutionUsable() || !x.allFinite()) {
    throw Error(Error::Code::fit,
                "the residuals are not finite at the starting coefficients of the model; give other starting "
                "values, or use --search");
  }
}

}  // namespace pcor::internal

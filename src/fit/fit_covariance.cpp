#include "fit/fit_covariance.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include <pcor/numerics/noise.hpp>
#include "fit/prior.hpp"
#include "numerics/decompositions.hpp"
#include "numerics/missing.hpp"
#include "numerics/noise_covariance.hpp"

namespace pcor::internal {
namespace {

constexpr std::size_t min_flights = 8;  // minimum number for omitting whole flights
constexpr double parts = 20.0;          // otherwise number of parts of all flights together
constexpr double min_part = 120.0;      // s

/// Minimum number of bins for variance and correlation of the influence from the data; with fewer bins,
/// normal innovations are assumed.
constexpr Eigen::Index enough_bins = 200;

/// Means of the loss over normal innovations: of rho' + 2 s rho'' and of the square of the influence.
struct NormalLoss {
  double slope = 0.0;
  double square = 0.0;

  NormalLoss(const ScaledLoss& loss, double deviation) {
    constexpr double step = 0.05;
    double weight = 0.0;
    for (double z = -6.0; z <= 6.0; z += step) {
      const double density = std::exp(-0.5 * z * z);
      const double innovation = deviation * z;
      const std::array<double, 3> rho = loss(innovation);
      weight += density;
      slope += density * (rho[1] + 2.0 * innovation * innovation * rho[2]);
      square += density * rho[1] * rho[1] * innovation * innovation;
    }
    slope /= weight;
    square /= weight;
  }
};

/// Flights, or parts of flights, omitted one at a time: blocks are numbered per flight, after those of the
/// flights before it.
class Blocks {
 public:
  explicit Blocks(FitFlights& flights) : begin_(flights.count(), 0.0), count_(flights.count(), 1) {
    const auto spans = flights.of_each([](std::size_t, FitFlight& fit) {
      const std::vector<double>& time = fit.bins().time();
      return time.empty() ? std::pair(0.0, 0.0) : std::pair(time.front(), time.back() - time.front());
    });
    double all = 0.0;
    for (const auto& [begin, length] : spans) all += length;
    length_ = flights.count() >= min_flights ? infinity : std::max(all / parts, min_part);
    for (std::size_t f = 0; f < flights.count(); ++f) {
      begin_[f] = spans[f].first;
      count_[f] += static_cast<std::size_t>(spans[f].second / length_);
    }
  }

  /// Number of blocks of all flights, and of one flight.
  std::size_t count() const { return std::accumulate(count_.begin(), count_.end(), std::size_t{0}); }
  std::size_t count(std::size_t flight) const { return count_[flight]; }

  std::size_t operator()(std::size_t flight, double time) const {
    const double place = std::max((time - begin_[flight]) / length_, 0.0);
    return std::min(static_cast<std::size_t>(place), count_[flight] - 1);
  }

 private:
  double length_ = infinity;  // s
  std::vector<double> begin_;
  std::vector<std::size_t> count_;
};

/// Sums over the bins of a block.
struct BlockSums {
  Eigen::MatrixXd derivatives;  ///< derivatives of the scores by all parameters
  Eigen::VectorXd score;

  template <class Archive>
  void serialize(Archive& archive) {
    archive(derivatives, score);
  }
};

/// Sums over the bins of one set of equations, of a flight or of all.
struct Sums {
  std::vector<BlockSums> blocks;
  Eigen::MatrixXd covariance;  ///< scores of all equations by the noise; nonzero for the last ones only
  Eigen::MatrixXd misfit;      ///< derivatives of the sum of the scores by the misfit of the law
  Eigen::MatrixXd
      doubt;  ///< derivatives by the uncertainties of the reference, each by one standard uncertainty

  /// Adds sums without blocks.
  void add(const Sums& other) {
    covariance += other.covariance;
    misfit += other.misfit;
    doubt += other.doubt;
  }

  template <class Archive>
  void serialize(Archive& archive) {
    archive(blocks, covariance, misfit, doubt);
  }
};

/// Uncertainties of all references of a fit, by name: a thermometer error is common to all of them.
std::vector<std::string> doubts_of(FitFlights& flights) {
  std::vector<std::string> names;
  for (const FitFlights* const each : flights.joint()) {
    for (const std::string& name : each->doubt().names()) {
      if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
    }
  }
  return names;
}

/// Weights of a stage's scores in the bins of a flight.
struct StageScores {
  Eigen::Index first;  // first of its parameters among all
  std::vector<double> time;
  Eigen::MatrixXd columns;
};

/// Columns of all equations in the bins of the last ones, which include the bins of each stage.
Eigen::MatrixXd joined(const std::vector<StageScores>& stages, const std::vector<double>& time,
                       const Eigen::MatrixXd& last, Eigen::Index fitted) {
  Eigen::MatrixXd all = Eigen::MatrixXd::Zero(last.rows(), fitted);
  all.rightCols(last.cols()) = last;
  for (const StageScores& stage : stages) {
    for (std::size_t i = 0; i < stage.time.size(); ++i) {
      // Middles of bins differ by less than half the width if other samples are used.
      auto bin = std::lower_bound(time.begin(), time.end(), stage.time[i] - 0.5 * Binning::usual_width);
      if (bin == time.end() || *bin > stage.time[i] + Binning::usual_width) continue;
      all.block(bin - time.begin(), stage.first, 1, stage.columns.cols()) += stage.columns.row(as_index(i));
    }
  }
  return all;
}

/// Common input of the sums over all references and equations.
struct ScoreContext {
  const std::vector<std::size_t>& all;  // the parameters of all equations and those that are held
  Eigen::Index fitted;                  // number of parameters in equations
  const Blocks& blocks;
  const Misfit& misfit;
  const MisfitBasis& misfit_columns;
  const FitEquations* last;
  std::vector<std::string> doubts;
  std::vector<std::vector<StageScores>> stages;  // each flight with the first reference
};

/// Sums of one reference. @param first parameter of the equations among all
Sums sums_of(FitFlights& flights, const FitEquations& equations, Eigen::Index first, ScoreContext& scores) {
  const std::vector<std::size_t>& all = scores.all;
  const bool is_first_reference = &flights == equations.flights;
  const Solution& solution = equations.solution;
  const ScaledLoss loss(flights.task().options.loss, solution.deviation);
  const NormalLoss normal(loss, solution.deviation);
  const Eigen::Index size = as_index(all.size());
  const Eigen::Index own = as_index(equations.parameters.size());
  const bool is_last = &equations == scores.last;
  std::vector<Eigen::Index> doubt_places;  // positions of this reference's uncertainties among all
  for (const std::string& name : flights.doubt().names())
    doubt_places.push_back(std::find(scores.doubts.begin(), scores.doubts.end(), name) -
                           scores.doubts.begin());
  const BlockSums nothing{Eigen::MatrixXd::Zero(own, size), Eigen::VectorXd::Zero(own)};
  const auto sums_of_flight = [&](std::size_t number, FitFlight& fit) {
    Sums sums;
    sums.blocks.assign(scores.blocks.count(number), nothing);
    sums.covariance = Eigen::MatrixXd::Zero(scores.fitted, scores.fitted);
    sums.misfit = Eigen::MatrixXd::Zero(own, MisfitBasis::count());
    sums.doubt = Eigen::MatrixXd::Zero(own, as_index(scores.doubts.size()));
    if (fit.bins().size() == 0) return sums;
    const Eigen::VectorXd innovations = fit.white_rows(solution.values, loss).rightCols(1);
    const Eigen::Index count = innovations.size();
    std::vector<double> influence(static_cast<std::size_t>(count));
    Eigen::VectorXd weight(count);
    double slope = 0.0;  // derivative of the loss, mean over the bins
    for (Eigen::Index i = 0; i < count; ++i) {
      const double innovation = innovations[i];
      const std::array<double, 3> rho = loss(innovation);
      influence[static_cast<std::size_t>(i)] = rho[1] * innovation;
      weight[i] = rho[1];
      slope += (rho[1] + 2.0 * innovation * innovation * rho[2]) / static_cast<double>(count);
    }
    if (count < enough_bins) slope = normal.slope;
    const Eigen::MatrixXd columns = fit.without_offsets(fit.white_columns(solution.values, all), weight);
    const Eigen::MatrixXd left = columns.middleCols(first, own);
    const Eigen::MatrixXd weighted = fit.is_whitened() ? left : fit.weighted(left, weight);
    if (is_last) {
      const Eigen::MatrixXd joint =
          joined(is_first_reference ? scores.stages[number] : std::vector<StageScores>(), fit.bins().time(),
                 weighted, scores.fitted);
      if (fit.is_whitened()) {
        const std::vector<Segment>& segments = fit.bins().segments();
        const Autoregression memory = count < enough_bins ? Autoregression{{}, std::sqrt(normal.square)}
                                                          : autoregression(influence, segments, infinity);
        sums.covariance = covariance_of_sums(memory, joint, segments);
      } else {
        sums.covariance = fit.covariance_of_sums(joint);
      }
      if (is_first_reference) {
        const Eigen::VectorXd by_zero = joint.colwise().sum();
        sums.covariance += scores.misfit.between_flights * by_zero * by_zero.transpose();
      }
    } else if (is_first_reference) {
      scores.stages[number].push_back({first, fit.bins().time(), weighted});
    }
    if (is_first_reference && !fit.is_whitened())
      sums.misfit = weighted.transpose() * scores.misfit_columns(fit);
    if (!flights.doubt().empty()) {
      const Eigen::MatrixXd doubted = fit.white_doubts(flights.doubt(), solution.values);
      sums.doubt(Eigen::all, doubt_places) = slope * left.transpose() * doubted;
    }
    for (Eigen::Index i = 0; i < count; ++i) {
      BlockSums& block = sums.blocks[scores.blocks(number, fit.bins().time()[static_cast<std::size_t>(i)])];
      block.derivatives += slope * left.row(i).transpose() * columns.row(i);
      block.score += influence[static_cast<std::size_t>(i)] * left.row(i).transpose();
    }
    return sums;
  };
  Sums whole;
  whole.covariance = Eigen::MatrixXd::Zero(scores.fitted, scores.fitted);
  whole.misfit = Eigen::MatrixXd::Zero(own, MisfitBasis::count());
  whole.doubt = Eigen::MatrixXd::Zero(own, as_index(scores.doubts.size()));
  for (const Sums& one : flights.of_each(sums_of_flight, solution.values)) {
    whole.add(one);
    whole.blocks.insert(whole.blocks.end(), one.blocks.begin(), one.blocks.end());
  }
  return whole;
}

/// Sums over all references; innovations of different references are independent.
Sums sums_of(const FitEquations& equations, Eigen::Index first, ScoreContext& scores) {
  Sums whole;
  for (FitFlights* const flights : equations.flights->joint()) {
    const Sums more = sums_of(*flights, equations, first, scores);
    if (whole.blocks.empty()) {
      whole = more;
      continue;
    }
    whole.add(more);
    for (std::size_t b = 0; b < whole.blocks.size(); ++b) {
      whole.blocks[b].derivatives += more.blocks[b].derivatives;
      whole.blocks[b].score += more.blocks[b].score;
    }
  }
  return whole;
}

double information_of(FitFlights& flights) {
  double sum = 0.0;
  for (const double part : flights.of_each([](std::size_t, FitFlight& fit) { return fit.information(); }))
    sum += part;
  return sum;
}

/// Inverse of a regular matrix with unknowns of different orders of magnitude.
Eigen::MatrixXd scaled_inverse(const Eigen::MatrixXd& matrix) {
  const Eigen::VectorXd scale = matrix.diagonal().cwiseAbs().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
  return scale.asDiagonal() * pseudo_inverse(scale.asDiagonal() * matrix * scale.asDiagonal()) *
         scale.asDiagonal();
}

}  // namespace

FitCovariance fit_covariance(const std::vector<FitEquations>& equations, const std::vector<std::size_t>& held,
                             const Misfit& misfit, const MisfitBasis& misfit_columns) {
  const FitEquations& last = equations.back();
  const FitTask& task = last.flights->task();
  std::vector<std::size_t> all;
  for (const FitEquations& each : equations)
    all.insert(all.end(), each.parameters.begin(), each.parameters.end());
  const Eigen::Index fitted = as_index(all.size());
  const std::vector<std::size_t> parameters = all;
  all.insert(all.end(), held.begin(), held.end());
  const Eigen::Index size = as_index(all.size());

  const Blocks blocks(*last.flights);
  std::vector<BlockSums> left_out(blocks.count(),
                                  {Eigen::MatrixXd::Zero(fitted, size), Eigen::VectorXd::Zero(fitted)});
  Eigen::MatrixXd derivatives = Eigen::MatrixXd::Zero(fitted, size);
  Eigen::MatrixXd score = Eigen::MatrixXd::Zero(fitted, fitted);
  Eigen::MatrixXd by_misfit = Eigen::MatrixXd::Zero(fitted, MisfitBasis::count());
  ScoreContext scores{all, fitted, blocks, misfit, misfit_columns, &last, doubts_of(*last.flights), {}};
  scores.stages.resize(last.flights->count());
  Eigen::MatrixXd by_doubt = Eigen::MatrixXd::Zero(fitted, as_index(scores.doubts.size()));
  Eigen::Index first = 0;
  for (const FitEquations& each : equations) {
    const Eigen::Index own = as_index(each.parameters.size());
    if (own == 0 && &each != &last) continue;
    const Sums sums = sums_of(each, first, scores);
    by_misfit.middleRows(first, own) = sums.misfit;
    by_doubt.middleRows(first, own) = sums.doubt;
    score += sums.covariance;
    for (std::size_t b = 0; b < left_out.size(); ++b) {
      derivatives.middleRows(first, own) += sums.blocks[b].derivatives;
      left_out[b].derivatives.middleRows(first, own) = sums.blocks[b].derivatives;
      left_out[b].score.segment(first, own) = sums.blocks[b].score;
    }
    first += own;
  }
  const PriorRows prior = prior_rows(task, parameters);
  const double unit = last.solution.deviation * last.solution.deviation;
  derivatives.leftCols(fitted) += unit * prior.rows.transpose() * prior.rows;
  score += unit * unit * prior.rows.transpose() * prior.inflation.asDiagonal() * prior.rows;

  FitCovariance found;
  found.information = information_of(*last.flights);
  found.blocks = left_out.size();
  found.matrix = Eigen::MatrixXd::Zero(size, size);
  found.by_noise = found.by_flights = Eigen::MatrixXd::Zero(fitted, fitted);
  found.jackknife = Eigen::VectorXd::Constant(fitted, nan);
  const Eigen::MatrixXd doubt = task.doubt(held, held);
  found.matrix.bottomRightCorner(size - fitted, size - fitted) = doubt;
  // Parameters at a bound have no variance.
  std::vector<Eigen::Index> varying;
  for (Eigen::Index k = 0; k < fitted; ++k) {
    if (!last.solution.at_bound[all[static_cast<std::size_t>(k)]]) varying.push_back(k);
  }
  if (varying.empty()) return found;
  const Eigen::MatrixXd inverse = scaled_inverse(derivatives(varying, varying));
  const Eigen::MatrixXd carried = -inverse * derivatives(varying, Eigen::all).rightCols(size - fitted);
  Eigen::MatrixXd own =
      inverse * score(varying, varying) * inverse.transpose() + carried * doubt * carried.transpose();
  found.by_noise(varying, varying) = own;
  if (misfit.variance.size() > 0) {
    const Eigen::MatrixXd moved = inverse * by_misfit(varying, Eigen::all);
    own += moved * misfit.variance.asDiagonal() * moved.transpose();
  }
  found.by_flights(varying, varying) = own;
  const Eigen::MatrixXd by_one = -inverse * by_doubt(varying, Eigen::all);
  own += by_one * by_one.transpose();
  found.doubts = scores.doubts;
  found.by_doubt = Eigen::MatrixXd::Zero(fitted, by_one.cols());
  found.by_doubt(varying, Eigen::all) = by_one;
  const Eigen::MatrixXd across = carried * doubt;
  for (std::size_t a = 0; a < varying.size(); ++a) {
    for (std::size_t b = 0; b < varying.size(); ++b)
      found.matrix(varying[a], varying[b]) =
          0.5 * (own(as_index(a), as_index(b)) + own(as_index(b), as_index(a)));
    for (Eigen::Index b = fitted; b < size; ++b)
      found.matrix(varying[a], b) = found.matrix(b, varying[a]) = across(as_index(a), b - fitted);
  }

  // One Newton step from the fit of all blocks to the fit without one block.
  Eigen::MatrixXd moved(as_index(varying.size()), as_index(left_out.size()));
  for (std::size_t b = 0; b < left_out.size(); ++b) {
    const Eigen::MatrixXd rest = derivatives(varying, varying) - left_out[b].derivatives(varying, varying);
    moved.col(as_index(b)) = scaled_inverse(rest) * left_out[b].score(varying);
  }
  const auto count = static_cast<double>(left_out.size());
  moved.colwise() -= moved.rowwise().mean().eval();
  const Eigen::VectorXd errors = (moved.rowwise().squaredNorm() * ((count - 1.0) / count)).cwiseSqrt();
  if (left_out.size() > 2) found.jackknife(varying) = errors;
  return found;
}

}  // namespace pcor::internal

#include "fit/fit_covariance.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include <pcor/numerics/noise.hpp>
#include "fit/prior.hpp"
#include "numerics/decompositions.hpp"
#include "numerics/missing.hpp"

namespace pcor::internal {
namespace {

constexpr std::size_t fewest_flights = 8;  // from which on whole flights are left out
constexpr double parts = 20.0;             // else so many parts of all flights together
constexpr double shortest_part = 120.0;    // s

/// From so many bins on, the influence itself tells its variance and its memory; of fewer it is what normal
/// innovations have.
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

/// Which flights, or parts of flights, are left out one after another: the blocks of a flight are numbered on
/// their own, and follow those of the flights before it.
class Blocks {
 public:
  explicit Blocks(FitFlights& flights) : begin_(flights.count(), 0.0), count_(flights.count(), 1) {
    const auto spans = flights.of_each([](std::size_t, FitFlight& fit) {
      const std::vector<double>& time = fit.bins().time();
      return time.empty() ? std::pair(0.0, 0.0) : std::pair(time.front(), time.back() - time.front());
    });
    double all = 0.0;
    for (const auto& [begin, length] : spans) all += length;
    length_ = flights.count() >= fewest_flights ? infinity : std::max(all / parts, shortest_part);
    for (std::size_t f = 0; f < flights.count(); ++f) {
      begin_[f] = spans[f].first;
      count_[f] += static_cast<std::size_t>(spans[f].second / length_);
    }
  }

  /// Of all flights, and of one.
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
  Eigen::MatrixXd derivatives;  ///< of the scores by all parameters
  Eigen::VectorXd score;

  template <class Archive>
  void serialize(Archive& archive) {
    archive(derivatives, score);
  }
};

/// Sums over the bins of one set of equations, of a flight or of all.
struct Sums {
  std::vector<BlockSums> blocks;
  Eigen::MatrixXd covariance;  ///< of the sum of the scores by the noise
  Eigen::MatrixXd misfit;      ///< derivatives of the sum of the scores by the misfit of the law
  Eigen::MatrixXd doubt;       ///< the same by the doubts of the reference, each by one standard uncertainty
  double squares = 0.0;        ///< of the influence
  double slopes = 0.0;         ///< of the loss

  /// Adds what is of no block.
  void add(const Sums& other) {
    covariance += other.covariance;
    misfit += other.misfit;
    doubt += other.doubt;
    squares += other.squares;
    slopes += other.slopes;
  }

  template <class Archive>
  void serialize(Archive& archive) {
    archive(blocks, covariance, misfit, doubt, squares, slopes);
  }
};

/// The doubts of all references of a fit, by name: an error of the thermometer is one in all of them.
std::vector<std::string> doubts_of(FitFlights& flights) {
  std::vector<std::string> names;
  for (const FitFlights* const each : flights.joint()) {
    for (const std::string& name : each->doubt().names()) {
      if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
    }
  }
  return names;
}

/// Of one reference. @param all the parameters of all equations and those that are held
/// @param columns_of_misfit of the law; null for a further reference
/// @param between_flights variance of the zero of each flight, hPa^2
Sums sums_of(FitFlights& flights, const FitEquations& equations, const std::vector<std::size_t>& all,
             const Blocks& blocks, const MisfitColumns* columns_of_misfit, double between_flights,
             const std::vector<std::string>& doubts) {
  const Solution& solution = equations.solution;
  const ScaledLoss loss(flights.task().options.loss, solution.deviation);
  const NormalLoss normal(loss, solution.deviation);
  const Eigen::Index size = as_index(all.size());
  const Eigen::Index own = as_index(equations.parameters.size());
  std::vector<Eigen::Index> rows;  // of the own parameters among all
  for (const std::size_t p : equations.parameters)
    rows.push_back(std::find(all.begin(), all.end(), p) - all.begin());
  std::vector<Eigen::Index> doubt_places;  // of the doubts of this reference among all
  for (const std::string& name : flights.doubt().names())
    doubt_places.push_back(std::find(doubts.begin(), doubts.end(), name) - doubts.begin());
  const BlockSums nothing{Eigen::MatrixXd::Zero(own, size), Eigen::VectorXd::Zero(own)};
  const auto sums_of_flight = [&](std::size_t number, FitFlight& fit) {
    Sums sums;
    sums.blocks.assign(blocks.count(number), nothing);
    sums.covariance = Eigen::MatrixXd::Zero(own, own);
    sums.misfit = Eigen::MatrixXd::Zero(own, MisfitColumns::count());
    sums.doubt = Eigen::MatrixXd::Zero(own, as_index(doubts.size()));
    if (fit.bins().size() == 0) return sums;
    const Eigen::VectorXd innovations = fit.white_rows(solution.values, loss).rightCols(1);
    const Eigen::Index count = innovations.size();
    std::vector<double> influence(static_cast<std::size_t>(count));
    Eigen::VectorXd weight(count);
    for (Eigen::Index i = 0; i < count; ++i) {
      const double innovation = innovations[i];
      const std::array<double, 3> rho = loss(innovation);
      influence[static_cast<std::size_t>(i)] = rho[1] * innovation;
      weight[i] = rho[1];
      sums.slopes += rho[1] + 2.0 * innovation * innovation * rho[2];
      sums.squares += influence[static_cast<std::size_t>(i)] * influence[static_cast<std::size_t>(i)];
    }
    if (count < enough_bins) {
      sums.slopes = normal.slope * static_cast<double>(count);
      sums.squares = normal.square * static_cast<double>(count);
    }
    const double slope = sums.slopes / static_cast<double>(count);
    const Eigen::MatrixXd columns = fit.without_offsets(fit.white_columns(solution.values, all), weight);
    const std::vector<Stretch>& stretches = fit.bins().stretches();
    if (fit.is_whitened()) {
      const Autoregression memory = count < enough_bins ? Autoregression{{}, std::sqrt(normal.square)}
                                                        : autoregression(influence, stretches, infinity);
      std::vector<const double*> pointers;
      for (const Eigen::Index row : rows) pointers.push_back(columns.col(row).data());
      const std::vector<double> covariance = covariance_of_sums(memory, pointers, stretches);
      sums.covariance = Eigen::Map<const Eigen::MatrixXd>(covariance.data(), own, own);
    } else {
      const Eigen::MatrixXd left = columns(Eigen::all, rows);
      sums.covariance = fit.score_covariance(left, weight);
      const Eigen::MatrixXd weighted = fit.weighted(left, weight);
      const Eigen::VectorXd by_zero = weighted.colwise().sum();
      sums.covariance += between_flights * by_zero * by_zero.transpose();
      if (columns_of_misfit != nullptr) sums.misfit = weighted.transpose() * (*columns_of_misfit)(fit);
    }
    if (!flights.doubt().empty()) {
      const Eigen::MatrixXd doubted = fit.white_doubts(flights.doubt(), solution.values);
      sums.doubt(Eigen::all, doubt_places) = slope * columns(Eigen::all, rows).transpose() * doubted;
    }
    for (Eigen::Index i = 0; i < count; ++i) {
      BlockSums& block = sums.blocks[blocks(number, fit.bins().time()[static_cast<std::size_t>(i)])];
      const Eigen::VectorXd left = columns.row(i)(rows).transpose();
      block.derivatives += slope * left * columns.row(i);
      block.score += influence[static_cast<std::size_t>(i)] * left;
    }
    return sums;
  };
  Sums whole;
  whole.covariance = Eigen::MatrixXd::Zero(own, own);
  whole.misfit = Eigen::MatrixXd::Zero(own, MisfitColumns::count());
  whole.doubt = Eigen::MatrixXd::Zero(own, as_index(doubts.size()));
  for (const Sums& one : flights.of_each(sums_of_flight, solution.values)) {
    whole.add(one);
    whole.blocks.insert(whole.blocks.end(), one.blocks.begin(), one.blocks.end());
  }
  return whole;
}

/// Of all references together: the innovations of one tell nothing of those of another.
Sums sums_of(const FitEquations& equations, const std::vector<std::size_t>& all, const Blocks& blocks,
             const Misfit& misfit, const MisfitColumns& columns, const std::vector<std::string>& doubts) {
  Sums whole;
  for (FitFlights* const flights : equations.flights->joint()) {
    const bool is_first = flights == equations.flights;
    const Sums more = sums_of(*flights, equations, all, blocks, is_first ? &columns : nullptr,
                              is_first ? misfit.between_flights : 0.0, doubts);
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

/// The inverse of a regular matrix whose unknowns may differ by powers of ten.
Eigen::MatrixXd scaled_inverse(const Eigen::MatrixXd& matrix) {
  const Eigen::VectorXd scale = matrix.diagonal().cwiseAbs().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
  return scale.asDiagonal() * pseudo_inverse(scale.asDiagonal() * matrix * scale.asDiagonal()) *
         scale.asDiagonal();
}

}  // namespace

FitCovariance fit_covariance(const std::vector<FitEquations>& equations, const std::vector<std::size_t>& held,
                             const Misfit& misfit, const MisfitColumns& misfit_columns) {
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
  Eigen::MatrixXd by_misfit = Eigen::MatrixXd::Zero(fitted, MisfitColumns::count());
  const std::vector<std::string> doubts = doubts_of(*last.flights);
  Eigen::MatrixXd by_doubt = Eigen::MatrixXd::Zero(fitted, as_index(doubts.size()));
  const Eigen::Index of_last = as_index(last.parameters.size());
  Eigen::Index first = 0;
  for (const FitEquations& each : equations) {
    const Eigen::Index own = as_index(each.parameters.size());
    if (own == 0) continue;
    const Sums sums = sums_of(each, all, blocks, misfit, misfit_columns, doubts);
    by_misfit.middleRows(first, own) = sums.misfit;
    by_doubt.middleRows(first, own) = sums.doubt;
    Eigen::MatrixXd here = Eigen::MatrixXd::Zero(own, size);
    for (std::size_t b = 0; b < left_out.size(); ++b) {
      here += sums.blocks[b].derivatives;
      left_out[b].derivatives.middleRows(first, own) = sums.blocks[b].derivatives;
      left_out[b].score.segment(first, own) = sums.blocks[b].score;
    }
    derivatives.middleRows(first, own) = here;
    score.block(first, first, own, own) = sums.covariance;
    if (first + own < fitted) {
      // As of noise without memory, which the last equations weigh by its inverse covariance: the derivative
      // of the stage by their parameters. What the memory adds is left out: offsets take most of it out of a
      // stage.
      const Eigen::MatrixXd across = sums.squares / sums.slopes * here.middleCols(fitted - of_last, of_last);
      score.block(first, fitted - of_last, own, of_last) = across;
      score.block(fitted - of_last, first, of_last, own) = across.transpose();
    }
    first += own;
  }
  const Eigen::MatrixXd prior = prior_rows(task, parameters);
  const Eigen::MatrixXd drawn = last.solution.deviation * last.solution.deviation * prior.transpose() * prior;
  derivatives.leftCols(fitted) += drawn;
  score += last.solution.deviation * last.solution.deviation * drawn;

  FitCovariance found;
  found.information = information_of(*last.flights);
  found.blocks = left_out.size();
  found.matrix = Eigen::MatrixXd::Zero(size, size);
  found.by_noise = Eigen::MatrixXd::Zero(fitted, fitted);
  found.jackknife = Eigen::VectorXd::Constant(fitted, nan);
  const Eigen::MatrixXd doubt = task.doubt(held, held);
  found.matrix.bottomRightCorner(size - fitted, size - fitted) = doubt;
  // What is at a bound does not vary.
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
  const Eigen::MatrixXd by_one = -inverse * by_doubt(varying, Eigen::all);
  own += by_one * by_one.transpose();
  found.doubts = doubts;
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

  // One step of Newton from the fit of all to that without a block.
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

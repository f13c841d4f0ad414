#include "fit/fit_covariance.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>

#include "fit/prior.hpp"
#include "numerics/decompositions.hpp"
#include "numerics/missing.hpp"
#include "numerics/noise_covariance.hpp"

namespace pcor::internal {
namespace {

constexpr std::size_t min_flights = 8;  // minimum number for omitting whole flights
constexpr double part_count = 20.0;     // otherwise number of parts of all flights together
constexpr double min_part = 120.0;      // s

/// Flights with bins, or parts of them, omitted one at a time: blocks are numbered per flight, after those of
/// the flights before it.
class Blocks {
 public:
  explicit Blocks(const std::vector<FitEquations>& equations)
      : spans_(equations.back().flights->share().of_each_flight<Span>([&](std::size_t flight) -> Span {
          double begin = infinity;
          double end = -infinity;
          for (const FitEquations& stage : equations) {
            for (const FitFlights* const each : stage.flights->joint()) {
              const std::vector<double>& time = each->bins(flight).time();
              if (time.empty()) continue;
              begin = std::min(begin, time.front());
              end = std::max(end, time.back());
            }
          }
          return begin <= end ? Span({begin, end - begin}) : std::nullopt;
        })) {
    double all = 0.0;
    std::size_t used = 0;
    for (const Span& span : spans_) {
      all += span ? span->second : 0.0;
      used += span ? 1 : 0;
    }
    if (used < min_flights) length_ = std::max(all / part_count, min_part);
    for (std::size_t flight = 0; flight < spans_.size(); ++flight) count_ += count(flight);
  }

  /// Number of blocks of all flights, and of one flight.
  std::size_t count() const { return count_; }
  std::size_t count(std::size_t flight) const {
    const Span& span = spans_[flight];
    return span ? 1 + static_cast<std::size_t>(span->second / length_) : 0;
  }

  /// Block of a bin within its flight. @param time middle of the bin, s
  std::size_t operator()(std::size_t flight, double time) const {
    const double position = std::max((time - spans_[flight]->first) / length_, 0.0);
    return std::min(static_cast<std::size_t>(position), count(flight) - 1);
  }

 private:
  using Span = std::optional<std::pair<double, double>>;  // begin and duration, s; empty without bins

  std::vector<Span> spans_;   // one for each flight
  double length_ = infinity;  // s
  std::size_t count_ = 0;
};

/// Sums over the bins of a flight with one reference, for one set of equations.
struct FlightScores {
  std::vector<Eigen::MatrixXd> blocks;  ///< derivatives of the scores by all parameters, and the scores
  Eigen::MatrixXd covariance;  ///< scores of all equations by the noise; zero except for the last equations
  Eigen::VectorXd zero;        ///< derivatives of the scores of all equations by the zero of the flight
  Eigen::MatrixXd misfit;      ///< derivatives of the sum of the scores by the misfit of the law
  Eigen::MatrixXd doubt;       ///< derivatives by the errors of the reference, in standard uncertainties

  template <class Archive>
  void serialize(Archive& archive) {
    archive(blocks, covariance, zero, misfit, doubt);
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

/// A reference of a static pressure, which shares the errors of the static pressure under test.
struct StaticReference {
  const FitFlights* flights;
  std::vector<Eigen::VectorXd> noise{};  ///< residual less misfit in the bins of each local flight, hPa
  std::vector<Eigen::MatrixXd> roots{};  ///< square root of the covariance of the scores of each flight
};

/// Correlation of the noise against two references in the bins that both have, at least 0.
double shared_noise(const StaticReference& one, const StaticReference& other) {
  const auto sums = one.flights->share().sum_of_each_flight<Eigen::MatrixXd>([&](std::size_t flight) {
    Eigen::MatrixXd products = Eigen::MatrixXd::Zero(2, 2);
    const std::vector<double>& time = other.flights->bins(flight).time();
    const Eigen::VectorXd& a = one.noise[flight];
    const Eigen::VectorXd& b = other.noise[flight];
    for (Eigen::Index i = 0; i < a.size(); ++i) {
      const double at = one.flights->bins(flight).time()[static_cast<std::size_t>(i)];
      const auto bin = std::lower_bound(time.begin(), time.end(), at - 0.5 * Binning::usual_width);
      if (bin == time.end() || *bin > at + 0.5 * Binning::usual_width) continue;
      const Eigen::Vector2d both(a[i], b[bin - time.begin()]);
      products += both * both.transpose();
    }
    return products;
  });
  const double squares = sums(0, 0) * sums(1, 1);
  return squares > 0.0 ? std::clamp(sums(0, 1) / std::sqrt(squares), 0.0, 1.0) : 0.0;
}

/// Covariance of the scores by noise that references share: each sees the errors of the static pressure under
/// test.
Eigen::MatrixXd shared_covariance(const std::vector<StaticReference>& references, Eigen::Index fitted) {
  Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(fitted, fitted);
  for (std::size_t a = 0; a < references.size(); ++a) {
    for (std::size_t b = a + 1; b < references.size(); ++b) {
      const double correlation = shared_noise(references[a], references[b]);
      for (std::size_t flight = 0; flight < references[a].roots.size(); ++flight) {
        const Eigen::MatrixXd both = references[a].roots[flight] * references[b].roots[flight].transpose();
        sum += correlation * (both + both.transpose());
      }
    }
  }
  return sum;
}

/// Inverse of equations with unknowns of different orders of magnitude, over the directions that they
/// determine. @param scale one over the root of the diagonal of the equations with all blocks
Eigen::MatrixXd scaled_inverse(const Eigen::MatrixXd& matrix, const Eigen::VectorXd& scale) {
  return scale.asDiagonal() * pseudo_inverse(scale.asDiagonal() * matrix * scale.asDiagonal()) *
         scale.asDiagonal();
}

/// Whether the equations without a block determine a coefficient, with an error of less than a thousand times
/// that with all blocks: what rounding leaves of an undetermined coefficient has a much larger error.
/// @param all inverse of the equations with all blocks
bool is_determined(Eigen::Index coefficient, const Eigen::MatrixXd& rest,
                   const Eigen::MatrixXd& inverse_of_rest, const Eigen::MatrixXd& all) {
  constexpr double min_share = 0.99;  // share of the coefficient in the directions that the rest determines
  constexpr double max_growth = 1e6;  // ratio of variances
  return inverse_of_rest.row(coefficient).dot(rest.col(coefficient)) > min_share &&
         std::abs(inverse_of_rest(coefficient, coefficient)) <
             max_growth * std::abs(all(coefficient, coefficient));
}

}  // namespace

FitCovariance fit_covariance(const std::vector<FitEquations>& equations, const Solution& solution,
                             const Misfit& misfit) {
  const FitEquations& last = equations.back();
  FitFlights& main = *last.flights;
  const FitTask& task = main.task();
  const std::vector<std::size_t>& parameters = main.setup().requested;
  const Eigen::Index fitted = as_index(parameters.size());
  const Eigen::Index size = fitted + as_index(main.setup().held.size());
  const Blocks blocks(equations);
  const std::vector<std::string> doubts = doubts_of(main);
  std::vector<Eigen::MatrixXd> excluded(blocks.count(), Eigen::MatrixXd::Zero(fitted, size + 1));
  Eigen::MatrixXd score = Eigen::MatrixXd::Zero(fitted, fitted);
  Eigen::MatrixXd by_misfit = Eigen::MatrixXd::Zero(fitted, MisfitBasis::count());
  Eigen::MatrixXd by_doubt = Eigen::MatrixXd::Zero(fitted, as_index(doubts.size()));
  std::vector<Eigen::VectorXd> zeros(main.share().flights(), Eigen::VectorXd::Zero(fitted));
  std::vector<StaticReference> alike;
  std::vector<std::vector<StageScores>> stages(main.count());  // one for each local flight, first reference
  const Eigen::VectorXd& values = solution.values;
  const ScaledLoss loss(task.options.loss, solution.deviation);
  Eigen::Index first = 0;
  for (const FitEquations& each : equations) {
    const Eigen::Index width = as_index(each.parameters.size());
    for (FitFlights* const flights : each.flights->joint()) {
      const bool is_first_reference = flights == each.flights.get();
      const bool is_alike =
          &each == &last && main.joint().size() > 1 && flights->task().reference.is_static_pressure();
      const bool sees_law = each.flights->sees_law(*flights);
      const std::vector<Eigen::MatrixXd> states =
          sees_law ? binned_states(*flights) : std::vector<Eigen::MatrixXd>();
      std::vector<Eigen::VectorXd> noise(states.size());
      std::vector<Eigen::MatrixXd> doubted;
      std::vector<Eigen::Index> doubt_places;  // indices of the uncertainties of this reference
      if (!flights->doubt().empty()) {
        doubted = flights->of_local([&](std::size_t flight, const FitFlight& fit) {
          const Eigen::MatrixXd columns =
              flights->doubt().columns(fit.residuals().shared_samples(), fit.kept(),
                                       flight_parameters(fit.residuals(), flights->task(), values).data());
          return flights->weighted(flight, fit.linear_rows().bin_means(flights->bins(flight), columns));
        });
      }
      for (const std::string& name : flights->doubt().names())
        doubt_places.push_back(std::find(doubts.begin(), doubts.end(), name) - doubts.begin());
      const auto scores_of = [&](std::size_t flight) {
        FlightScores scores{{},
                            Eigen::MatrixXd::Zero(fitted, fitted),
                            Eigen::VectorXd::Zero(fitted),
                            Eigen::MatrixXd::Zero(width, by_misfit.cols()),
                            Eigen::MatrixXd::Zero(width, by_doubt.cols())};
        scores.blocks.assign(blocks.count(flight), Eigen::MatrixXd::Zero(width, size + 1));
        const std::vector<double>& time = flights->bins(flight).time();
        if (time.empty()) return scores;
        const FitRows rows = flights->rows(flight, values, loss);
        const Eigen::VectorXd weight = loss.weights(rows.innovations);
        double slope = 0.0;  // derivative of the influence, mean over the bins
        for (const double innovation : rows.innovations) {
          const std::array<double, 3> rho = loss(innovation);
          slope += (rho[1] + 2.0 * innovation * innovation * rho[2]) / static_cast<double>(time.size());
        }
        const Eigen::MatrixXd columns = rows.without_offsets(rows.columns, weight);
        const Eigen::MatrixXd left = columns.middleCols(first, width);
        const Eigen::MatrixXd weighted = flights->weighted(flight, weight.asDiagonal() * left);
        if (&each == &last) {
          const Eigen::MatrixXd joint = joined(
              is_first_reference ? stages[flight] : std::vector<StageScores>(), time, weighted, fitted);
          scores.covariance = noise_covariance(joint, flights->bins(flight), flights->noise(flight), 0);
          if (sees_law) scores.zero = joint.colwise().sum();
        } else {
          stages[flight].push_back({first, time, weighted});
        }
        if (is_alike) noise[flight] = flights->residual(flight, values) - misfit.at(states[flight]);
        if (sees_law) scores.misfit = weighted.transpose() * misfit.bumps(states[flight]);
        if (!doubted.empty())
          scores.doubt(Eigen::all, doubt_places) = slope * left.transpose() * doubted[flight];
        for (Eigen::Index i = 0; i < left.rows(); ++i) {
          Eigen::MatrixXd& block = scores.blocks[blocks(flight, time[static_cast<std::size_t>(i)])];
          block.leftCols(size) += slope * left.row(i).transpose() * columns.row(i);
          block.col(size) += weight[i] * rows.innovations[i] * left.row(i).transpose();
        }
        return scores;
      };
      auto block = excluded.begin();
      std::vector<Eigen::MatrixXd> roots;
      std::size_t number = 0;
      for (const FlightScores& flight :
           main.share().of_each_flight<FlightScores>(scores_of, digest_of(values))) {
        score += flight.covariance;
        zeros[number++] += flight.zero;
        if (is_alike) roots.push_back(covariance_root(flight.covariance));
        by_misfit.middleRows(first, width) += flight.misfit;
        by_doubt.middleRows(first, width) += flight.doubt;
        for (const Eigen::MatrixXd& sums : flight.blocks) block++->middleRows(first, width) += sums;
      }
      if (is_alike) alike.push_back({flights, std::move(noise), std::move(roots)});
    }
    first += width;
  }
  for (const Eigen::VectorXd& zero : zeros) score += misfit.between_flights * zero * zero.transpose();
  score += shared_covariance(alike, fitted);
  Eigen::MatrixXd derivatives = Eigen::MatrixXd::Zero(fitted, size);
  for (const Eigen::MatrixXd& block : excluded) derivatives += block.leftCols(size);
  const PriorRows prior = prior_rows(task, parameters);
  const double unit = solution.deviation * solution.deviation;
  derivatives.leftCols(fitted) += unit * prior.rows.transpose() * prior.rows;
  score += unit * unit * prior.rows.transpose() * prior.inflation.asDiagonal() * prior.rows;

  FitCovariance found;
  found.information = main.share().sum_of_each_flight<double>(
      [&](std::size_t flight) { return information_about_mean(main.bins(flight), main.noise(flight)); });
  found.blocks = excluded.size();
  found.matrix = Eigen::MatrixXd::Zero(size, size);
  found.by_noise = found.by_flights = Eigen::MatrixXd::Zero(fitted, fitted);
  found.jackknife = Eigen::VectorXd::Constant(fitted, nan);
  const Eigen::MatrixXd doubt = task.doubt(main.setup().held, main.setup().held);
  found.matrix.bottomRightCorner(size - fitted, size - fitted) = doubt;
  // Parameters at a bound have no variance.
  std::vector<Eigen::Index> varying;
  for (Eigen::Index k = 0; k < fitted; ++k) {
    if (!solution.at_bound[parameters[static_cast<std::size_t>(k)]]) varying.push_back(k);
  }
  if (varying.empty()) return found;
  const Eigen::MatrixXd equations_of_all = derivatives(varying, varying);
  const Eigen::VectorXd scale =
      equations_of_all.diagonal().cwiseAbs().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
  const Eigen::MatrixXd inverse = scaled_inverse(equations_of_all, scale);
  const Eigen::MatrixXd carried = -inverse * derivatives(varying, Eigen::all).rightCols(size - fitted);
  Eigen::MatrixXd covariance = inverse * score(varying, varying) * inverse.transpose();
  const Eigen::MatrixXd by_held = carried * doubt * carried.transpose();
  found.by_noise(varying, varying) = covariance + by_held;
  if (misfit.variance.size() > 0) {
    const Eigen::MatrixXd moved = inverse * by_misfit(varying, Eigen::all);
    covariance += moved * misfit.variance.asDiagonal() * moved.transpose();
  }
  // Fitted coefficients compensate errors of fixed ones, on all flights alike.
  found.by_flights(varying, varying) = covariance;
  covariance += by_held;
  const Eigen::MatrixXd by_one = -inverse * by_doubt(varying, Eigen::all);
  covariance += by_one * by_one.transpose();
  found.doubts = doubts;
  found.by_doubt = Eigen::MatrixXd::Zero(fitted, by_one.cols());
  found.by_doubt(varying, Eigen::all) = by_one;
  found.matrix(varying, varying) = 0.5 * (covariance + covariance.transpose());
  const Eigen::MatrixXd across = carried * doubt;
  found.matrix.rightCols(size - fitted)(varying, Eigen::all) = across;
  found.matrix.bottomRows(size - fitted)(Eigen::all, varying) = across.transpose();

  // One Newton step from the fit of all blocks to the fit without one block.
  Eigen::MatrixXd moved(as_index(varying.size()), as_index(excluded.size()));
  Eigen::VectorXd decided = Eigen::VectorXd::Zero(moved.rows());  // infinite if one block alone determines it
  for (std::size_t b = 0; b < excluded.size(); ++b) {
    const Eigen::MatrixXd rest = equations_of_all - excluded[b](varying, varying);
    const Eigen::MatrixXd inverse_of_rest = scaled_inverse(rest, scale);
    moved.col(as_index(b)) = inverse_of_rest * excluded[b].col(size)(varying);
    for (Eigen::Index k = 0; k < moved.rows(); ++k) {
      if (!is_determined(k, rest, inverse_of_rest, inverse)) decided[k] = infinity;
    }
  }
  const auto count = static_cast<double>(excluded.size());
  moved.colwise() -= moved.rowwise().mean().eval();
  const Eigen::VectorXd errors =
      (moved.rowwise().squaredNorm() * ((count - 1.0) / count)).cwiseSqrt() + decided;
  if (excluded.size() > 2) found.jackknife(varying) = errors;
  return found;
}

}  // namespace pcor::internal

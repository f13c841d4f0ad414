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
      : spans_(
            equations.back().flights->partition().all_gather_flights<Span>([&](std::size_t flight) -> Span {
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
  Eigen::MatrixXd by_uncertainty;  ///< derivatives by the errors of the reference, in standard uncertainties

  template <class Archive>
  void serialize(Archive& archive) {
    archive(blocks, covariance, zero, misfit, by_uncertainty);
  }
};

/// Uncertainties of all references of a fit, by name: a thermometer error is common to all of them.
std::vector<std::string> uncertainties_of(FitFlights& flights) {
  std::vector<std::string> names;
  for (const FitFlights* const each : flights.joint()) {
    for (const std::string& name : each->uncertainty().names()) {
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

/// The bin at a time; none if the flight has no bin there. Middles of bins differ by less than half the width
/// if other samples are used. @param middles of the bins, s
std::optional<Eigen::Index> bin_at(const std::vector<double>& middles, double time) {
  constexpr double margin = 0.5 * Binning::usual_width;
  const auto bin = std::lower_bound(middles.begin(), middles.end(), time - margin);
  if (bin == middles.end() || *bin > time + margin) return std::nullopt;
  return bin - middles.begin();
}

/// Columns of all equations in the bins of the last ones, which include the bins of each stage.
Eigen::MatrixXd joined(const std::vector<StageScores>& stages, const std::vector<double>& time,
                       const Eigen::MatrixXd& last, Eigen::Index fitted) {
  Eigen::MatrixXd all = Eigen::MatrixXd::Zero(last.rows(), fitted);
  all.rightCols(last.cols()) = last;
  for (const StageScores& stage : stages) {
    for (std::size_t i = 0; i < stage.time.size(); ++i) {
      if (const auto bin = bin_at(time, stage.time[i]))
        all.block(*bin, stage.first, 1, stage.columns.cols()) += stage.columns.row(as_index(i));
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
  const auto sums = one.flights->partition().all_reduce_flights<Eigen::MatrixXd>([&](std::size_t flight) {
    Eigen::MatrixXd products = Eigen::MatrixXd::Zero(2, 2);
    const std::vector<double>& time = other.flights->bins(flight).time();
    const Eigen::VectorXd& a = one.noise[flight];
    const Eigen::VectorXd& b = other.noise[flight];
    for (Eigen::Index i = 0; i < a.size(); ++i) {
      const double at = one.flights->bins(flight).time()[static_cast<std::size_t>(i)];
      if (const auto bin = bin_at(time, at)) {
        const Eigen::Vector2d both(a[i], b[*bin]);
        products += both * both.transpose();
      }
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
Eigen::MatrixXd scaled_pseudo_inverse(const Eigen::MatrixXd& matrix, const Eigen::VectorXd& scale) {
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

/// Jackknife errors of coefficients: one Newton step from the fit of all blocks to the fit without one block.
/// Infinite if one block alone determines a coefficient. @param varying coefficients that are not at a bound
/// @param equations of these coefficients @param scale of `scaled_pseudo_inverse`
Eigen::VectorXd jackknife_errors(const std::vector<Eigen::MatrixXd>& blocks,
                                 const std::vector<Eigen::Index>& varying, const Eigen::MatrixXd& equations,
                                 const Eigen::MatrixXd& inverse, const Eigen::VectorXd& scale) {
  Eigen::MatrixXd changes(as_index(varying.size()), as_index(blocks.size()));
  Eigen::VectorXd undetermined = Eigen::VectorXd::Zero(changes.rows());  // infinite or zero
  for (std::size_t b = 0; b < blocks.size(); ++b) {
    const Eigen::MatrixXd rest = equations - blocks[b](varying, varying);
    const Eigen::MatrixXd inverse_of_rest = scaled_pseudo_inverse(rest, scale);
    changes.col(as_index(b)) = inverse_of_rest * blocks[b].rightCols<1>()(varying);
    for (Eigen::Index k = 0; k < changes.rows(); ++k) {
      if (!is_determined(k, rest, inverse_of_rest, inverse)) undetermined[k] = infinity;
    }
  }
  const auto count = static_cast<double>(blocks.size());
  changes.colwise() -= changes.rowwise().mean().eval();
  return (changes.rowwise().squaredNorm() * ((count - 1.0) / count)).cwiseSqrt() + undetermined;
}

/// Sums of the scores of all equations over the flights and references.
class ScoreSums {
 public:
  ScoreSums(const std::vector<FitEquations>& equations, const Solution& solution, const Misfit& misfit)
      : solution_(solution),
        misfit_(misfit),
        loss_(equations.back().flights->task().options.loss, solution.deviation),
        last_(equations.back()),
        main_(*last_.flights),
        fitted_(as_index(main_.setup().requested.size())),
        size_(fitted_ + as_index(main_.setup().fixed_with_error.size())),
        numbers_(equations),
        uncertainties_(uncertainties_of(main_)),
        blocks_(numbers_.count(), Eigen::MatrixXd::Zero(fitted_, size_ + 1)),
        covariance_(Eigen::MatrixXd::Zero(fitted_, fitted_)),
        by_misfit_(Eigen::MatrixXd::Zero(fitted_, MisfitBasis::count())),
        by_uncertainty_(Eigen::MatrixXd::Zero(fitted_, as_index(uncertainties_.size()))),
        zeros_(main_.partition().flights(), Eigen::VectorXd::Zero(fitted_)),
        stages_(main_.count()) {
    Eigen::Index first = 0;
    for (const FitEquations& each : equations) {
      for (FitFlights* const flights : each.flights->joint()) add(each, *flights, first);
      first += as_index(each.parameters.size());
    }
    for (const Eigen::VectorXd& zero : zeros_)
      covariance_ += misfit_.between_flights * zero * zero.transpose();
    covariance_ += shared_covariance(static_references_, fitted_);
  }

  FitCovariance result() const {
    const std::vector<std::size_t>& parameters = main_.setup().requested;
    const std::vector<std::size_t>& held = main_.setup().fixed_with_error;
    Eigen::MatrixXd derivatives = Eigen::MatrixXd::Zero(fitted_, size_);
    for (const Eigen::MatrixXd& block : blocks_) derivatives += block.leftCols(size_);
    const PriorRows prior = prior_rows(main_.task(), parameters);
    const double unit = solution_.deviation * solution_.deviation;
    derivatives.leftCols(fitted_) += unit * prior.rows.transpose() * prior.rows;
    const Eigen::MatrixXd score =
        covariance_ + unit * unit * prior.rows.transpose() * prior.inflation.asDiagonal() * prior.rows;

    FitCovariance found;
    found.information = main_.partition().all_reduce_flights<double>(
        [&](std::size_t flight) { return information_about_mean(main_.bins(flight), main_.noise(flight)); });
    found.blocks = blocks_.size();
    found.matrix = Eigen::MatrixXd::Zero(size_, size_);
    found.by_noise = found.by_flights = Eigen::MatrixXd::Zero(fitted_, fitted_);
    found.jackknife = Eigen::VectorXd::Constant(fitted_, nan);
    const Eigen::MatrixXd fixed = main_.task().stated_covariance(held, held);
    found.matrix.bottomRightCorner(size_ - fitted_, size_ - fitted_) = fixed;
    // Parameters at a bound have no variance.
    std::vector<Eigen::Index> varying;
    for (Eigen::Index k = 0; k < fitted_; ++k) {
      if (!solution_.at_bound[parameters[static_cast<std::size_t>(k)]]) varying.push_back(k);
    }
    if (varying.empty()) return found;
    const Eigen::MatrixXd equations_of_all = derivatives(varying, varying);
    const Eigen::VectorXd scale =
        equations_of_all.diagonal().cwiseAbs().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
    const Eigen::MatrixXd inverse = scaled_pseudo_inverse(equations_of_all, scale);
    const Eigen::MatrixXd by_fixed = -inverse * derivatives(varying, Eigen::all).rightCols(size_ - fitted_);
    Eigen::MatrixXd covariance = inverse * score(varying, varying) * inverse.transpose();
    const Eigen::MatrixXd from_fixed = by_fixed * fixed * by_fixed.transpose();
    found.by_noise(varying, varying) = covariance + from_fixed;
    if (misfit_.variance.size() > 0) {
      const Eigen::MatrixXd by_misfit = inverse * by_misfit_(varying, Eigen::all);
      covariance += by_misfit * misfit_.variance.asDiagonal() * by_misfit.transpose();
    }
    // Fitted coefficients compensate errors of fixed ones, on all flights alike.
    found.by_flights(varying, varying) = covariance;
    covariance += from_fixed;
    const Eigen::MatrixXd by_uncertainty = -inverse * by_uncertainty_(varying, Eigen::all);
    covariance += by_uncertainty * by_uncertainty.transpose();
    found.uncertainties = uncertainties_;
    found.by_uncertainty = Eigen::MatrixXd::Zero(fitted_, by_uncertainty.cols());
    found.by_uncertainty(varying, Eigen::all) = by_uncertainty;
    found.matrix(varying, varying) = 0.5 * (covariance + covariance.transpose());
    const Eigen::MatrixXd across = by_fixed * fixed;
    found.matrix.rightCols(size_ - fitted_)(varying, Eigen::all) = across;
    found.matrix.bottomRows(size_ - fitted_)(Eigen::all, varying) = across.transpose();
    if (blocks_.size() > 2)
      found.jackknife(varying) = jackknife_errors(blocks_, varying, equations_of_all, inverse, scale);
    return found;
  }

 private:
  /// One set of equations with one reference.
  struct Part {
    FitFlights& flights;
    Eigen::Index first;  // first of its parameters among all
    Eigen::Index width;
    bool is_last;
    bool sees_law;
    bool shares_noise;                                // static pressure in common with other references
    std::vector<Eigen::MatrixXd> states{};            // one for each local flight
    std::vector<Eigen::MatrixXd> by_uncertainty{};    // columns of the uncertainties of this reference
    std::vector<Eigen::Index> uncertainty_indices{};  // indices of these uncertainties
    std::vector<Eigen::VectorXd> noise{};             // residual less misfit
  };

  void add(const FitEquations& each, FitFlights& flights, Eigen::Index first) {
    const bool is_last = &each == &last_;
    Part part{flights,
              first,
              as_index(each.parameters.size()),
              is_last,
              each.flights->sees_law(flights),
              is_last && main_.joint().size() > 1 && flights.task().reference.is_static_pressure()};
    if (part.sees_law) part.states = binned_states(flights);
    part.noise.resize(part.states.size());
    add_reference_uncertainty(part);
    std::vector<Eigen::MatrixXd> roots;
    auto block = blocks_.begin();
    auto zero = zeros_.begin();
    for (const FlightScores& flight : main_.partition().all_gather_flights<FlightScores>(
             [&](std::size_t f) { return scores_of(part, f); }, digest_of(serialized(solution_.values)))) {
      covariance_ += flight.covariance;
      *zero++ += flight.zero;
      if (part.shares_noise) roots.push_back(covariance_root(flight.covariance));
      by_misfit_.middleRows(first, part.width) += flight.misfit;
      by_uncertainty_.middleRows(first, part.width) += flight.by_uncertainty;
      for (const Eigen::MatrixXd& sums : flight.blocks) block++->middleRows(first, part.width) += sums;
    }
    if (part.shares_noise) static_references_.push_back({&flights, std::move(part.noise), std::move(roots)});
  }

  void add_reference_uncertainty(Part& part) const {
    FitFlights& flights = part.flights;
    if (flights.uncertainty().empty()) return;
    part.by_uncertainty = flights.of_local([&](std::size_t flight, const FitFlight& fit) {
      const Eigen::MatrixXd columns = flights.uncertainty().columns(
          fit.residuals().shared_samples(), fit.kept(),
          flight_parameters(fit.residuals(), flights.task(), solution_.values).data());
      return flights.weighted(flight, fit.linear_rows().bin_means(flights.bins(flight), columns));
    });
    for (const std::string& name : flights.uncertainty().names())
      part.uncertainty_indices.push_back(std::find(uncertainties_.begin(), uncertainties_.end(), name) -
                                         uncertainties_.begin());
  }

  /// Also keeps the scores of a stage for the last equations, and the noise of the flight.
  FlightScores scores_of(Part& part, std::size_t flight) {
    FitFlights& flights = part.flights;
    FlightScores scores{{},
                        Eigen::MatrixXd::Zero(fitted_, fitted_),
                        Eigen::VectorXd::Zero(fitted_),
                        Eigen::MatrixXd::Zero(part.width, by_misfit_.cols()),
                        Eigen::MatrixXd::Zero(part.width, by_uncertainty_.cols())};
    scores.blocks.assign(numbers_.count(flight), Eigen::MatrixXd::Zero(part.width, size_ + 1));
    const std::vector<double>& time = flights.bins(flight).time();
    if (time.empty()) return scores;
    const FitRows rows = flights.rows(flight, solution_.values, loss_);
    const Eigen::VectorXd weight = loss_.weights(rows.innovations);
    double slope = 0.0;  // derivative of the influence, mean over the bins
    for (const double innovation : rows.innovations) {
      const std::array<double, 3> rho = loss_(innovation);
      slope += (rho[1] + 2.0 * innovation * innovation * rho[2]) / static_cast<double>(time.size());
    }
    const Eigen::MatrixXd columns = rows.without_offsets(rows.columns, weight);
    const Eigen::MatrixXd part_columns = columns.middleCols(part.first, part.width);
    const Eigen::MatrixXd weighted = flights.weighted(flight, weight.asDiagonal() * part_columns);
    if (part.is_last) {
      // Stages are fitted to the first reference.
      const Eigen::MatrixXd all =
          joined(&flights == &main_ ? stages_[flight] : std::vector<StageScores>(), time, weighted, fitted_);
      scores.covariance = noise_covariance(all, flights.bins(flight), flights.noise(flight), 0);
      if (part.sees_law) scores.zero = all.colwise().sum();
    } else {
      stages_[flight].push_back({part.first, time, weighted});
    }
    if (part.sees_law) scores.misfit = weighted.transpose() * misfit_.bumps(part.states[flight]);
    if (part.shares_noise)
      part.noise[flight] = flights.residual(flight, solution_.values) - misfit_.at(part.states[flight]);
    if (!part.by_uncertainty.empty())
      scores.by_uncertainty(Eigen::all, part.uncertainty_indices) =
          slope * part_columns.transpose() * part.by_uncertainty[flight];
    for (Eigen::Index i = 0; i < part_columns.rows(); ++i) {
      Eigen::MatrixXd& block = scores.blocks[numbers_(flight, time[static_cast<std::size_t>(i)])];
      block.leftCols(size_) += slope * part_columns.row(i).transpose() * columns.row(i);
      block.col(size_) += weight[i] * rows.innovations[i] * part_columns.row(i).transpose();
    }
    return scores;
  }

  const Solution& solution_;
  const Misfit& misfit_;
  const ScaledLoss loss_;
  const FitEquations& last_;
  FitFlights& main_;
  const Eigen::Index fitted_;
  const Eigen::Index size_;  // fitted parameters, and fixed ones with an error
  const Blocks numbers_;
  const std::vector<std::string> uncertainties_;
  // For each block of bins: derivatives of the scores by all parameters, and the scores.
  std::vector<Eigen::MatrixXd> blocks_;
  Eigen::MatrixXd covariance_;  // scores by the noise and by the zeros of the flights
  Eigen::MatrixXd by_misfit_;
  Eigen::MatrixXd by_uncertainty_;
  std::vector<Eigen::VectorXd> zeros_;            // one for each flight
  std::vector<std::vector<StageScores>> stages_;  // one for each local flight, first reference
  std::vector<StaticReference> static_references_{};
};

}  // namespace

FitCovariance fit_covariance(const std::vector<FitEquations>& equations, const Solution& solution,
                             const Misfit& misfit) {
  return ScoreSums(equations, solution, misfit).result();
}

}  // namespace pcor::internal

#include "fit/gps_fit.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <numeric>
#include <utility>

#include "campaign/gps_noise.hpp"
#include "campaign/gps_system.hpp"
#include "campaign/model_parameters.hpp"
#include "fit/fit_task.hpp"
#include "model_io/sensor_uncertainty.hpp"
#include "numerics/decompositions.hpp"
#include "numerics/variance_factor.hpp"

namespace pcor::internal {
namespace {

constexpr double min_information = 3.0;  // ratio to the prior information
constexpr double block_time = 300.0;     // s

/// Information of a flight through one reference.
struct Part {
  /// Products of whitened rows (requested, nuisances, residual) with themselves and with the columns of fixed
  /// coefficients, over blocks of a few minutes, with their numbers.
  std::vector<std::pair<std::int64_t, Eigen::MatrixXd>> blocks{};
  Eigen::MatrixXd defects{};  ///< products of the derivatives of delta-p by the requested coefficients
  std::size_t samples = 0;

  template <class Archive>
  void serialize(Archive& archive) {
    archive(blocks, defects, samples);
  }
};

/// For each block of a flight, the index of each reference and its products of `Part::blocks`.
using BlockProducts = std::map<std::int64_t, std::vector<std::pair<std::size_t, Eigen::MatrixXd>>>;

/// Noise of a flight against one reference, and the relative width of its outliers.
struct FlightState {
  GpsNoise noise;
  Eigen::VectorXd outliers{};
};

class GpsSolver {
 public:
  GpsSolver(const std::vector<FitFlights*>& flights, Solution& solution, FitCovariance& covariance)
      : flights_(flights),
        task_(flights.front()->task()),
        solution_(solution),
        covariance_(covariance),
        is_alone_(covariance.matrix.size() == 0),
        requested_(flights.front()->setup().requested),
        fixed_coefficients_(flights.front()->setup().fixed_with_error),
        count_(as_index(requested_.size())),
        before_(solution.values(requested_)),
        carried_(Eigen::MatrixXd::Zero(count_, as_index(fixed_coefficients_.size()))),
        columns_(requested_),
        fixed_covariance_(task_.stated_covariance(fixed_coefficients_, fixed_coefficients_)) {
    if (!is_alone_ && carried_.cols() > 0)
      carried_ =
          covariance.matrix.topRightCorner(count_, carried_.cols()) * information_inverse(fixed_covariance_);
    for (std::size_t k = 0; k < fixed_coefficients_.size(); ++k) {
      if (fixed_coefficients_[k] < parameter_count(task_.model.model)) continue;
      fixed_covariance_.row(as_index(k)).setZero();
      fixed_covariance_.col(as_index(k)).setZero();
    }
    for (const FitFlights* const each : flights)
      states_.emplace_back(each->count(), FlightState{GpsNoise(*gps_kind(each->task().reference))});
    prior_deviation_.resize(count_);
    for (Eigen::Index k = 0; k < count_; ++k)
      prior_deviation_[k] = gps_prior_in_typical_sizes * parameter(k).typical;
    // A fitted coefficient replaces the nuisance for the same error.
    constexpr double held = 1e-3;  // fraction of its prior deviation; no result depends on it
    for (std::size_t n = 0; n < gps_nuisances.size(); ++n) {
      if (std::any_of(requested_.begin(), requested_.end(), [&](std::size_t p) {
            return corrects_error_of(task_.parameters[p].name, gps_nuisances[n].same_as);
          }))
        nuisance_deviation_[as_index(n)] *= held;
    }
  }

  GpsFit solve() {
    constexpr int rounds_with_noise = 3;
    constexpr int rounds = 5;
    for (int round = 0; round < rounds; ++round) {
      read(round < rounds_with_noise, round == rounds - 2);
      const Eigen::VectorXd from = requested_values();
      step();
      if (round + 1 >= rounds_with_noise) find_variance_factor(from);
    }
    const Eigen::VectorXd before_last = requested_values();
    columns_ = flights_.front()->setup().parameters();
    read(false, false);
    step();
    GpsFit fit = result();
    add_warning_of_convergence(requested_values() - before_last, fit);
    for (std::size_t k = 0; k < requested_.size(); ++k) solution_.at_bound[requested_[k]] = at_bound_[k];
    return fit;
  }

 private:
  Eigen::Index shared() const { return count_ + gps_shared_nuisances; }
  Eigen::Index all() const { return count_ + gps_nuisance_count; }
  Eigen::Index fixed() const { return as_index(columns_.size()) - count_; }
  const FitParameter& parameter(Eigen::Index k) const {
    return task_.parameters[requested_[static_cast<std::size_t>(k)]];
  }
  Eigen::VectorXd requested_values() const { return solution_.values(requested_); }
  Eigen::MatrixXd identity() const { return Eigen::MatrixXd::Identity(shared(), shared()); }

  /// Covariance from errors of fixed coefficients. @param derivatives by the fixed coefficients
  Eigen::MatrixXd covariance_by_fixed(const Eigen::MatrixXd& derivatives) const {
    return derivatives * fixed_covariance_ * derivatives.transpose();
  }

  /// Columns of the rows in the order requested, nuisances, residual, fixed.
  std::vector<Eigen::Index> order_of_columns() const {
    std::vector<Eigen::Index> order(static_cast<std::size_t>(all() + 1 + fixed()));
    std::iota(order.begin(), order.end(), Eigen::Index{0});
    std::rotate(order.begin() + count_, order.begin() + count_ + fixed(), order.end());
    return order;
  }

  Part part_of(GpsKind kind, const FitFlight& fit, FlightState& state, bool with_noise,
               bool with_outliers) const {
    const Eigen::VectorXd coefficients = flight_parameters(fit.residuals(), task_, solution_.values);
    const FlightSamples& samples = fit.residuals().samples();
    Part part;
    const GpsRows rows =
        gps_rows(kind, samples, task_.model, fit.kept(), coefficients.data(), columns_, {}, warmer_);
    part.samples = static_cast<std::size_t>(rows.defect.rows());
    part.defects = rows.defect.leftCols(count_).transpose() * rows.defect.leftCols(count_);
    if (part.samples == 0) return part;
    if (state.outliers.size() != rows.rows.rows()) state.outliers = Eigen::VectorXd::Zero(rows.rows.rows());
    GpsPrior prior{Eigen::VectorXd::Zero(all()), Eigen::VectorXd(all())};
    prior.deviation << prior_deviation_, nuisance_deviation_;
    prior.mean.head(count_) = before_ - requested_values();
    if ((prior.deviation.array() <= 0.0).any()) widen(prior, state.noise.white(rows, state.outliers));
    if (with_noise) state.noise.maximise(rows, state.outliers, prior);
    WhiteRows white = state.noise.white(rows, state.outliers);
    if (with_outliers && find_outliers(white, prior, state.outliers))
      white = state.noise.white(rows, state.outliers);
    std::map<std::int64_t, std::vector<Eigen::Index>> rows_of_blocks;
    for (Eigen::Index row = 0; row < white.rows.rows(); ++row) {
      const double time = rows.time[static_cast<std::size_t>(row) % rows.time.size()];
      rows_of_blocks[static_cast<std::int64_t>(std::floor(time / block_time))].push_back(row);
    }
    const std::vector<Eigen::Index> order = order_of_columns();
    for (const auto& [block, numbers] : rows_of_blocks) {
      const Eigen::MatrixXd some = white.rows(numbers, order);
      if (!some.isZero(0.0)) part.blocks.emplace_back(block, some.leftCols(all() + 1).transpose() * some);
    }
    return part;
  }

  /// @param with_noise, with_outliers only without columns of fixed coefficients
  void read(bool with_noise, bool with_outliers) {
    std::vector<BlockProducts> blocks(task_.flights.size());
    defects_ = Eigen::MatrixXd::Zero(count_, count_);
    samples_ = 0;
    for (std::size_t r = 0; r < flights_.size(); ++r) {
      const GpsKind kind = *gps_kind(flights_[r]->task().reference);
      const std::vector<Part> parts = flights_[r]->of_each(
          [&](std::size_t number, const FitFlight& fit) {
            return part_of(kind, fit, states_[r][number], with_noise, with_outliers);
          },
          solution_.values);
      for (std::size_t f = 0; f < parts.size(); ++f) {
        for (const auto& [block, products] : parts[f].blocks)
          blocks[f][block].emplace_back(r, products / variance_factor_);
        defects_ += parts[f].defects;
        samples_ += parts[f].samples;
      }
    }
    task_.report_progress();
    if (samples_ == 0)
      throw Error(Error::Code::samples,
                  "wind and height have no sample in these flights, because they need more than 40 m/s; omit "
                  "them, or give other flights");
    eliminate_flight_nuisances(blocks);
  }

  void eliminate_flight_nuisances(const std::vector<BlockProducts>& flights) {
    const Eigen::Index flight_nuisances = gps_nuisance_count - gps_shared_nuisances;
    const Eigen::Index size = shared();
    matrix_ = Eigen::MatrixXd::Zero(size, size);
    right_ = Eigen::VectorXd::Zero(size);
    by_fixed_ = Eigen::MatrixXd::Zero(size, fixed());
    products_.clear();
    parts_.clear();
    std::vector<Eigen::MatrixXd> references(flights_.size(), Eigen::MatrixXd::Zero(size + 1, size + 1));
    for (const BlockProducts& blocks : flights) {
      if (blocks.empty()) continue;
      Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(all() + 1, all() + 1 + fixed());
      sum.diagonal().segment(size, flight_nuisances) =
          nuisance_deviation_.tail(flight_nuisances).cwiseAbs2().cwiseInverse();
      for (const auto& [block, of_references] : blocks) {
        for (const auto& [reference, products] : of_references) sum += products;
      }
      // Each row minus its regression on the nuisances of the flight.
      Eigen::MatrixXd without = Eigen::MatrixXd::Zero(all() + 1, size + 1);
      without.topLeftCorner(size, size).setIdentity();
      without(all(), size) = 1.0;
      without.middleRows(size, flight_nuisances) =
          -symmetric_solution(sum.block(size, size, flight_nuisances, flight_nuisances),
                              Eigen::MatrixXd(sum.block(size, 0, flight_nuisances, all() + 1) * without));
      const std::int64_t middle = (blocks.begin()->first + blocks.rbegin()->first) / 2;
      std::vector<Eigen::MatrixXd> halves(2 * flights_.size(), Eigen::MatrixXd::Zero(size + 1, size + 1));
      for (const auto& [block, of_references] : blocks) {
        products_.emplace_back(Eigen::MatrixXd::Zero(size + 1, size + 1));
        for (const auto& [reference, products] : of_references) {
          const Eigen::MatrixXd reduced = without.transpose() * products.leftCols(all() + 1) * without;
          products_.back() += reduced;
          references[reference] += reduced;
          halves[2 * reference + (block > middle ? 1 : 0)] += reduced;
        }
      }
      for (std::size_t r = 0; r < flights_.size(); ++r) {
        // A half that has all rows disagrees with the prior only.
        if (halves[2 * r].isZero(0.0) || halves[2 * r + 1].isZero(0.0)) continue;
        parts_.insert(parts_.end(), {halves[2 * r], halves[2 * r + 1]});
      }
      const Eigen::MatrixXd reduced_sum = without.transpose() * sum.leftCols(all() + 1) * without;
      matrix_ += reduced_sum.topLeftCorner(size, size);
      right_ += reduced_sum.col(size).head(size);
      by_fixed_ += without.leftCols(size).transpose() * sum.rightCols(fixed());
    }
    if (references.size() > 1 || !is_alone_)
      parts_.insert(parts_.end(), references.begin(), references.end());
    for (Eigen::Index k = 0; k < count_; ++k) {
      if (prior_deviation_[k] > 0.0) continue;
      const double information = matrix_(k, k);
      prior_deviation_[k] = information > 0.0 ? 100.0 / std::sqrt(information) : 1.0;
    }
  }

  /// Prior covariance of the requested coefficients and shared nuisances.
  Eigen::MatrixXd prior_covariance() const {
    Eigen::MatrixXd covariance = Eigen::MatrixXd::Zero(shared(), shared());
    if (is_alone_)
      covariance.topLeftCorner(count_, count_) = free_ * free_.transpose();
    else
      covariance.topLeftCorner(count_, count_) =
          covariance_.matrix.topLeftCorner(count_, count_) - covariance_by_fixed(carried_);
    covariance.diagonal().tail(gps_shared_nuisances) =
        nuisance_deviation_.head(gps_shared_nuisances).cwiseAbs2();
    return covariance;
  }

  /// Finds the directions of the coefficients that the flights determine.
  void find_free() {
    free_ = held_ = weak_ = Eigen::MatrixXd(count_, 0);
    if (!is_alone_) return;
    Eigen::MatrixXd nuisances = matrix_.bottomRightCorner(gps_shared_nuisances, gps_shared_nuisances);
    nuisances.diagonal() += nuisance_deviation_.head(gps_shared_nuisances).cwiseAbs2().cwiseInverse();
    const Eigen::MatrixXd cross = matrix_.bottomLeftCorner(gps_shared_nuisances, count_);
    const Eigen::MatrixXd information =
        prior_deviation_.asDiagonal() *
        (matrix_.topLeftCorner(count_, count_) - cross.transpose() * symmetric_solution(nuisances, cross)) *
        prior_deviation_.asDiagonal();
    const SymmetricEigen eigen(information);
    std::vector<Eigen::Index> known;
    std::vector<Eigen::Index> unknown;
    std::vector<Eigen::Index> weak;
    const Eigen::MatrixXd directions = prior_deviation_.asDiagonal() * eigen.eigenvectors();
    for (Eigen::Index k = 0; k < count_; ++k) {
      const double eigenvalue = eigen.eigenvalues()[k];
      const double error = error_along(directions.col(k)) / std::sqrt(1.0 + std::max(0.0, eigenvalue));
      (error < max_defect_error ? known : unknown).push_back(k);
      if (error < max_defect_error && eigenvalue < min_information) weak.push_back(k);
    }
    free_ = directions(Eigen::all, known);
    held_ = directions(Eigen::all, unknown);
    weak_ = directions(Eigen::all, weak);
  }

  /// Undetermined directions are chosen so that delta-p changes least over the flights: its level stays that
  /// of the start, even if known coefficients are correlated with an unknown one.
  Eigen::MatrixXd level_held() const {
    const Eigen::MatrixXd identity = Eigen::MatrixXd::Identity(count_, count_);
    if (held_.cols() == 0) return identity;
    Eigen::MatrixXd squares = held_.transpose() * defects_ * held_;
    squares.diagonal().array() += 1e-9 * std::max(squares.trace(), 1e-300);
    return identity - held_ * symmetric_solution(squares, Eigen::MatrixXd(held_.transpose() * defects_));
  }

  /// Step of the coefficients to the optimum of flights and prior.
  void step() {
    find_free();
    prior_ = prior_covariance();
    posterior_ = solution_of(identity() + prior_ * matrix_, prior_);
    Eigen::VectorXd from = Eigen::VectorXd::Zero(shared());
    from.head(count_) = requested_values() - before_;
    change_ = posterior_ * (right_ + matrix_ * from);
    optimum_ = change_;
    change_.head(count_) = level_held() * change_.head(count_);
    keep_bounds();
    solution_.values(requested_) = before_ + change_.head(count_);
    warmer_ = change_[count_];
  }

  /// Finds the factor of the variance of GPS, after a step. @param from values of the requested coefficients
  /// before the step
  void find_variance_factor(const Eigen::VectorXd& from) {
    Eigen::VectorXd step = optimum_;
    step.head(count_) -= from - before_;
    std::vector<InformationPart> parts;
    for (const Eigen::MatrixXd& products : parts_) parts.push_back(part_of_rows(products, step));
    variance_factor_ = variance_factor(parts, posterior_, count_, variance_factor_);
  }

  /// Sets coefficients beyond a bound to the bound. The others get their best values with the bound held.
  void keep_bounds() {
    at_bound_.assign(requested_.size(), false);
    const auto within = [this](Eigen::Index k, double value) {
      return std::clamp(value, parameter(k).bounds.lower, parameter(k).bounds.upper);
    };
    const Eigen::MatrixXd level = level_held();
    Eigen::MatrixXd covariance = posterior_;
    covariance.topRows(count_) = level * covariance.topRows(count_).eval();
    covariance.leftCols(count_) = covariance.leftCols(count_).eval() * level.transpose();
    for (Eigen::Index round = 0; round < count_; ++round) {
      Eigen::Index worst = -1;
      double beyond = 0.0;  // unit: standard deviations of the prior
      for (Eigen::Index k = 0; k < count_; ++k) {
        const double value = before_[k] + change_[k];
        const double off = std::abs(value - within(k, value));
        if (off / prior_deviation_[k] > beyond && !at_bound_[static_cast<std::size_t>(k)]) {
          beyond = off / prior_deviation_[k];
          worst = k;
        }
      }
      if (worst < 0) break;
      at_bound_[static_cast<std::size_t>(worst)] = true;
      const double value = before_[worst] + change_[worst];
      const double missing = within(worst, value) - value;
      const double variance = covariance(worst, worst);
      if (variance > 0.0) {
        const Eigen::VectorXd with = covariance.col(worst) / variance;
        change_ += with * missing;
        covariance -= (with * covariance.row(worst)).eval();
      }
      for (Eigen::Index k = 0; k < count_; ++k) {
        if (!at_bound_[static_cast<std::size_t>(k)]) continue;
        change_[k] = within(k, before_[k] + change_[k]) - before_[k];
      }
    }
  }

  double error_along(const Eigen::VectorXd& direction) const {
    return error_of(direction * direction.transpose());
  }

  /// Uncertainty of delta-p, hPa, rms over the flights.
  double error_of(const Eigen::MatrixXd& covariance) const {
    return std::sqrt(std::max(0.0, (defects_ * covariance).trace() / static_cast<double>(samples_)));
  }

  /// Finds the covariance, after the last step.
  GpsFit result() {
    // Change of the solution without each block of five minutes. Scores of the blocks would understate the
    // error if one block decides, for example the only climb.
    Eigen::VectorXd residual_weights(shared() + 1);
    Eigen::VectorXd nuisance_change = change_;
    nuisance_change.head(count_).setZero();
    residual_weights << -nuisance_change, 1.0;
    const Eigen::MatrixXd drawn = identity() - posterior_ * matrix_;
    Eigen::MatrixXd sandwich = drawn * prior_ * drawn.transpose();
    for (const Eigen::MatrixXd& products : products_) {
      const Eigen::MatrixXd others = matrix_ - products.topLeftCorner(shared(), shared());
      const Eigen::VectorXd score = (products * residual_weights).head(shared());
      const Eigen::VectorXd without = solution_of(identity() + prior_ * others, prior_ * score);
      sandwich += without * without.transpose();
    }
    covariance_.blocks = products_.size();
    const Eigen::MatrixXd level = level_held();
    const Eigen::MatrixXd kept = drawn.topLeftCorner(count_, count_);  // derivatives by the values before
    Eigen::MatrixXd by_noise = level * posterior_.topLeftCorner(count_, count_) * level.transpose();
    const Eigen::MatrixXd by_scatter = level * sandwich.topLeftCorner(count_, count_) * level.transpose();
    covariance_.jackknife = by_scatter.diagonal().cwiseMax(0.0).cwiseSqrt();
    Eigen::MatrixXd stated = larger_covariance(by_noise, by_scatter);
    determined_ = error_of(stated);
    const Eigen::MatrixXd by_fixed = level * (kept * carried_ - (posterior_ * by_fixed_).topRows(count_));
    by_noise += covariance_by_fixed(by_fixed);
    stated += covariance_by_fixed(by_fixed);
    if (held_.cols() > 0) stated += held_covariance();
    stated = 0.5 * (stated + stated.transpose()).eval();
    covariance_.by_noise = is_alone_ ? by_noise : stated;
    if (covariance_.by_uncertainty.size() > 0) covariance_.by_uncertainty = kept * covariance_.by_uncertainty;
    const Eigen::MatrixXd of_fixed = task_.stated_covariance(fixed_coefficients_, fixed_coefficients_);
    const Eigen::MatrixXd across = by_fixed * of_fixed;
    covariance_.by_flights = stated - across * by_fixed.transpose();
    covariance_.matrix.resize(count_ + of_fixed.cols(), count_ + of_fixed.cols());
    covariance_.matrix << stated, across, across.transpose(), of_fixed;
    GpsFit fit;
    fit.stated = error_of(stated);
    const Eigen::MatrixXd matrix = matrix_.topLeftCorner(count_, count_);
    const Eigen::VectorXd scale = matrix.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
    const Eigen::VectorXd eigenvalues =
        symmetric_eigenvalues(scale.asDiagonal() * matrix * scale.asDiagonal());
    fit.condition_number = std::sqrt(eigenvalues.maxCoeff() / std::max(eigenvalues.minCoeff(), 1e-20));
    add_notes(fit);
    return fit;
  }

  /// Covariance of the fixed directions: the prior, or the value stated in the file.
  Eigen::MatrixXd held_covariance() const {
    const Eigen::MatrixXd stated = task_.stated_covariance(requested_, requested_);
    if (!(stated.diagonal().minCoeff() > 0.0)) return held_ * held_.transpose();
    const Eigen::MatrixXd scaled =
        prior_deviation_.cwiseInverse().asDiagonal() * held_;  // orthonormal columns
    const Eigen::MatrixXd onto = held_ * scaled.transpose() * prior_deviation_.cwiseInverse().asDiagonal();
    return onto * stated * onto.transpose();
  }

  /// "static-constant.a0 against static-qp.a2"
  std::string names_of(const Eigen::MatrixXd& directions) const {
    constexpr double much = 0.1;
    std::vector<std::string> names;
    for (Eigen::Index h = 0; h < directions.cols(); ++h) {
      const Eigen::VectorXd shares = directions.col(h).cwiseQuotient(prior_deviation_).cwiseAbs2();
      std::vector<std::string> some;
      for (Eigen::Index k = 0; k < count_; ++k) {
        if (shares[k] > much) some.push_back(parameter(k).name);
      }
      names.push_back(fmt::format("{}", fmt::join(some, " against ")));
    }
    return fmt::format("{}", fmt::join(names, ", "));
  }

  /// The columns lack the fastest part of the flow angles: in manoeuvres of less than 4 s the iteration can
  /// diverge.
  void add_warning_of_convergence(const Eigen::VectorXd& last_step, GpsFit& fit) const {
    constexpr double notable = 0.5;  // errors of the determined part
    constexpr double small = 0.03;   // hPa, noise of a sensor
    const double change = error_along(last_step);
    if (change < std::max(small, notable * determined_)) return;
    fit.warnings.push_back(
        fmt::format("exclude the fastest manoeuvres (--intervals) or fit their coefficients with a laser: "
                    "the fit by GPS did not converge; its last step changed delta-p by {:.2f} hPa (rms)",
                    change));
  }

  void add_notes(GpsFit& fit) const {
    const std::string disagreement = format_disagreement(variance_factor_);
    if (!disagreement.empty()) fit.warnings.push_back(disagreement);
    const std::string_view manoeuvres =
        std::any_of(flights_.begin(), flights_.end(),
                    [](const FitFlights* each) { return gps_kind(each->task().reference) == GpsKind::wind; })
            ? "circles or reverse headings (level), a speed run (airspeed), a pitch manoeuvre (attack)"
            : "--reference wind with circles or reverse headings (level), a speed run, a pitch manoeuvre";
    if (held_.cols() > 0) {
      fit.warnings.push_back(
          fmt::format("error of delta-p {:.2f} hPa: add {}; the flights do not determine {}, kept near the "
                      "input model",
                      error_of(held_covariance()), manoeuvres, names_of(held_)));
    }
    if (weak_.cols() > 0) {
      fit.notes.push_back(fmt::format("add {}; the flights hardly determine {}, kept near the input model",
                                      manoeuvres, names_of(weak_)));
    }
    const bool is_fitted = nuisance_deviation_[0] < gps_nuisances.front().deviation;
    const double thermometer = change_[count_];  // negative bias, K
    const double error = std::sqrt(posterior_(count_, count_));
    // If the flights do not determine a combination of coefficients, this error is too small.
    if (!is_fitted && held_.cols() == 0 && std::abs(thermometer) > 2.0 * error) {
      fit.notes.push_back(fmt::format("the thermometer reads {} by {:.2f} +- {:.2f} K, by GPS",
                                      thermometer > 0.0 ? "low" : "high", std::abs(thermometer), error));
    }
  }

  const std::vector<FitFlights*>& flights_;
  const FitTask& task_;
  Solution& solution_;
  FitCovariance& covariance_;
  const bool is_alone_;  // the fit has no other reference
  const std::vector<std::size_t>& requested_;
  const std::vector<std::size_t>& fixed_coefficients_;  // fixed coefficients with a stated error
  const Eigen::Index count_;
  const Eigen::VectorXd before_;      // requested coefficients before the fit
  Eigen::MatrixXd carried_;           // derivatives of these by the fixed ones; zero without other references
  std::vector<std::size_t> columns_;  // parameters with a column: requested; in the last pass also fixed
  Eigen::MatrixXd fixed_covariance_;  // stated covariance of the fixed coefficients on which GPS depends
  Eigen::VectorXd prior_deviation_{};
  Eigen::VectorXd nuisance_deviation_ = gps_nuisance_deviations();
  double warmer_ = 0.0;                             // nuisance of the thermometer, K
  std::vector<std::vector<FlightState>> states_{};  // indexed by reference and flight
  // Information of the flights about the requested coefficients and the shared nuisances: normal equations,
  // with the nuisances of each flight eliminated.
  Eigen::MatrixXd matrix_{};
  Eigen::VectorXd right_{};
  Eigen::MatrixXd by_fixed_{};               // products of these columns with those of fixed coefficients
  std::vector<Eigen::MatrixXd> products_{};  // one per block
  std::vector<Eigen::MatrixXd> parts_{};     // products of halves of flights and of references
  double variance_factor_ = 1.0;             // factor of the variance of GPS; its products are divided by it
  Eigen::MatrixXd defects_{};
  std::size_t samples_ = 0;
  Eigen::MatrixXd free_{};       // directions that the flights determine, one deviation of the prior long
  Eigen::MatrixXd held_{};       // the others
  Eigen::MatrixXd weak_{};       // free directions that hardly leave the start
  Eigen::MatrixXd prior_{};      // covariance of coefficients and shared nuisances before the flights
  Eigen::MatrixXd posterior_{};  // covariance of coefficients and shared nuisances
  std::vector<bool> at_bound_{};
  Eigen::VectorXd change_{};   // changes of coefficients; values of nuisances
  Eigen::VectorXd optimum_{};  // the same, free of bounds and of the level that is kept
  double determined_ = 0.0;    // error of delta-p by noise, without fixed directions and coefficients, hPa
};

}  // namespace

GpsFit fit_gps(const std::vector<FitFlights*>& flights, Solution& solution, FitCovariance& covariance) {
  return GpsSolver(flights, solution, covariance).solve();
}

}  // namespace pcor::internal

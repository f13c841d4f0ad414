#include "fit/fit_flights.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "campaign/gps_rows.hpp"
#include "numerics/decompositions.hpp"
#include "residuals/parameter_dependent_columns.hpp"

namespace pcor::internal {
namespace {

struct FlightCounts {
  NoiseFlight outline{};
  std::size_t samples = 0;
  std::size_t offsets = 0;
  std::array<std::size_t, mask_count> masks{};
  std::vector<bool> linear{};  ///< one per parameter: whether the residual is linear in it
  bool rows_are_linear = false;

  template <class Archive>
  void serialize(Archive& archive) {
    archive(outline, samples, offsets, masks, linear, rows_are_linear);
  }
};

}  // namespace

std::vector<std::size_t> FitSetup::parameters() const {
  std::vector<std::size_t> all = requested;
  all.insert(all.end(), fixed_with_error.begin(), fixed_with_error.end());
  return all;
}

Eigen::MatrixXd FitRows::without_offsets(const Eigen::MatrixXd& of, const Eigen::VectorXd& weights) const {
  if (offsets.cols() == 0) return of;
  const Eigen::MatrixXd weighted = weights.asDiagonal() * offsets;
  return of - offsets * (pseudo_inverse(offsets.transpose() * weighted) * (weighted.transpose() * of));
}

Eigen::VectorXd Reduction::lengths() const {
  return (factor.leftCols(factor.cols() - 1).colwise().squaredNorm().transpose() + absorbed).cwiseSqrt();
}

FitFlights::FitFlights(const FitTask& task, FitSetup setup)
    : task_(task),
      setup_(std::move(setup)),
      columns_(setup_.parameters()),
      uncertainty_(task.model, task.reference, task.options.trust_reference, !task.shares_system),
      prepared_(setup_.values),
      evaluated_(setup_.values),
      binned_{std::vector<Binning>(count()), std::vector<Eigen::MatrixXd>(count()),
              std::vector<Eigen::VectorXd>(count()), std::vector<std::size_t>(count())},
      by_offsets_(count()),
      spikes_(count()),
      masks_of_flights_(count()) {
  const auto counts = of_each([this](std::size_t number, const FitFlight& fit) {
    prepare(number, fit);
    const std::vector<double>& time = bins(number).time();
    return FlightCounts{{time.empty() ? 0.0 : time.front(), time.size()},
                        fit.kept().size(),
                        fit.linear_rows().interval_count(),
                        fit.residuals().mask_counts(),
                        fit.residuals().is_linear(),
                        fit.linear_rows().is_linear()};
  });
  linear_ = counts.front().linear;
  rows_are_linear_ = counts.front().rows_are_linear;
  for (const FlightCounts& flight : counts) {
    binned_.outlines.push_back(flight.outline);
    samples_ += flight.samples;
    bins_ += flight.outline.bins;
    offsets_ += flight.offsets;
    for (std::size_t m = 0; m < mask_count; ++m) masks_[m] += flight.masks[m];
  }
  if (!setup_.regimes.empty()) return;
  for (const FitTask& with : task_.further) {
    further_.push_back(std::make_unique<FitFlights>(with, setup_));
    // GPS is fitted after the others, with a separate likelihood.
    if (!gps_kind(with.reference) && further_.back()->sees_parameters())
      joint_.push_back(further_.back().get());
  }
}

/// Whether any derivative is not zero, and the bins are enough to find the noise.
bool FitFlights::sees_parameters() {
  constexpr std::size_t min_bins = 100;
  if (bins_ < min_bins || setup_.requested.empty()) return false;
  const auto largest = partition().all_gather_flights<double>([this](std::size_t flight) {
    return bins(flight).size() > 0 ? columns(flight).leftCols(requested()).cwiseAbs().maxCoeff() : 0.0;
  });
  return std::any_of(largest.begin(), largest.end(), [](double each) { return each > 0.0; });
}

bool FitFlights::masks_change_at(const Eigen::VectorXd& parameters) {
  return std::any_of(joint_.begin(), joint_.end(), [&](FitFlights* each) {
    const std::vector<int> changes = each->of_each(
        [&](std::size_t, const FitFlight& fit) { return fit.masks_change_at(parameters) ? 1 : 0; },
        parameters);
    return std::count(changes.begin(), changes.end(), 1) > 0;
  });
}

bool FitFlights::rows_are_linear() const {
  return std::all_of(joint_.begin(), joint_.end(),
                     [](const FitFlights* each) { return each->rows_are_linear_; });
}

bool FitFlights::uses_fixed_jacobian() const {
  return has_parameter_dependent_columns() || keeps_derivatives(task_.reference) || joint_.size() > 1;
}

bool FitFlights::has_parameter_dependent_columns() const {
  const std::vector<ModelEffect>& effects = task_.model.model.effects;
  return std::any_of(effects.begin(), effects.end(),
                     [](const ModelEffect& effect) { return memory_of(effect).of != Quantity::count; });
}

void FitFlights::visit(const std::function<void(std::size_t, const FitFlight&)>& work) {
  partition().visit(task_.threads(), [&](std::size_t number) {
    return [&, number,
            samples =
                task_.flights.samples(number, task_.model, task_.reference, task_.options.mask)]() mutable {
      work(number, FitFlight(std::move(samples), task_, setup_, prepared_, masks_of_flights_[number]));
    };
  });
}

std::vector<Eigen::MatrixXd> FitFlights::of_local(
    const std::function<Eigen::MatrixXd(std::size_t, const FitFlight&)>& make) {
  std::vector<Eigen::MatrixXd> result(count());
  partition().attempt(
      [&] { visit([&](std::size_t number, const FitFlight& fit) { result[number] = make(number, fit); }); });
  return result;
}

std::vector<Eigen::VectorXd> FitFlights::of_bins(
    const std::function<Eigen::VectorXd(std::size_t)>& make) const {
  std::vector<Eigen::VectorXd> result;
  for (std::size_t flight = 0; flight < count(); ++flight) {
    if (partition().is_local(flight)) result.push_back(make(flight));
  }
  return result;
}

void FitFlights::evaluate(std::size_t flight, const FitFlight& fit) {
  const Eigen::MatrixXd rows = fit.linear_rows().bin_means(
      bins(flight), sample_rows(fit.linear_rows(), task_, fit.kept(), evaluated_, columns_, false));
  binned_.columns[flight] = rows.leftCols(rows.cols() - 1);
  binned_.residuals[flight] = rows.rightCols(1);
}

/// Residuals that are not linear, and their derivatives, at other parameters in the same bins.
void FitFlights::evaluate_at(const Eigen::VectorXd& parameters) {
  if (rows_are_linear_ || parameters == evaluated_) return;
  evaluated_ = parameters;
  partition().attempt(
      [&] { visit([this](std::size_t flight, const FitFlight& fit) { evaluate(flight, fit); }); });
}

void FitFlights::prepare(std::size_t flight, const FitFlight& fit) {
  binned_.bins[flight] = fit.bins(prepared_, spikes_[flight]);
  by_offsets_[flight] = fit.by_offsets(bins(flight));
  evaluate(flight, fit);
  // Other outliers make other bins: the noise has a level for each of them.
  if (!noise_.empty())
    noise_[flight].level = {noise_levels(bins(flight), binned_.residuals[flight], noise_[flight])};
}

void FitFlights::prepare(const Eigen::VectorXd& parameters) {
  for (std::size_t k = 1; k < joint_.size(); ++k) joint_[k]->prepare(parameters);
  if (parameters == prepared_) return evaluate_at(parameters);
  prepared_ = evaluated_ = parameters;
  partition().attempt(
      [&] { visit([this](std::size_t flight, const FitFlight& fit) { prepare(flight, fit); }); });
}

Eigen::VectorXd FitFlights::residual(std::size_t flight, const Eigen::VectorXd& parameters) const {
  return binned_.residuals[flight] + columns(flight) * (parameters - evaluated_)(columns_);
}

Eigen::MatrixXd FitFlights::weighted(std::size_t flight, const Eigen::MatrixXd& columns) const {
  return weights_of_bins(bins(flight), deviation_).asDiagonal() * columns;
}

FitRows FitFlights::rows(std::size_t flight, const Eigen::VectorXd& parameters,
                         const ScaledLoss& loss) const {
  FitRows rows{weighted(flight, columns(flight)), weighted(flight, residual(flight, parameters)),
               weighted(flight, by_offsets_[flight])};
  if (rows.offsets.cols() == 0) return rows;
  rows.innovations = rows.without_offsets(rows.innovations, Eigen::VectorXd::Ones(rows.innovations.size()));
  constexpr int max_rounds = 200;
  for (int round = 0; round < max_rounds && !loss.is_least_squares(); ++round) {
    const Eigen::VectorXd before = rows.innovations;
    rows.innovations = rows.without_offsets(before, loss.weights(before));
    if (!((rows.innovations - before).norm() > 1e-12 * rows.innovations.norm())) break;
  }
  return rows;
}

Reduction FitFlights::reduce(const Eigen::VectorXd& parameters, const ScaledLoss& loss,
                             const std::vector<std::size_t>& free) {
  std::vector<Eigen::Index> indices;
  for (const std::size_t parameter : free) {
    indices.push_back(std::find(setup_.requested.begin(), setup_.requested.end(), parameter) -
                      setup_.requested.begin());
  }
  const Eigen::Index fitted = as_index(free.size());
  Reduction whole;
  whole.absorbed = Eigen::VectorXd::Zero(fitted);
  TriangularFactor sum(fitted + 1);
  for (FitFlights* const each : joint()) {
    each->evaluate_at(parameters);
    const auto reduced = [&](std::size_t flight) {
      const FitRows rows = each->rows(flight, parameters, loss);
      Reduction part;
      for (const double innovation : rows.innovations) part.cost += 0.5 * loss(innovation)[0];
      const Eigen::VectorXd weight = loss.weights(rows.innovations);
      const Eigen::MatrixXd all = side_by_side(rows.columns(Eigen::all, indices), rows.innovations);
      const Eigen::MatrixXd without_offsets = rows.without_offsets(all, weight);
      part.absorbed = (all - without_offsets).leftCols(fitted).cwiseAbs2().transpose() * weight;
      TriangularFactor factor(fitted + 1);
      factor.add(without_offsets, weight.cwiseSqrt());
      part.factor = factor.factor();
      return part;
    };
    for (const Reduction& part : partition().all_gather_flights<Reduction>(
             reduced, digest_of(serialized(parameters)), task_.threads())) {
      sum.add(part.factor);
      whole.absorbed += part.absorbed;
      whole.cost += part.cost;
    }
  }
  whole.factor = sum.factor();
  whole.valid = std::isfinite(whole.cost) && whole.factor.allFinite();
  return whole;
}

Eigen::MatrixXd FitFlights::unweighted_factor(const Eigen::VectorXd& parameters) {
  const auto factor = [&](std::size_t, const FitFlight& fit) {
    const Eigen::MatrixXd rows =
        sample_rows(fit.linear_rows(), task_, fit.kept(), parameters, setup_.requested, true);
    TriangularFactor of_flight(rows.cols());
    of_flight.add(rows, Eigen::VectorXd::Ones(rows.rows()));
    return of_flight.factor();
  };
  TriangularFactor sum(requested() + 1);
  for (const Eigen::MatrixXd& part : of_each(factor, parameters)) sum.add(part);
  return sum.factor();
}

void FitFlights::weigh(const Eigen::VectorXd& parameters) {
  prepare(parameters);
  for (FitFlights* const each : joint()) {
    const double deviation = robust_deviation(partition().comm(), each->of_bins([&](std::size_t flight) {
      return each->residual(flight, parameters);
    }));
    each->deviation_ = deviation > 0.0 ? deviation : 1.0;
  }
}

void FitFlights::measure_noise(const Eigen::VectorXd& parameters, const MisfitInBins& misfit) {
  weigh(parameters);
  for (FitFlights* const each : joint()) {
    BinnedFit fit;
    fit.columns = [&](std::size_t flight) { return each->columns(flight).leftCols(requested()); };
    fit.residual = [&](std::size_t flight) -> Eigen::VectorXd {
      if (!misfit || !sees_law(*each)) return each->residual(flight, parameters);
      return each->residual(flight, parameters) - misfit(*each, flight);
    };
    fit.state = digest_of(serialized(parameters));
    each->noise_ = noise_of_flights(partition(), each->binned_, fit,
                                    [&](const auto& bins, const auto& some, const auto& residuals) {
                                      return find_noise(bins, some, residuals, task_.threads()).model;
                                    });
  }
}

double FitFlights::drift_rms() const {
  const auto& slow = noise_.front().drift_component_rms;
  return std::sqrt(std::inner_product(slow.begin(), slow.end(), slow.begin(), 0.0));
}

double FitFlights::deviation(const Eigen::VectorXd& parameters) {
  std::vector<Eigen::VectorXd> innovations;
  for (FitFlights* const each : joint()) {
    each->evaluate_at(parameters);
    for (const Eigen::VectorXd& of_flight :
         each->of_bins([&](std::size_t flight) { return each->rows(flight, parameters, {}).innovations; }))
      innovations.push_back(of_flight);
  }
  return robust_deviation(partition().comm(), innovations);
}

std::size_t FitFlights::outliers(const Eigen::VectorXd& parameters, double limit) {
  evaluate_at(parameters);
  return partition().all_reduce_flights<std::size_t>([&](std::size_t flight) {
    const Eigen::VectorXd innovations = rows(flight, parameters, {}).innovations;
    return spikes_[flight] +
           static_cast<std::size_t>(
               (innovations.cwiseAbs().array() > limit).select(bins(flight).counts(), 0.0).sum());
  });
}

}  // namespace pcor::internal

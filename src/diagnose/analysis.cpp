#include "diagnose/analysis.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numeric>
#include <utility>

#include "campaign/gps_rows.hpp"
#include "diagnose/rms.hpp"
#include "diagnose/shape_uncertainty.hpp"
#include "numerics/decompositions.hpp"
#include "numerics/missing.hpp"
#include "numerics/spikes.hpp"
#include "numerics/variance_factor.hpp"
#include "numerics/whitening.hpp"
#include "residuals/flight_statistics.hpp"

namespace pcor::internal {
namespace {

constexpr int max_rounds = 4;
/// Candidates removed from the residual before the first noise estimate; they need not be effects.
constexpr double generous_threshold = 9.0;
constexpr std::size_t generous_effects = 6;
constexpr double block_time = 300.0;  // s
/// Maximum share of one held-out part: of a flight of a few minutes the rest would not determine a fit.
constexpr double max_share_of_part = 0.8;

/// Equality of matrices that may differ in size.
template <class Matrices>
bool are_equal(const Matrices& some, const Matrices& others) {
  return std::equal(some.begin(), some.end(), others.begin(), others.end(), [](const auto& a, const auto& b) {
    return a.rows() == b.rows() && a.cols() == b.cols() && a == b;
  });
}

}  // namespace

std::size_t held_out_part(const FlightSamples& samples, double time) {
  return static_cast<std::size_t>(
      std::fmod(std::floor((time - samples.time.front()) / block_time), static_cast<double>(held_out_parts)));
}

Analysis::Analysis(PartitionedColumns columns, std::vector<ColumnGroup> groups,
                   const std::vector<Eigen::VectorXd>& added, Eigen::VectorXd prior)
    : partition_(columns.partition),
      first_partition_(
          columns.partition),  // replaced below, where the flights against the first reference are known
      groups_(std::move(groups)),
      prior_(std::move(prior)) {
  base_ = columns.flights.front().base.cols();
  if (prior_.size() == 0) prior_ = Eigen::VectorXd::Zero(base_);
  binned_ = in_bins(partition_, columns.flights, [&](std::size_t f) { return columns.flights[f].given; });
  for (FlightColumns& flight : columns.flights) {
    if (flight.is_by_gps) nuisances_ = gps_shared_nuisances;
    (flight.reference == 0 ? flights_ : further_).push_back(std::move(flight));
  }
  first_partition_ = partition_.part(0, flights_.size());
  known_noise_.resize(reference_count());
  const Eigen::Index columns_count = binned_.columns.front().cols();
  for (const Eigen::VectorXd& effect : added) {
    added_.emplace_back(Eigen::VectorXd::Zero(columns_count));
    added_.back().head(base_) = effect;
  }
  const auto normal = partition_.all_reduce_flights<Eigen::MatrixXd>([this](std::size_t f) {
    if (flight(f).is_by_gps) return Eigen::MatrixXd(Eigen::MatrixXd::Zero(base_, base_ + 1));
    const auto base = binned_.columns[f].leftCols(base_);
    Eigen::MatrixXd part(base_, base_ + 1);
    part.leftCols(base_) = base.transpose() * base;
    part.rightCols(1) = base.transpose() * binned_.residuals[f];
    return part;
  });
  // Slow effects and slow drift compete for the same part of the residuals, so the noise is estimated from
  // two starts: with all candidate effects removed, and with no effect removed. The more likely result is
  // used.
  const Eigen::VectorXd start = pseudo_solution(normal.leftCols(base_), normal.rightCols(1));
  const double by_effects = search_from(start, true);
  const bool drifts =
      std::any_of(noise_.begin(), noise_.end(), [](const auto& each) { return each.has_drift(); });
  if (result_.chosen.empty() || drifts) {
    const SearchResult result = result_;
    const double by_drift = search_from(start, false);
    if (by_effects > by_drift && result.chosen != result_.chosen) search_from(start, true);
  }
  known_noise_.assign(reference_count(), {});
  if (nuisances_ > 0) find_variance_factor();
}

void Analysis::find_variance_factor() {
  constexpr int max_rounds_of_variance = 4;
  constexpr double notable = 1.05;  // ratio of two factors; no result depends on it
  SearchOptions options;
  options.seed = random_seed;
  options.references = binned_.reference;
  for (int round = 0; round < max_rounds_of_variance; ++round) {
    const double variance = variance_factor_with(result_.chosen);
    if (std::max(variance, variance_factor_) < notable * std::min(variance, variance_factor_)) break;
    variance_factor_ = variance;
    coefficients_ = coefficients(result_.chosen);
    find_search(result_.chosen);
    result_ = search_->run(options);
  }
}

double Analysis::variance_factor_with(const std::vector<std::size_t>& chosen) const {
  std::vector<Eigen::Index> columns = indices_of(chosen);
  const Eigen::Index tested = as_index(columns.size());
  WhitenedSystem system = whiten_all();
  take_out_common_noise(system);
  for (Eigen::Index k = binned_.columns.front().cols(); k < system.columns(); ++k) columns.push_back(k);
  const Eigen::Index count = as_index(columns.size());
  columns.push_back(system.columns());
  Eigen::MatrixXd information = system.information(columns, columns);
  information.diagonal().head(tested) += precision_of(chosen);
  information.diagonal().segment(tested, count - tested).array() += 1.0;
  const Eigen::MatrixXd covariance = information_inverse(information.topLeftCorner(count, count));
  const Eigen::VectorXd estimate = covariance * information.col(count).head(count);

  using Halves = std::array<Eigen::MatrixXd, 2>;
  const auto halves = partition_.all_gather_flights<Halves>([&](std::size_t f) {
    Halves of_flight;
    of_flight.fill(Eigen::MatrixXd::Zero(count + 1, count + 1));
    if (flight(f).gps.rows.size() == 0) return of_flight;
    const std::vector<double>& time = binned_.bins[f].time();
    const double middle = 0.5 * (time.front() + time.back());
    const Eigen::MatrixXd rows = system.rows[f](Eigen::all, columns);
    std::array<std::vector<Eigen::Index>, 2> numbers;
    for (Eigen::Index i = 0; i < rows.rows(); ++i)
      numbers[time[static_cast<std::size_t>(system.bin_of(f, i))] < middle ? 0 : 1].push_back(i);
    for (std::size_t half = 0; half < 2; ++half)
      of_flight[half] = products_of(rows(numbers[half], Eigen::all));
    return of_flight;
  });
  std::vector<InformationPart> parts;
  std::map<std::size_t, Eigen::MatrixXd> references;
  for (std::size_t f = 0; f < halves.size(); ++f) {
    if (!flight(f).is_by_gps) continue;
    // A half that has all rows disagrees with the prior only.
    if (!halves[f][0].isZero(0.0) && !halves[f][1].isZero(0.0)) {
      for (const Eigen::MatrixXd& half : halves[f]) parts.push_back(part_of_rows(half, estimate));
    }
    const auto [sum, is_new] = references.try_emplace(flight(f).reference, halves[f][0] + halves[f][1]);
    if (!is_new) sum->second += halves[f][0] + halves[f][1];
  }
  if (reference_count() > 1) {
    for (const auto& [number, sum] : references) parts.push_back(part_of_rows(sum, estimate));
  }
  return internal::variance_factor(parts, covariance, tested, variance_factor_);
}

double Analysis::search_from(const Eigen::VectorXd& start, bool generous) {
  std::vector<std::size_t> chosen;
  Eigen::VectorXd found = coefficients({}, start);
  for (int round = generous ? 0 : 1; round < max_rounds; ++round) {
    replace_outliers(found);
    find_noise(chosen, found, round == 0);
    find_search(chosen);
    SearchOptions options;
    options.seed = random_seed;
    options.references = binned_.reference;
    if (round == 0) {
      options.threshold = generous_threshold;
      options.max_effects = generous_effects;
    }
    result_ = search_->run(options);
    const bool stable = round > 1 && result_.chosen == chosen;
    chosen = result_.chosen;
    found = coefficients(chosen);
    if (stable) break;
  }
  Eigen::Index columns = 0;
  for (const std::size_t group : chosen) columns += as_index(search_->identifiable(group).size());
  return likelihood_ - static_cast<double>(columns) * result_.threshold;
}

BinnedFlights Analysis::binned(const std::vector<std::size_t>& groups) const {
  BinnedFlights result;
  for (std::size_t f = 0; f < flights_.size(); ++f) {
    result.bins.push_back(binned_.bins[f]);
    result.columns.emplace_back(binned_.columns[f](Eigen::all, indices_of(groups)));
    result.residuals.push_back(binned_.residuals[f]);
  }
  return result;
}

std::vector<Eigen::Index> Analysis::indices_of(const std::vector<std::size_t>& groups) const {
  return internal::indices_of(groups, groups_, base_);
}

Eigen::VectorXd Analysis::coefficients(const std::vector<std::size_t>& groups,
                                       const Eigen::VectorXd& estimate) const {
  Eigen::VectorXd all = Eigen::VectorXd::Zero(binned_.columns.front().cols());
  all(indices_of(groups)) = estimate;
  return all;
}

std::vector<double> Analysis::added(std::size_t flight, const Eigen::VectorXd& coefficients) const {
  return select_samples(sum_of_columns(this->flight(flight), coefficients), binned_.bins[flight].records());
}

std::vector<double> Analysis::added_by(std::size_t flight, std::size_t group,
                                       const Eigen::VectorXd& coefficients) const {
  const std::vector<Eigen::Index> indices = internal::indices_of(groups_[group], base_);
  Eigen::VectorXd alone = Eigen::VectorXd::Zero(coefficients.size());
  alone(indices) = coefficients(indices);
  return added(flight, alone);
}

void Analysis::replace_outliers(const Eigen::VectorXd& coefficients) {
  for (std::size_t f = 0; f < binned_.bins.size(); ++f) {
    if (!partition_.is_local(f)) continue;
    FlightColumns& flight = f < flights_.size() ? flights_[f] : further_[f - flights_.size()];
    std::size_t count = 0;
    const std::vector<double> predicted = added(f, coefficients);
    flight.residual =
        without_outliers(flight.given, predicted, flight.samples->time, flight.samples->step, count);
    // A record outside all bins has no prediction and is not counted.
    binned_.residuals[f] = binned_.bins[f].means(flight.residual);
  }
}

std::vector<NoiseModel> Analysis::noise_after(const std::vector<std::size_t>& groups,
                                              const Eigen::VectorXd& coefficients,
                                              const FindNoise& find) const {
  const std::vector<Eigen::Index> indices = indices_of(groups);
  return noise_of_flights(
      partition_, binned_,
      {[&](std::size_t f) -> Eigen::MatrixXd { return binned_.columns[f](Eigen::all, indices); },
       [&](std::size_t f) { return binned_residual_after(f, coefficients); },
       digest_of(serialized(coefficients))},
      find);
}

void Analysis::find_noise(const std::vector<std::size_t>& groups, const Eigen::VectorXd& coefficients,
                          bool is_rough) {
  // The references that have flights, in the order in which their noise is found.
  std::vector<std::size_t> references = binned_.reference;
  references.erase(std::unique(references.begin(), references.end()), references.end());
  auto next = references.begin();
  likelihood_ = 0.0;
  noise_ =
      noise_after(groups, coefficients, [&](const auto& bins, const auto& columns, const auto& residuals) {
        const std::size_t number = *next++;
        const bool has_white_rows = std::any_of(
            further_.begin(), further_.end(),
            [number](const FlightColumns& each) { return each.reference == number && each.is_by_gps; });
        if (is_rough || has_white_rows) return estimate_noise(bins, residuals);
        std::vector<KnownNoise>& known = known_noise_[number];
        auto same = std::find_if(known.begin(), known.end(), [&](const KnownNoise& each) {
          return are_equal(each.columns, columns) && are_equal(each.residuals, residuals);
        });
        if (same == known.end())
          same = known.insert(same, {columns, residuals,
                                     internal::find_noise(bins, columns, residuals, partition_.threads())});
        const FoundNoise& found = same->found;
        if (number == 0) drift_gain_ = found.drift_gain;
        likelihood_ += found.likelihood;
        return extrapolate_drift(found.model);  // this likelihood includes only what the flights show
      });
  coefficients_ = coefficients;
}

NoiseModel Analysis::noise_beside_offsets() const {
  bool is_first = true;
  const auto noise =
      noise_after(result_.chosen, coefficients(result_.chosen),
                  [&](const auto& bins, const auto& columns, const auto& residuals) {
                    if (!std::exchange(is_first, false)) return estimate_noise(bins, residuals);
                    std::vector<Eigen::MatrixXd> with_offsets = columns;
                    std::vector<Eigen::VectorXd> about_means = residuals;
                    const Eigen::Index offsets = as_index(bins.size()) - 1;
                    for (std::size_t f = 0; f < bins.size(); ++f) {
                      Eigen::MatrixXd indicators = Eigen::MatrixXd::Zero(columns[f].rows(), offsets);
                      if (f > 0) indicators.col(as_index(f) - 1).setOnes();
                      with_offsets[f] = side_by_side(columns[f], indicators);
                      if (residuals[f].size() > 0) about_means[f].array() -= residuals[f].mean();
                    }
                    return extrapolate_drift(
                        internal::find_noise(bins, with_offsets, about_means, partition_.threads()).model);
                  });
  return noise_of_first_reference(binned_, noise);
}

std::vector<Eigen::MatrixXd> Analysis::find_shape_uncertainty(const std::vector<std::size_t>& chosen) {
  std::vector<Eigen::VectorXd> effects;
  Eigen::Index first = binned_.columns.front().cols();
  for (std::size_t g = 0; g < groups_.size(); ++g) {
    ColumnGroup& group = groups_[g];
    group.shape_count = 0;
    if (!group.has_uncertain_shape || std::find(chosen.begin(), chosen.end(), g) == chosen.end()) continue;
    group.shape_first = first - base_;
    group.shape_count = shape_columns;
    first += shape_columns;
    effects.emplace_back(Eigen::VectorXd::Zero(coefficients_.size()));
    effects.back().segment(base_ + group.first, group.count) =
        coefficients_.segment(base_ + group.first, group.count);
  }
  effects.insert(effects.end(), added_.begin(), added_.end());
  std::vector<const FlightColumns*> flights;
  for (std::size_t f = 0; f < flight_count(); ++f) flights.push_back(&flight(f));
  return shape_uncertainty(partition_, flights, binned_, effects);
}

WhitenedSystem Analysis::whiten_all() const {
  std::vector<Eigen::Index> all(static_cast<std::size_t>(binned_.columns.front().cols()));
  std::iota(all.begin(), all.end(), Eigen::Index{0});
  return whiten(binned_.columns, all);
}

WhitenedSystem Analysis::whiten(const std::vector<Eigen::MatrixXd>& columns,
                                const std::vector<Eigen::Index>& of_gps) const {
  std::vector<Eigen::MatrixXd> all;
  std::vector<WhiteFlight> white(columns.size());
  for (std::size_t f = 0; f < columns.size(); ++f) {
    const Eigen::Index count = columns[f].cols() + uncertainty_[f].cols();
    Eigen::MatrixXd& both = all.emplace_back(Eigen::MatrixXd::Zero(columns[f].rows(), count + nuisances_));
    both.leftCols(count) << columns[f], uncertainty_[f];
    const GpsSystem& gps = flight(f).gps;
    if (gps.rows.size() == 0) continue;
    white[f].rows = Eigen::MatrixXd::Zero(gps.rows.rows(), count + nuisances_ + 1);
    white[f].rows.leftCols(as_index(of_gps.size())) = gps.rows(Eigen::all, of_gps).cast<double>();
    white[f].rows.rightCols(nuisances_ + 1) = gps.rows.rightCols(nuisances_ + 1).cast<double>();
    white[f].rows /= std::sqrt(variance_factor_);
    const std::vector<std::size_t>& records = binned_.bins[f].records();
    for (const std::size_t record : gps.record) {
      const auto next = std::upper_bound(records.begin(), records.end(), record) - records.begin();
      white[f].bin.push_back(
          binned_.bins[f].bins()[static_cast<std::size_t>(std::max<std::ptrdiff_t>(next, 1) - 1)]);
    }
  }
  WhitenedSystem system = whiten_system(partition_, binned_.bins, all, binned_.residuals, noise_, white,
                                        further_.empty());  // otherwise see `take_out_common_noise`
  if (nuisances_ > 0) {
    const auto rows = partition_.all_reduce_flights<double>(
        [&white](std::size_t f) { return static_cast<double>(white[f].rows.rows()); });
    system.row_count -= static_cast<std::size_t>(rows * (1.0 - 1.0 / variance_factor_));
  }
  return system;
}

void Analysis::find_search(const std::vector<std::size_t>& chosen) {
  uncertainty_ = find_shape_uncertainty(chosen);
  scores_ = std::make_unique<WhitenedSystem>(whiten_all());
  white_noise_.assign(binned_.bins.size(), {});
  for (std::size_t f = 0; f < binned_.bins.size(); ++f) {
    if (!partition_.is_local(f)) continue;
    const Eigen::MatrixXd& rows = scores_->rows[f];
    white_noise_[f] = rows.rightCols(1) - rows.leftCols(coefficients_.size()) * coefficients_;
  }
  take_out_common_noise(*scores_);
  marginalize(*scores_, shape_columns * as_index(added_.size()) + nuisances_);
  for (Eigen::MatrixXd* const products : {&scores_->information, &scores_->plain})
    products->diagonal().head(base_) += prior_;
  search_ = std::make_unique<EffectSearch>(*scores_, base_, groups_);
}

void Analysis::take_out_common_noise(WhitenedSystem& scores) const {
  if (further_.empty()) return;
  std::vector<Eigen::VectorXd> noise = white_noise_;
  for (std::size_t later = flights_.size(); later < binned_.bins.size(); ++later) {
    if (!partition_.is_local(later) || flight(later).is_by_gps) continue;
    for (std::size_t earlier = 0; earlier < later; ++earlier) {
      if (flight(earlier).file == flight(later).file)
        internal::take_out_common_noise(binned_.bins, earlier, later, noise, scores);
    }
  }
  sum_up(scores);
}

WhitenedSystem Analysis::scores_with(const std::vector<Eigen::MatrixXd>& more,
                                     const std::vector<std::size_t>& chosen) const {
  std::vector<Eigen::MatrixXd> columns;
  for (std::size_t f = 0; f < more.size(); ++f) {
    columns.push_back(side_by_side(binned_.columns[f].leftCols(base_), more[f]));
  }
  WhitenedSystem scores = whiten(columns, indices_of(chosen));
  take_out_common_noise(scores);
  const Eigen::Index of_added = shape_columns * as_index(added_.size());
  marginalize(scores, (chosen.empty() ? uncertainty_.front().cols() : of_added) + nuisances_);
  return scores;
}

Competition Analysis::competition(const std::vector<std::size_t>& chosen,
                                  const std::vector<Eigen::MatrixXd>& rivals) const {
  std::vector<Eigen::Index> effects = indices_of(chosen);
  effects.erase(effects.begin(), effects.begin() + base_);
  std::vector<Eigen::MatrixXd> more;
  for (std::size_t f = 0; f < rivals.size(); ++f)
    more.push_back(side_by_side(binned_.columns[f](Eigen::all, effects), rivals[f]));
  Competition result;
  result.system = scores_with(more, chosen);
  const Eigen::Index before = binned_.columns.front().cols() - base_;  // first column of the shapes
  Eigen::Index first = 0;
  for (const std::size_t group : chosen) {
    ColumnGroup& effect = result.groups.emplace_back(groups_[group]);
    effect.first = first;
    effect.shape_first += more.front().cols() - before;
    first += effect.count;
  }
  for (; first < more.front().cols(); first += as_index(reference_count())) {
    ColumnGroup& rival = result.groups.emplace_back();
    rival.first = first;
    rival.count = as_index(reference_count());
    rival.effect = groups_.size() + result.groups.size();
    rival.bounds.resize(reference_count());
  }
  return result;
}

Eigen::VectorXd Analysis::precision_of(const std::vector<std::size_t>& groups) const {
  Eigen::VectorXd precision = Eigen::VectorXd::Zero(as_index(indices_of(groups).size()));
  precision.head(base_) = prior_;
  Eigen::Index position = base_;
  for (const std::size_t group : groups) {
    for (std::size_t k = 0; k < groups_[group].typical.size(); ++k) {
      const double deviation = groups_[group].deviation(k);
      if (deviation > 0.0) precision[position + as_index(k)] = 1.0 / (deviation * deviation);
    }
    position += groups_[group].count;
  }
  return precision;
}

/// Coefficients that the rows hardly constrain stay near their typical size: a prior as in the search.
Eigen::VectorXd Analysis::solution(const Eigen::MatrixXd& products, double rows,
                                   const std::vector<std::size_t>& groups) const {
  const Eigen::Index count = products.cols() - 1;
  Eigen::MatrixXd normal = products.topLeftCorner(count, count);
  // Unit: variance of the rows.
  normal.diagonal() += products(count, count) / std::max(rows, 1.0) * precision_of(groups);
  return pseudo_solution(normal, products.col(count).head(count));
}

Eigen::MatrixXd Analysis::rows_of_refit(std::size_t flight, const std::vector<Eigen::Index>& indices) const {
  if (this->flight(flight).is_by_gps) {
    std::vector<Eigen::Index> with_residual = indices;
    with_residual.push_back(scores_->columns());
    return scores_->rows[flight](Eigen::all, with_residual);
  }
  return side_by_side(binned_.columns[flight](Eigen::all, indices), binned_.residuals[flight]);
}

Eigen::VectorXd Analysis::least_squares(const std::vector<std::size_t>& groups) const {
  const std::vector<Eigen::Index> indices = indices_of(groups);
  const auto sums = first_partition_.all_reduce_flights<PartialSums>([&](std::size_t f) {
    const Eigen::MatrixXd rows = rows_of_refit(f, indices);
    PartialSums of_flight(1, rows.cols());
    of_flight.products[0] = rows.transpose() * rows;
    of_flight.counts[0] = static_cast<double>(rows.rows()) / (flight(f).is_by_gps ? variance_factor_ : 1.0);
    return of_flight;
  });
  return coefficients(groups, solution(sums.products[0], sums.counts[0], groups));
}

HeldOut Analysis::held_out(const std::vector<std::size_t>& groups) const {
  const std::vector<Eigen::Index> indices = indices_of(groups);
  const Eigen::Index width = as_index(indices.size()) + 1;
  const auto part_of = [this](std::size_t f, Eigen::Index row) {
    const auto bin = static_cast<std::size_t>(scores_->bin_of(f, row));
    return held_out_part(*flight(f).samples, binned_.bins[f].time()[bin]);
  };
  std::vector<Eigen::MatrixXd> white(binned_.bins.size());
  // Whitened rows of each part first, then unwhitened ones.
  const auto sums = partition_.all_reduce_flights<PartialSums>([&](std::size_t f) {
    const Eigen::MatrixXd all = rows_of_refit(f, indices);
    white[f] = flight(f).is_by_gps ? all : whitened(all, binned_.bins[f], noise_[f], 0);
    PartialSums of_flight(2 * held_out_parts, width);
    for (Eigen::Index i = 0; i < all.rows(); ++i) {
      const std::size_t part = part_of(f, i);
      of_flight.add(part, white[f].row(i).transpose());
      // A refit weighs each reference by its noise.
      if (flight(f).reference == 0) of_flight.add(part + held_out_parts, all.row(i).transpose());
    }
    if (flight(f).is_by_gps) {
      for (double& count : of_flight.counts) count /= variance_factor_;
    }
    return of_flight;
  });
  // Prediction of each part from a fit to the others.
  const auto estimates_from = [&](std::size_t first) {
    Eigen::MatrixXd whole = Eigen::MatrixXd::Zero(width, width);
    double rows = 0.0;
    for (std::size_t part = first; part < first + held_out_parts; ++part) {
      whole += sums.products[part];
      rows += sums.counts[part];
    }
    std::vector<Eigen::VectorXd> estimates;
    for (std::size_t part = first; part < first + held_out_parts; ++part)
      estimates.push_back(solution(whole - sums.products[part], rows - sums.counts[part], groups));
    return estimates;
  };
  const auto [first, last] =
      std::pair(sums.counts.begin() + held_out_parts, sums.counts.begin() + 2 * held_out_parts);
  const bool has_parts =
      *std::max_element(first, last) <= max_share_of_part * std::accumulate(first, last, 0.0);
  const std::vector<Eigen::VectorXd> estimates = estimates_from(0);
  std::vector<Eigen::VectorXd> least_squares = estimates_from(held_out_parts);
  for (Eigen::VectorXd& estimate : least_squares) estimate = coefficients(groups, estimate);
  HeldOut result;
  result.chi2 = scores_->by_minutes([&](std::size_t f) {
    Eigen::VectorXd squares(white[f].rows());
    for (Eigen::Index i = 0; i < white[f].rows(); ++i) {
      const Eigen::VectorXd& estimate = estimates[part_of(f, i)];
      const double residual = white[f](i, width - 1) - white[f].row(i).head(width - 1) * estimate;
      squares[i] = residual * residual;
    }
    return squares;
  });
  result.rms = has_parts ? rms_of_parts(least_squares) : nan;
  return result;
}

double Analysis::rms_of_parts(const std::vector<Eigen::VectorXd>& coefficients) const {
  const auto sum = first_partition_.all_reduce_flights<SquareSum>([&](std::size_t f) {
    SquareSum of_flight;
    const FlightColumns& flight = flights_[f];
    std::vector<std::vector<double>> predicted;
    for (const Eigen::VectorXd& of_part : coefficients) predicted.push_back(added(f, of_part));
    for (const std::size_t record : binned_.bins[f].records()) {
      if (flight.residual[record] != flight.given[record]) continue;  // an outlier
      const std::size_t part = held_out_part(*flight.samples, flight.samples->time[record]);
      of_flight.add(flight.given[record] - predicted[part][record]);
    }
    return of_flight;
  });
  return sum.rms();
}

std::vector<double> Analysis::drift(std::size_t flight, const Eigen::VectorXd& coefficients) const {
  std::vector<double> result(flights_[flight].given.size(), nan);
  const Binning& bins = binned_.bins[flight];
  const Whitening whitening(bins, noise_[flight], 0);
  const Eigen::VectorXd series = whitening.slow_parts(binned_residual_after(flight, coefficients));
  for (std::size_t k = 0; k < bins.records().size(); ++k) result[bins.records()[k]] = series[bins.bins()[k]];
  return result;
}

}  // namespace pcor::internal

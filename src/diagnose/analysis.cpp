#include "diagnose/analysis.hpp"

#include <algorithm>
#include <cmath>

#include "numerics/decompositions.hpp"
#include "numerics/missing.hpp"
#include "numerics/spikes.hpp"
#include "numerics/triangular_factor.hpp"
#include "numerics/whitening.hpp"

namespace pcor::internal {
namespace {

constexpr int most_rounds = 4;
/// For the first noise: whatever might be an effect is taken off, a claim it is not.
constexpr double generous_threshold = 9.0;
constexpr std::size_t generous_effects = 6;
constexpr double stretch_time = 300.0;  // s
constexpr double least_eigenvalue = 1e-11;

template <class Value>
std::vector<Value> part(const std::vector<Value>& all, std::size_t first, std::size_t last) {
  return {all.begin() + static_cast<std::ptrdiff_t>(first), all.begin() + static_cast<std::ptrdiff_t>(last)};
}

}  // namespace

std::size_t held_out_part(const FlightSamples& samples, double time) {
  return static_cast<std::size_t>(std::fmod(std::floor((time - samples.time.front()) / stretch_time),
                                            static_cast<double>(held_out_parts)));
}

Analysis::Analysis(std::vector<FlightColumns> flights, std::vector<ColumnGroup> groups, std::uint64_t seed,
                   double explained)
    : groups_(std::move(groups)), seed_(seed) {
  base_ = flights.front().base.cols();
  for (FlightColumns& flight : flights) {
    const Binning& bins = bins_.emplace_back(flight.given, flight.samples->time, flight.samples->step,
                                             std::max(flight.window, Binning::usual_width));
    columns_.push_back(binned_columns(flight, bins));
    residuals_.push_back(bins.means(flight.given));
    (flight.reference == 0 ? flights_ : further_).push_back(std::move(flight));
  }
  first_bins_ = part(bins_, 0, flights_.size());
  Eigen::MatrixXd information = Eigen::MatrixXd::Zero(base_, base_);
  Eigen::VectorXd right = Eigen::VectorXd::Zero(base_);
  for (std::size_t f = 0; f < bins_.size(); ++f) {
    information += columns_[f].leftCols(base_).transpose() * columns_[f].leftCols(base_);
    right += columns_[f].leftCols(base_).transpose() * residuals_[f];
  }
  // Slow effects and slow drift contend for the same part of the residuals, so noise is found from both ends:
  // with whatever might be an effect taken off first, and with none. The likelier end counts.
  const Eigen::VectorXd start = pseudo_solution(information, right, least_eigenvalue);
  const double by_effects = search_from(start, true, explained);
  const bool drifts =
      std::any_of(noise_.begin(), noise_.end(), [](const auto& each) { return each.drifts(); });
  if (result_.chosen.empty() || drifts) {
    const SearchResult result = result_;
    const double by_drift = search_from(start, false, explained);
    if (by_effects > by_drift && result.chosen != result_.chosen) search_from(start, true, explained);
  }
}

double Analysis::search_from(const Eigen::VectorXd& start, bool generous, double explained) {
  std::vector<std::size_t> chosen;
  Eigen::VectorXd estimate = start;
  Eigen::MatrixXd covariance;
  for (int round = generous ? 0 : 1; round < most_rounds; ++round) {
    replace_outliers(chosen, estimate);
    if (round == 0)
      find_first_noise(estimate);
    else
      find_noise(chosen, estimate);
    find_search();
    SearchOptions options;
    options.seed = seed_;
    options.explained = explained;
    if (round == 0) {
      options.threshold = generous_threshold;
      options.most_effects = generous_effects;
    }
    result_ = search_->run(options);
    const bool stable = round > 1 && result_.chosen == chosen;
    chosen = result_.chosen;
    search_->fit(chosen, estimate, covariance);
    if (stable) break;
  }
  Eigen::Index columns = 0;
  for (const std::size_t group : chosen) columns += as_index(search_->told(group).size());
  return likelihood_ - static_cast<double>(columns) * result_.threshold;
}

std::vector<Eigen::MatrixXd> Analysis::columns_of(const std::vector<std::size_t>& groups) const {
  return part(all_columns_of(groups), 0, flights_.size());
}

std::vector<Eigen::MatrixXd> Analysis::all_columns_of(const std::vector<std::size_t>& groups) const {
  std::vector<Eigen::Index> places;
  for (Eigen::Index c = 0; c < base_; ++c) places.push_back(c);
  for (const std::size_t group : groups) {
    for (Eigen::Index k = 0; k < groups_[group].count; ++k)
      places.push_back(base_ + groups_[group].first + k);
  }
  std::vector<Eigen::MatrixXd> result;
  for (const Eigen::MatrixXd& columns : columns_) result.emplace_back(columns(Eigen::all, places));
  return result;
}

std::vector<Eigen::VectorXd> Analysis::left_by(const std::vector<std::size_t>& groups,
                                               const Eigen::VectorXd& estimate) const {
  std::vector<Eigen::VectorXd> left = residuals_;
  const std::vector<Eigen::MatrixXd> columns = all_columns_of(groups);
  for (std::size_t f = 0; f < left.size(); ++f) left[f] -= columns[f] * estimate;
  return left;
}

std::vector<double> Analysis::added(std::size_t flight, const std::vector<std::size_t>& groups,
                                    const Eigen::VectorXd& estimate) const {
  const FlightColumns& columns = this->flight(flight);
  std::vector<double> result(columns.given.size(), nan);
  for (const std::size_t record : bins_[flight].records()) {
    const Eigen::Index row = as_index(record);
    double sum = columns.base.row(row).cast<double>().dot(estimate.head(base_));
    Eigen::Index place = base_;
    for (const std::size_t group : groups) {
      for (Eigen::Index k = 0; k < groups_[group].count; ++k)
        sum += static_cast<double>(columns.candidates(row, groups_[group].first + k)) * estimate[place++];
    }
    result[record] = sum;
  }
  return result;
}

std::vector<double> Analysis::added_by(std::size_t flight, const std::vector<std::size_t>& groups,
                                       std::size_t which, const Eigen::VectorXd& estimate) const {
  const FlightColumns& columns = this->flight(flight);
  Eigen::Index place = base_;
  for (std::size_t i = 0; i < which; ++i) place += groups_[groups[i]].count;
  const ColumnGroup& group = groups_[groups[which]];
  std::vector<double> result(columns.given.size(), nan);
  for (const std::size_t record : bins_[flight].records()) {
    result[record] = columns.candidates.row(as_index(record))
                         .segment(group.first, group.count)
                         .cast<double>()
                         .dot(estimate.segment(place, group.count));
  }
  return result;
}

void Analysis::replace_outliers(const std::vector<std::size_t>& groups, const Eigen::VectorXd& estimate) {
  for (std::size_t f = 0; f < bins_.size(); ++f) {
    FlightColumns& flight = this->flight(f);
    std::size_t count = 0;
    const std::vector<double> predicted = added(f, groups, estimate);
    flight.residual =
        without_outliers(flight.given, predicted, flight.samples->time, flight.samples->step, count);
    // A record that is in no bin has no prediction; it does not count anyway.
    residuals_[f] = bins_[f].means(flight.residual);
  }
  first_residuals_ = part(residuals_, 0, flights_.size());
}

template <class Find>
void Analysis::for_each_reference(const Find& find) {
  noise_.resize(bins_.size());
  for (std::size_t first = 0; first < bins_.size();) {
    std::size_t last = first;
    while (last < bins_.size() && flight(last).reference == flight(first).reference) ++last;
    const NoiseModel model = find(first, last);
    if (first == 0) first_noise_ = model;
    for (std::size_t f = first; f < last; ++f) {
      noise_[f] = model;
      noise_[f].level = {model.level[f - first]};
    }
    first = last;
  }
}

void Analysis::find_first_noise(const Eigen::VectorXd& estimate) {
  const std::vector<Eigen::VectorXd> left = left_by({}, estimate);
  for_each_reference([&](std::size_t first, std::size_t last) {
    return estimate_noise(part(bins_, first, last), part(left, first, last));
  });
  keep_coefficients({}, estimate);
}

void Analysis::find_noise(const std::vector<std::size_t>& groups, const Eigen::VectorXd& estimate) {
  const std::vector<Eigen::VectorXd> left = left_by(groups, estimate);
  const std::vector<Eigen::MatrixXd> columns = all_columns_of(groups);
  likelihood_ = 0.0;
  for_each_reference([&](std::size_t first, std::size_t last) {
    const FoundNoise found =
        internal::find_noise(part(bins_, first, last), part(columns, first, last), part(left, first, last));
    if (first == 0) drift_gain_ = found.drift_gain;
    likelihood_ += found.likelihood;
    return with_slower_noise(found.model);  // the likelihood is that of what the flights tell
  });
  keep_coefficients(groups, estimate);
}

void Analysis::keep_coefficients(const std::vector<std::size_t>& groups, const Eigen::VectorXd& estimate) {
  coefficients_ = Eigen::VectorXd::Zero(columns_.front().cols());
  coefficients_.head(base_) = estimate.head(base_);
  Eigen::Index place = base_;
  for (const std::size_t group : groups) {
    coefficients_.segment(base_ + groups_[group].first, groups_[group].count) =
        estimate.segment(place, groups_[group].count);
    place += groups_[group].count;
  }
}

void Analysis::find_search() {
  scores_ = std::make_unique<Scores>(find_scores(bins_, columns_, residuals_, noise_));
  white_noise_.clear();
  for (std::size_t f = 0; f < bins_.size(); ++f) white_noise_.push_back(scores_->left(f, coefficients_));
  take_out_common_noise(*scores_);
  search_ = std::make_unique<Search>(*scores_, base_, groups_);
}

void Analysis::take_out_common_noise(Scores& scores) const {
  if (further_.empty()) return;
  std::vector<Eigen::VectorXd> left = white_noise_;
  for (std::size_t later = flights_.size(); later < bins_.size(); ++later) {
    for (std::size_t earlier = 0; earlier < later; ++earlier) {
      if (flight(earlier).samples->name == flight(later).samples->name &&
          flight(earlier).window == flight(later).window)
        internal::take_out_common_noise(bins_, earlier, later, left, scores);
    }
  }
  sum_up(scores);
}

Scores Analysis::scores_with(const std::vector<Eigen::MatrixXd>& more) const {
  std::vector<Eigen::MatrixXd> columns;
  for (std::size_t f = 0; f < more.size(); ++f) {
    Eigen::MatrixXd& both = columns.emplace_back(more[f].rows(), base_ + more[f].cols());
    both << columns_[f].leftCols(base_), more[f];
  }
  Scores scores = find_scores(bins_, columns, residuals_, noise_);
  take_out_common_noise(scores);
  return scores;
}

HeldOut Analysis::held_out(const std::vector<std::size_t>& groups) const {
  const std::vector<Eigen::MatrixXd> columns = all_columns_of(groups);
  const Eigen::Index width = columns.front().cols() + 1;
  std::vector<Eigen::MatrixXd> information(held_out_parts, Eigen::MatrixXd::Zero(width, width));
  const auto part_of = [this](std::size_t f, double time) { return held_out_part(*flight(f).samples, time); };
  std::vector<Eigen::MatrixXd> white;
  for (std::size_t f = 0; f < columns.size(); ++f) {
    Eigen::MatrixXd all(columns[f].rows(), width);
    all << columns[f], residuals_[f];
    white.push_back(whitened(all, bins_[f], noise_[f], 0));
    for (Eigen::Index i = 0; i < white[f].rows(); ++i) {
      information[part_of(f, bins_[f].time()[static_cast<std::size_t>(i)])]
          .selfadjointView<Eigen::Lower>()
          .rankUpdate(white[f].row(i).transpose());
    }
  }
  Eigen::MatrixXd whole = Eigen::MatrixXd::Zero(width, width);
  for (Eigen::MatrixXd& part : information) {
    part = part.selfadjointView<Eigen::Lower>();
    whole += part;
  }
  std::vector<Eigen::VectorXd> estimates;
  for (const Eigen::MatrixXd& part : information) {
    const Eigen::MatrixXd rest = whole - part;
    estimates.push_back(pseudo_solution(rest.topLeftCorner(width - 1, width - 1),
                                        rest.col(width - 1).head(width - 1), least_eigenvalue));
  }
  HeldOut result;
  result.chi2 = Eigen::VectorXd::Zero(scores_->blocks);
  for (std::size_t f = 0; f < columns.size(); ++f) {
    for (Eigen::Index i = 0; i < white[f].rows(); ++i) {
      const auto bin = static_cast<std::size_t>(i);
      const Eigen::VectorXd& estimate = estimates[part_of(f, bins_[f].time()[bin])];
      const double left = white[f](i, width - 1) - white[f].row(i).head(width - 1) * estimate;
      result.chi2[scores_->block[f][bin]] += left * left;
    }
  }
  double squares = 0.0;
  double count = 0.0;
  for (std::size_t f = 0; f < flights_.size(); ++f) {
    std::vector<std::vector<double>> predicted;
    for (const Eigen::VectorXd& estimate : estimates) predicted.push_back(added(f, groups, estimate));
    for (const std::size_t record : bins_[f].records()) {
      if (flights_[f].residual[record] != flights_[f].given[record]) continue;  // an outlier
      const std::size_t part = part_of(f, flights_[f].samples->time[record]);
      const double left = flights_[f].given[record] - predicted[part][record];
      squares += left * left;
      count += 1.0;
    }
  }
  result.rms = std::sqrt(squares / count);
  return result;
}

std::vector<double> Analysis::drift(std::size_t flight, const std::vector<std::size_t>& groups) const {
  std::vector<double> result(flights_[flight].given.size(), nan);
  const Binning& bins = bins_[flight];
  Eigen::VectorXd estimate;
  Eigen::MatrixXd covariance;
  search_->fit(groups, estimate, covariance);
  const Whitening whitening(bins, noise_[flight], 0);
  const Eigen::VectorXd series = whitening.slow_parts(left_by(groups, estimate)[flight]);
  for (std::size_t k = 0; k < bins.records().size(); ++k) result[bins.records()[k]] = series[bins.bins()[k]];
  return result;
}

}  // namespace pcor::internal

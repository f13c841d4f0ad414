#include "campaign/whitened.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <string>
#include <utility>

#include <pcor/numerics/noise.hpp>
#include "numerics/decompositions.hpp"
#include "numerics/noise_covariance.hpp"
#include "numerics/triangular_factor.hpp"
#include "parallel/serialization.hpp"

namespace pcor::internal {
namespace {

/// Flights from `first` until `last` that determine the noise.
std::vector<std::size_t> few_of(const std::vector<NoiseFlight>& flights, std::size_t first,
                                std::size_t last) {
  const auto begin = flights.begin();
  std::vector<std::size_t> few = flights_for_noise(
      {begin + static_cast<std::ptrdiff_t>(first), begin + static_cast<std::ptrdiff_t>(last)});
  for (std::size_t& flight : few) flight += first;
  return few;
}

constexpr double block_time = 60.0;  // s

/// A flight in bins, for the ranks that do not own it: derivatives or other columns, and the
/// residual last.
using BinnedRows = std::pair<Binning, Eigen::MatrixXd>;

/// Columns that are not zero in all flights: a reference is insensitive to some coefficients.
std::vector<Eigen::Index> columns_seen(const std::vector<BinnedRows>& flights) {
  std::vector<Eigen::Index> seen;
  for (Eigen::Index k = 0; k + 1 < flights.front().second.cols(); ++k) {
    if (std::any_of(flights.begin(), flights.end(),
                    [k](const BinnedRows& flight) { return !flight.second.col(k).isZero(0.0); }))
      seen.push_back(k);
  }
  return seen;
}

/// Rows and minutes of a flight.
using RowCount = std::pair<std::size_t, Eigen::Index>;

/// The number of the minute of each bin, from 0. @return how many there are
Eigen::Index find_blocks(const Binning& bins, std::vector<Eigen::Index>& block) {
  Eigen::Index blocks = 0;
  double begin = -std::numeric_limits<double>::infinity();
  for (const double time : bins.time()) {
    if (time >= begin + block_time) {
      begin = time;
      ++blocks;
    }
    block.push_back(blocks - 1);
  }
  return blocks;
}

}  // namespace

std::vector<NoiseModel> noise_of_flights(const FlightPartition& partition, const BinnedFlights& flights,
                                         const BinnedFit& fit, const FindNoise& find) {
  std::vector<NoiseModel> noise(flights.bins.size());
  for (std::size_t first = 0; first < noise.size();) {
    std::size_t last = first;
    while (last < noise.size() && flights.reference[last] == flights.reference[first]) ++last;
    const std::vector<std::size_t> few = few_of(flights.outlines, first, last);
    const auto rows_of = partition.of_entries(few).all_gather_flights<BinnedRows>(
        [&](std::size_t k) {
          return BinnedRows{flights.bins[few[k]], side_by_side(fit.columns(few[k]), fit.residual(few[k]))};
        },
        fit.state);
    std::vector<Binning> bins;
    std::vector<Eigen::MatrixXd> columns;
    std::vector<Eigen::VectorXd> residuals;
    const std::vector<Eigen::Index> seen = columns_seen(rows_of);
    for (const auto& [binning, rows] : rows_of) {
      bins.push_back(binning);
      columns.emplace_back(rows(Eigen::all, seen));
      residuals.emplace_back(rows.rightCols(1));
    }
    NoiseModel shared = find(bins, columns, residuals);
    shared.level.clear();
    for (; first < last; ++first) {
      noise[first] = shared;
      noise[first].level.resize(1);
      if (!partition.is_local(first)) continue;
      const Binning& binning = flights.bins[first];
      noise[first].level[0] = noise_levels(binning, fit.residual(first), shared);
    }
  }
  return noise;
}

NoiseModel noise_of_first_reference(const BinnedFlights& flights, const std::vector<NoiseModel>& noise) {
  NoiseModel first = noise.front();
  first.level.clear();
  for (std::size_t f = 0; f < noise.size() && flights.reference[f] == 0; ++f)
    first.level.push_back(noise[f].level[0]);
  return first;
}

Eigen::MatrixXd side_by_side(const Eigen::MatrixXd& left, const Eigen::MatrixXd& right) {
  Eigen::MatrixXd both(left.rows(), left.cols() + right.cols());
  both << left, right;
  return both;
}

double robust_deviation(Communicator& comm, const std::vector<Eigen::VectorXd>& values) {
  std::vector<double> all;
  for (const std::string& bytes : comm.all_gather(serialized(values))) {
    for (const auto& each : deserialized<std::vector<Eigen::VectorXd>>(bytes))
      all.insert(all.end(), each.begin(), each.end());
  }
  return robust_standard_deviation(std::move(all));
}

Eigen::VectorXd weights_of_bins(const Binning& bins, double deviation) {
  if (bins.size() == 0) return bins.counts();
  return (bins.counts() / bins.counts().maxCoeff()).cwiseSqrt() / deviation;
}

double information_about_mean(const Binning& bins, const NoiseModel& noise) {
  if (bins.size() == 0) return 0.0;
  const auto count = static_cast<double>(bins.size());
  const Eigen::MatrixXd ones = Eigen::MatrixXd::Ones(as_index(bins.size()), 1);
  return count * count / noise_covariance(ones, bins, noise, 0)(0, 0);
}

void PartialSums::add(std::size_t part, const Eigen::VectorXd& row) {
  products[part].noalias() += row * row.transpose();
  counts[part] += 1.0;
}

PartialSums& PartialSums::operator+=(const PartialSums& other) {
  for (std::size_t part = 0; part < counts.size(); ++part) {
    products[part] += other.products[part];
    counts[part] += other.counts[part];
  }
  return *this;
}

std::vector<Eigen::VectorXd> WhitenedSystem::sums_of_columns(const Eigen::VectorXd& coefficients) const {
  std::vector<Eigen::VectorXd> result(rows.size());
  for (std::size_t f = 0; f < rows.size(); ++f) {
    if (!partition.is_local(f)) continue;
    result[f] = Eigen::VectorXd::Zero(rows[f].rows());
    for (Eigen::Index k = 0; k < columns(); ++k) {
      if (coefficients[k] != 0.0) result[f] += coefficients[k] * rows[f].col(k);  // most are zero
    }
  }
  return result;
}

std::vector<Eigen::VectorXd> WhitenedSystem::residuals_after(const Eigen::VectorXd& coefficients) const {
  std::vector<Eigen::VectorXd> result = sums_of_columns(coefficients);
  for (std::size_t f = 0; f < rows.size(); ++f) {
    if (partition.is_local(f)) result[f] = rows[f].col(columns()) - result[f];
  }
  return result;
}

Eigen::VectorXd WhitenedSystem::by_minutes(const std::function<Eigen::VectorXd(std::size_t)>& of_rows) const {
  const auto parts = partition.all_gather_flights<Eigen::VectorXd>([&](std::size_t f) {
    if (block[f].empty()) return Eigen::VectorXd();
    const Eigen::VectorXd values = of_rows(f);
    const Eigen::Index first = block[f].front();
    Eigen::VectorXd sums = Eigen::VectorXd::Zero(block[f].back() - first + 1);
    for (Eigen::Index i = 0; i < values.size(); ++i)
      sums[block[f][static_cast<std::size_t>(bin_of(f, i))] - first] += values[i];
    return sums;
  });
  Eigen::VectorXd all(blocks);
  Eigen::Index first = 0;
  for (const Eigen::VectorXd& part : parts) {
    all.segment(first, part.size()) = part;
    first += part.size();
  }
  return all;
}

void sum_up(WhitenedSystem& scores) {
  scores.information = scores.partition.all_reduce_flights<Eigen::MatrixXd>(
      [&](std::size_t f) { return products_of(scores.rows[f]); }, scores.partition.threads());
}

void marginalize(WhitenedSystem& system, Eigen::Index count) {
  if (count == 0) return;
  const Eigen::Index first = system.columns() - count;
  std::vector<Eigen::Index> kept(static_cast<std::size_t>(first));
  std::iota(kept.begin(), kept.end(), Eigen::Index{0});
  kept.push_back(system.columns());
  const Eigen::MatrixXd across = system.information(kept, Eigen::all).middleCols(first, count);
  Eigen::MatrixXd inner = system.information.block(first, first, count, count);
  inner.diagonal().array() += 1.0;
  const Eigen::MatrixXd fit = symmetric_solution(inner, Eigen::MatrixXd(across.transpose()));
  system.information = (system.information(kept, kept) - across * fit).eval();
  system.plain = system.plain(kept, kept).eval();
  for (Eigen::MatrixXd& rows : system.rows) {
    if (rows.size() > 0) rows = (rows(Eigen::all, kept) - rows.middleCols(first, count) * fit).eval();
  }
}

void take_out_common_noise(const std::vector<Binning>& bins, std::size_t earlier, std::size_t later,
                           std::vector<Eigen::VectorXd>& noise, WhitenedSystem& scores) {
  constexpr double same_time = 2.0;  // s: half a bin
  constexpr std::size_t fewest = 60;
  const std::vector<double>& before = bins[earlier].time();
  const std::vector<double>& after = bins[later].time();
  std::vector<std::pair<Eigen::Index, Eigen::Index>> pairs;
  for (std::size_t i = 0, k = 0; i < before.size() && k < after.size();) {
    if (before[i] < after[k] - same_time) {
      ++i;
    } else if (after[k] < before[i] - same_time) {
      ++k;
    } else {
      pairs.emplace_back(as_index(i++), as_index(k++));
    }
  }
  if (pairs.size() < fewest) return;
  double product = 0.0;
  double squares = 0.0;
  double others = 0.0;
  for (const auto& [i, k] : pairs) {
    product += noise[earlier][i] * noise[later][k];
    squares += noise[earlier][i] * noise[earlier][i];
    others += noise[later][k] * noise[later][k];
  }
  const double correlation = product / std::sqrt(squares * others);
  if (!(std::abs(correlation) < 1.0)) return;
  const double scale = 1.0 / std::sqrt(1.0 - correlation * correlation);
  const double slope = product / squares;
  for (const auto& [i, k] : pairs) {
    scores.rows[later].row(k) -= slope * scores.rows[earlier].row(i);
    scores.rows[later].row(k) *= scale;
    noise[later][k] = scale * (noise[later][k] - slope * noise[earlier][i]);
  }
}

WhitenedSystem whiten_system(const FlightPartition& partition, const std::vector<Binning>& bins,
                             const std::vector<Eigen::MatrixXd>& columns,
                             const std::vector<Eigen::VectorXd>& residuals,
                             const std::vector<NoiseModel>& noise, const std::vector<WhiteFlight>& white,
                             bool sums_up) {
  WhitenedSystem scores;
  scores.partition = partition;
  scores.rows.resize(bins.size());
  scores.bin.resize(bins.size());
  scores.block.resize(bins.size());
  const auto is_white = [&white](std::size_t f) { return !white.empty() && white[f].rows.size() > 0; };
  const auto counts = partition.all_gather_flights<RowCount>(
      [&](std::size_t f) {
        if (is_white(f)) {
          scores.rows[f] = white[f].rows;
          scores.bin[f] = white[f].bin;
        } else {
          scores.rows[f] = whitened(side_by_side(columns[f], residuals[f]), bins[f], noise[f], 0);
        }
        return RowCount{static_cast<std::size_t>(scores.rows[f].rows()),
                        find_blocks(bins[f], scores.block[f])};
      },
      0, partition.threads());
  for (std::size_t f = 0; f < counts.size(); ++f) {
    for (Eigen::Index& block : scores.block[f]) block += scores.blocks;
    const auto& [rows, blocks] = counts[f];
    scores.row_count += rows;
    scores.blocks += blocks;
  }
  const bool drifts =
      std::any_of(noise.begin(), noise.end(), [](const NoiseModel& each) { return each.has_drift(); });
  if (sums_up || !drifts) sum_up(scores);
  scores.plain = scores.information;
  if (drifts) {
    scores.plain = partition.all_reduce_flights<Eigen::MatrixXd>(
        [&](std::size_t f) {
          NoiseModel still = noise[f];
          still.drift_component_rms = {};
          return products_of(noise[f].has_drift() && !is_white(f)
                                 ? whitened(side_by_side(columns[f], residuals[f]), bins[f], still, 0)
                                 : scores.rows[f]);
        },
        partition.threads());
  }
  return scores;
}

WhitenedSystem whiten_system(const FlightPartition& partition, const std::vector<Binning>& bins,
                             const std::vector<Eigen::MatrixXd>& columns,
                             const std::vector<Eigen::VectorXd>& residuals, const NoiseModel& noise) {
  NoiseModel shared = noise;
  shared.level.clear();  // one copy of all levels for each flight would grow with the square of their number
  std::vector<NoiseModel> each(bins.size(), shared);
  for (std::size_t f = 0; f < bins.size(); ++f) each[f].level = {noise.level[f]};
  return whiten_system(partition, bins, columns, residuals, each);
}

}  // namespace pcor::internal

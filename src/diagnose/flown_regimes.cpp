#include "diagnose/flown_regimes.hpp"

#include <array>
#include <utility>

#include "numerics/triangular_factor.hpp"
#include "parallel/packed.hpp"

namespace pcor::internal {
namespace {

/// All intervals of a regime.
struct RegimeSum {
  Eigen::MatrixXd information{};
  double intervals = 0.0;
  double duration = 0.0;  ///< s
  std::string flight{};
  double longest = 0.0;  ///< duration on that flight, s

  RegimeSum& operator+=(const RegimeSum& other) {
    if (other.information.size() == 0) return *this;
    if (information.size() == 0) return *this = other;
    information += other.information;
    intervals += other.intervals;
    duration += other.duration;
    if (other.longest > longest) {
      flight = other.flight;
      longest = other.longest;
    }
    return *this;
  }

  template <class Archive>
  void serialize(Archive& archive) {
    archive(information, intervals, duration, flight, longest);
  }
};

/// Sums of each regime in the order of `Regime`.
struct RegimeSums {
  std::array<RegimeSum, regime_count> of{};

  RegimeSums& operator+=(const RegimeSums& other) {
    for (std::size_t r = 0; r < regime_count; ++r) of[r] += other.of[r];
    return *this;
  }

  template <class Archive>
  void serialize(Archive& archive) {
    archive(of);
  }
};

/// Whether a pilot can repeat the regime. Events on a level leg other than level flight cannot be repeated.
bool can_be_repeated(Regime regime) { return regime >= Regime::climb && regime != Regime::level; }

RegimeSums sums_of(const WhitenedSystem& scores, std::size_t number, const FlightInBins& flight) {
  const Eigen::MatrixXd& rows = scores.rows[number];
  constexpr auto phases = static_cast<std::size_t>(Regime::level) + 1;
  const FlightSamples& samples = *flight.columns.samples;
  const std::vector<double>& time = flight.bins.time();
  const std::vector<RegimeSet> regimes = regimes_of_samples(time, samples.intervals);
  RegimeSums sums;
  for (const Interval& interval : samples.intervals) {
    if (!can_be_repeated(interval.regime)) continue;
    std::vector<Eigen::Index> own;
    double within = 0.0;
    for (Eigen::Index row = 0; row < rows.rows(); ++row) {
      const auto i = static_cast<std::size_t>(scores.bin_of(number, row));
      if (time[i] < interval.begin || time[i] >= interval.end) continue;
      within += 1.0;
      if (!is_phase(interval.regime) || (regimes[i] >> phases).none()) own.push_back(row);
    }
    if (own.empty()) continue;
    const Eigen::MatrixXd columns = rows(own, Eigen::seqN(0, rows.cols() - 1));
    RegimeSum part{columns.transpose() * columns};
    if (flight.columns.reference == 0) {  // an interval counts once for all references
      part.intervals = 1.0;
      part.duration = (interval.end - interval.begin) * static_cast<double>(own.size()) / within;
    }
    sums.of[static_cast<std::size_t>(interval.regime)] += part;
  }
  for (RegimeSum& sum : sums.of) {
    sum.flight = samples.name;
    sum.longest = sum.duration;
  }
  return sums;
}

}  // namespace

std::vector<FlownRegime> flown_regimes(const WhitenedSystem& scores,
                                       const std::function<FlightInBins(std::size_t flight)>& flight) {
  auto sums = scores.share.sum_of_each_flight<RegimeSums>(
      [&](std::size_t f) { return sums_of(scores, f, flight(f)); });
  std::vector<FlownRegime> regimes;
  for (std::size_t r = 0; r < regime_count; ++r) {
    RegimeSum& sum = sums.of[r];
    if (sum.intervals == 0.0) continue;
    regimes.push_back({static_cast<Regime>(r), sum.duration / sum.intervals, sum.information / sum.intervals,
                       std::move(sum.flight)});
  }
  return regimes;
}

}  // namespace pcor::internal

#include "diagnose/variable_values.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "parallel/distributed_quantile.hpp"

namespace pcor::internal {
namespace {

/// Contribution of a flight to the sums over all flights.
struct ValueSums {
  std::size_t count = 0;
  std::size_t missing = 0;
  double sum = 0.0;
  double minimum = std::numeric_limits<double>::infinity();
  double maximum = -std::numeric_limits<double>::infinity();

  ValueSums& operator+=(const ValueSums& other) {
    count += other.count;
    missing += other.missing;
    sum += other.sum;
    minimum = std::min(minimum, other.minimum);
    maximum = std::max(maximum, other.maximum);
    return *this;
  }

  template <class Archive>
  void serialize(Archive& archive) {
    archive(count, missing, sum, minimum, maximum);
  }
};

}  // namespace

VariableValues::VariableValues(const FlightPartition& share,
                               const std::function<std::vector<double>(std::size_t)>& values_of)
    : share_(share), values_(share.flights()) {
  const auto sums = share.sum_of_each_flight<ValueSums>([&](std::size_t flight) {
    std::vector<double>& values = values_[flight];
    values = values_of(flight);
    ValueSums part;
    part.missing = values.size();
    values.erase(std::remove_if(values.begin(), values.end(), [](double x) { return !std::isfinite(x); }),
                 values.end());
    part.count = values.size();
    part.missing -= part.count;
    for (const double value : values) {
      part.sum += value;
      part.minimum = std::min(part.minimum, value);
      part.maximum = std::max(part.maximum, value);
    }
    return part;
  });
  count_ = sums.count;
  missing_ = sums.missing;
  if (count_ == 0) return;
  minimum_ = sums.minimum;
  maximum_ = sums.maximum;
  mean_ = sums.sum / static_cast<double>(count_);
  const auto squares = share.sum_of_each_flight<double>([this](std::size_t flight) {
    double sum = 0.0;
    for (const double value : values_[flight]) sum += (value - mean_) * (value - mean_);
    return sum;
  });
  deviation_ = std::sqrt(squares / static_cast<double>(count_));
}

std::vector<double> VariableValues::distinct(std::size_t maximum) const {
  std::vector<double> all;  // sorted
  const auto add = [&all](double value) {
    const auto position = std::lower_bound(all.begin(), all.end(), value);
    if (position == all.end() || *position != value) all.insert(position, value);
  };
  const auto of_flights = share_.of_each_flight<std::vector<double>>([&](std::size_t flight) {
    all.clear();
    for (std::size_t i = 0; i < values_[flight].size() && all.size() <= maximum; ++i) add(values_[flight][i]);
    return all;
  });
  all.clear();
  for (const std::vector<double>& of_flight : of_flights) {
    for (const double value : of_flight) add(value);
  }
  return all;
}

std::vector<double> VariableValues::quantiles(std::size_t number) const {
  std::vector<double> local;
  for (const std::vector<double>& values : values_) local.insert(local.end(), values.begin(), values.end());
  return values_at(share_.comm(), std::move(local), [number](std::uint64_t count) {
    std::vector<std::uint64_t> requested;
    for (std::size_t k = 0; k < number; ++k) {
      const double part = static_cast<double>(k) / static_cast<double>(number - 1);
      requested.push_back(static_cast<std::uint64_t>(part * static_cast<double>(count - 1)));
    }
    return requested;
  });
}

}  // namespace pcor::internal

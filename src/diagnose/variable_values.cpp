#include "diagnose/variable_values.hpp"

#include <cereal/types/set.hpp>

#include <algorithm>
#include <cmath>
#include <set>

#include "parallel/distributed_quantile.hpp"

namespace pcor::internal {

VariableValues::VariableValues(const FlightPartition& share,
                               const std::function<std::vector<double>(std::size_t)>& values_of)
    : share_(share), values_(share.flights()) {
  sums_ = share.sum_of_each_flight<Sums>([&](std::size_t flight) {
    std::vector<double>& values = values_[flight];
    values = values_of(flight);
    Sums part;
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
  if (sums_.count == 0) return;
  mean_ = sums_.sum / static_cast<double>(sums_.count);
  const auto squares = share.sum_of_each_flight<double>([this](std::size_t flight) {
    double sum = 0.0;
    for (const double value : values_[flight]) sum += (value - mean_) * (value - mean_);
    return sum;
  });
  deviation_ = std::sqrt(squares / static_cast<double>(sums_.count));
}

std::vector<double> VariableValues::distinct(std::size_t maximum) const {
  const auto of_flights = share_.of_each_flight<std::set<double>>([&](std::size_t flight) {
    std::set<double> own;
    for (std::size_t i = 0; i < values_[flight].size() && own.size() <= maximum; ++i)
      own.insert(values_[flight][i]);
    return own;
  });
  std::set<double> all;
  for (const std::set<double>& of_flight : of_flights) all.insert(of_flight.begin(), of_flight.end());
  return {all.begin(), all.end()};
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

#include "diagnose/manoeuvres/path.hpp"

#include <algorithm>
#include <cmath>

namespace pcor::internal::manoeuvres {
namespace {

constexpr double pi = 3.14159265358979323846;

/// From 0 to 1 while `part` goes from 0 to 1, level at both ends.
double eased(double part) { return 0.5 * (1.0 - std::cos(pi * std::clamp(part, 0.0, 1.0))); }

}  // namespace

Course constant(double value) {
  return [value](double) { return value; };
}

Course through(std::vector<std::pair<double, double>> points) {
  return [points = std::move(points)](double t) {
    const auto after = std::upper_bound(points.begin(), points.end(), t,
                                        [](double time, const auto& point) { return time < point.first; });
    if (after == points.begin()) return points.front().second;
    if (after == points.end()) return points.back().second;
    const auto& [begin, from] = *(after - 1);
    const auto& [end, to] = *after;
    return from + (to - from) * (t - begin) / (end - begin);
  };
}

Course oscillation(double amplitude, double period, double cycles, double ramp) {
  return [=](double t) {
    const double left = period * cycles - t;
    return amplitude * eased(std::min(t, left) / ramp) * std::sin(2.0 * pi * t / period);
  };
}

Course steady_change(double rate, double begin, double end, double ramp) {
  const auto since = [ramp](double t) {
    if (t <= 0.0) return 0.0;
    return t < ramp ? 0.5 * t * t / ramp : t - 0.5 * ramp;
  };
  return [=](double t) { return rate * (since(t - begin) - since(t - end + ramp)); };
}

}  // namespace pcor::internal::manoeuvres

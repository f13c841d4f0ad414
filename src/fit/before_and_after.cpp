#include "fit/before_and_after.hpp"

#include <cmath>

#include "numerics/missing.hpp"

namespace pcor::internal {
namespace {

/// A flight's part that was fitted, the first `training_share` of its samples, and the part that was held
/// out.
std::vector<FlightFit> parts_of(const Residuals& residuals, const FitTask& task,
                                const Eigen::VectorXd& values, double training_share) {
  const FlightSamples& samples = residuals.samples();
  const std::vector<double> before = residuals.values(task.start.data());
  const std::vector<double> after = residuals.values(values.data());
  std::vector<std::size_t> used;
  for (std::size_t i = 0; i < after.size(); ++i) {
    if (residuals.mask()[i] == Mask::none) used.push_back(i);
  }
  const auto training =
      static_cast<std::size_t>(std::llround(training_share * static_cast<double>(used.size())));
  std::vector<bool> first(after.size(), false);
  std::vector<bool> second(after.size(), false);
  std::vector<double> series(after.size(), nan);
  for (std::size_t i = 0; i < used.size(); ++i) {
    (i < training ? first : second)[used[i]] = true;
    series[used[i]] = after[used[i]];
  }
  const NoiseFloor noise =
      noise_floor(series, stretches_of(series, samples.time, samples.step), samples.step);
  std::vector<FlightFit> parts;
  const auto add = [&](const std::vector<bool>& part, bool held) {
    parts.push_back(
        {samples.name, held, statistics_of(before, noise, part), statistics_of(after, noise, part)});
  };
  if (training > 0) add(first, false);
  if (training < used.size()) add(second, true);
  return parts;
}

}  // namespace

double BeforeAndAfter::noise_rms(std::size_t samples) const {
  double squares = 0.0;
  for (const FlightFit& flight : flights) {
    if (!flight.holdout)
      squares += flight.after.noise_rms * flight.after.noise_rms * static_cast<double>(flight.after.samples);
  }
  return std::sqrt(squares / static_cast<double>(samples));
}

BeforeAndAfter before_and_after(FitFlights& flights, const Eigen::VectorXd& values) {
  const FitTask& task = flights.task();
  std::vector<BeforeAndAfter> each(flights.count());
  flights.visit([&](std::size_t number, std::size_t, FitFlight& fit) {
    const FlightSamples& samples = fit.residuals().samples();
    each[number].flights = parts_of(fit.residuals(), task, values, task.options.training_share);
    for (const std::string& note : samples.notes) each[number].notes.push_back(samples.name + ": " + note);
    for (const Interval& interval : samples.intervals)
      each[number].flown.set(static_cast<std::size_t>(interval.regime));
  });
  for (const std::filesystem::path& path : task.options.holdout) {
    const Flight file(path, task.options.time_stamp);
    const auto samples = std::make_shared<const FlightSamples>(
        read_samples(file, task.model, task.reference, task.options.mask));
    const Residuals residuals(samples, task.model, task.reference, task.options.mask);
    each.emplace_back().flights = parts_of(residuals, task, values, 0.0);
  }
  BeforeAndAfter all;
  for (const BeforeAndAfter& one : each) {
    all.flights.insert(all.flights.end(), one.flights.begin(), one.flights.end());
    all.notes.insert(all.notes.end(), one.notes.begin(), one.notes.end());
    all.flown |= one.flown;
  }
  return all;
}

}  // namespace pcor::internal

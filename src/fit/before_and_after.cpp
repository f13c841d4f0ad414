#include "fit/before_and_after.hpp"

#include <cmath>

#include "base/phrasing.hpp"
#include "residuals/flight_statistics.hpp"
#include "residuals/masks.hpp"
#include "residuals/packed_residuals.hpp"

namespace pcor {

template <class Archive>
void serialize(Archive& archive, FlightFit& flight) {
  archive(flight.flight, flight.holdout, flight.before, flight.after, flight.expected_bias, flight.gain,
          flight.gain_error, flight.reference);
}

std::optional<HeldOutPart> worst_held_out(const std::vector<FlightFit>& flights) {
  std::optional<HeldOutPart> worst;
  const auto excess = [](const HeldOutPart& part) { return std::abs(part.statistics.bias) / part.expected; };
  std::size_t parts = 0;
  for (const FlightFit& flight : flights) {
    const HeldOutPart part{flight.flight, flight.after, flight.expected_bias};
    if (flight.holdout) ++parts;
    if (flight.holdout && part.expected > 0.0 && (!worst || excess(part) > excess(*worst))) worst = part;
  }
  if (worst) worst->parts = parts;
  return worst;
}

namespace internal {
namespace {

/// A flight before and after the fit.
struct Compared {
  std::vector<FlightFit> parts{};  ///< the part that was fitted, and the part that was held out
  std::vector<double> fitted_blocks{};
  std::size_t held_out_blocks = 0;
  Eigen::VectorXd held_out_derivatives{};  ///< mean over held-out samples, by the fitted parameters
  ResidualSums flaps_out{};
  std::vector<FlightNote> notes{};
  RegimeSet flown{};

  template <class Archive>
  void serialize(Archive& archive) {
    archive(parts, fitted_blocks, held_out_blocks, held_out_derivatives, flaps_out, notes, flown);
  }
};

Compared compared(const LinearRows& rows, const FitTask& task, const Eigen::VectorXd& values,
                  const std::vector<std::size_t>& wanted) {
  const Residuals& residuals = rows.residuals();
  const FlightSamples& samples = residuals.samples();
  const std::vector<double> before = residuals.values(own_parameters(residuals, task, task.start).data());
  const std::vector<double> after = residuals.values(own_parameters(residuals, task, values).data());
  const NoiseFloor noise = noise_of_flight(samples, masked(after, residuals.mask(), Mask::none));
  Compared result;
  const auto add = [&](const std::vector<std::size_t>& part, bool held) {
    if (part.empty()) return;
    const std::vector<double> was = only_at(before, part);
    const std::vector<double> is = only_at(after, part);
    result.parts.push_back({samples.name, held, sums_of_flight(samples, was, noise).statistics(),
                            sums_of_flight(samples, is, noise).statistics()});
    result.parts.back().reference = task.reference.name();
    const Gain gain = gain_between(samples, was, is, noise, task.reference.window());
    result.parts.back().gain = gain.value;
    result.parts.back().gain_error = gain.error;
    const std::vector<double> means = means_of_blocks(samples, is);
    if (held) {
      result.held_out_blocks = means.size();
      result.held_out_derivatives = mean_derivatives(rows, task, part, values, wanted);
    } else {
      result.fitted_blocks = means;
    }
  };
  add(rows.used(), false);
  add(rows.held_out(), true);
  return result;
}

/// The flights that are held out.
std::vector<Compared> held_out(const FitTask& task, const Eigen::VectorXd& values,
                               const std::vector<std::size_t>& wanted) {
  const FlightSet& flights = task.options.holdout;
  return flights.share().of_each_flight<Compared>([&](std::size_t number) {
    const auto samples = flights.samples(number, task.model, task.reference, task.options.mask);
    constexpr double fitted = 0.0;  // fraction of the samples
    const LinearRows rows(residuals_at(samples, task, values), task.model, task.reference,
                          {Inputs::none, {}, fitted});
    return compared(rows, task, values, wanted);
  });
}

/// Flights in the fit with the corrections of `more`, and held-out flights.
template <class More>
std::vector<Compared> compared(FitFlights& flights, const Eigen::VectorXd& values, const More& more) {
  const FitTask& task = flights.task();
  const std::vector<std::size_t>& wanted = flights.setup().wanted;
  std::vector<Compared> each = flights.of_each(
      [&](std::size_t, FitFlight& fit) {
        Compared one = compared(fit.linear_rows(), task, values, wanted);
        more(fit.residuals(), one);
        return one;
      },
      values);
  for (Compared& one : held_out(task, values, wanted)) each.push_back(std::move(one));
  return each;
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

BeforeAndAfter before_and_after(FitFlights& flights, const Eigen::VectorXd& values,
                                const Eigen::MatrixXd& covariance, double left) {
  const std::vector<Compared> each =
      compared(flights, values, [&](const Residuals& residuals, Compared& one) {
        const FlightSamples& samples = residuals.samples();
        one.flaps_out = flaps_out(residuals, values.data());
        for (const std::string& note : samples.notes) one.notes.emplace_back(samples.name, note);
        for (const Interval& interval : samples.intervals)
          one.flown.set(static_cast<std::size_t>(interval.regime));
      });
  FittedMeans fitted;
  ResidualSums with_flaps;
  for (const Compared& one : each) {
    fitted.add(one.fitted_blocks);
    with_flaps.add(one.flaps_out);
  }
  BeforeAndAfter all;
  all.flaps_out = with_flaps.statistics();
  for (const Compared& one : each) {
    for (FlightFit part : one.parts) {
      if (part.holdout) {
        const double by_wander = fitted.expected_bias(one.held_out_blocks);
        const double by_coefficients =
            one.held_out_derivatives.dot(covariance * one.held_out_derivatives);  // hPa^2
        part.expected_bias = std::sqrt(by_wander * by_wander + by_coefficients + left * left);
      }
      all.flights.push_back(std::move(part));
    }
  }
  std::vector<FlightNote> notes;
  for (const Compared& one : each) {
    notes.insert(notes.end(), one.notes.begin(), one.notes.end());
    all.flown |= one.flown;
  }
  for (std::string& note : notes_of_flights(notes)) all.notes.push_back(std::move(note));
  for (const std::unique_ptr<FitFlights>& with : flights.further()) {
    for (const Compared& one : compared(*with, values, [](const Residuals&, Compared&) {}))
      all.further.insert(all.further.end(), one.parts.begin(), one.parts.end());
  }
  return all;
}

}  // namespace internal
}  // namespace pcor

#include "fit/before_and_after.hpp"

#include <algorithm>
#include <cmath>

#include "base/phrasing.hpp"
#include "fit/loss_function.hpp"
#include "residuals/flight_statistics.hpp"
#include "residuals/serialization.hpp"

namespace pcor {

template <class Archive>
void serialize(Archive& archive, FlightFit& flight) {
  archive(flight.flight, flight.holdout, flight.before, flight.after, flight.expected_bias, flight.reference);
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
  FitSums sums{};
  OutlierRun longest_run{};
  std::vector<FlightFit> parts{};  ///< the part that was fitted, and the part that was held out
  std::vector<double> fitted_blocks{};
  std::size_t held_out_blocks = 0;
  Eigen::VectorXd held_out_derivatives{};  ///< mean over held-out samples, by the fitted parameters
  ResidualSums flaps_out{};
  std::vector<FlightNote> notes{};
  RegimeSet flown{};

  template <class Archive>
  void serialize(Archive& archive) {
    archive(sums, longest_run, parts, fitted_blocks, held_out_blocks, held_out_derivatives, flaps_out, notes,
            flown);
  }
};

OutlierRun longest_run_of(const LinearRows& rows, const std::vector<double>& residual,
                          const NoiseFloor& noise) {
  const FlightSamples& samples = rows.samples();
  OutlierRun longest{samples.name};
  OutlierRun now;
  for (const std::size_t i : rows.used()) {
    const bool is_continuous =
        now.samples > 0 && residual[i] * now.mean > 0.0 && samples.time[i] - now.end < 1.5 * samples.step;
    if (!(std::abs(residual[i]) > tukey_width * noise.local_rms[i])) {
      now = {};
      continue;
    }
    if (!is_continuous) now = {samples.name, 0, samples.time[i]};
    now.end = samples.time[i];
    now.mean += (residual[i] - now.mean) / static_cast<double>(++now.samples);
    if (now.duration() > longest.duration()) longest = now;
  }
  return longest;
}

/// @param is_of_fit a flight of the fit with the first reference
Compared compared(const LinearRows& rows, const FitTask& task, const Eigen::VectorXd& values,
                  const std::vector<std::size_t>& requested, bool is_of_fit) {
  const Residuals& residuals = rows.residuals();
  const FlightSamples& samples = residuals.samples();
  const Eigen::VectorXd coefficients = flight_parameters(residuals, task, values);
  const std::vector<double> before = residuals.values(flight_parameters(residuals, task, task.start).data());
  const std::vector<double> after = residuals.values(coefficients.data());
  const NoiseFloor noise = noise_of_flight(samples, masked(after, residuals.mask(), Mask::none));
  Compared result;
  FitSums& sums = result.sums;
  const auto add = [&](const std::vector<std::size_t>& part, bool held) {
    if (part.empty()) return;
    const std::vector<double> was = select_samples(before, part);
    const std::vector<double> is = select_samples(after, part);
    const ResidualSums of_before = sums_of_flight(samples, was, noise);
    const ResidualSums of_after = sums_of_flight(samples, is, noise);
    result.parts.push_back({samples.name, held, of_before.statistics(), of_after.statistics()});
    result.parts.back().reference = task.reference.name();
    const std::vector<double> means = means_of_blocks(samples, is);
    if (held) {
      result.held_out_blocks = means.size();
      const Eigen::MatrixXd derivatives = sample_rows(rows, task, part, values, requested, true);
      result.held_out_derivatives =
          derivatives.leftCols(as_index(requested.size())).colwise().mean().transpose();
      return;
    }
    result.fitted_blocks = means;
    const auto bulk_squares = [&part](const std::vector<double>& residual) {
      const double deviation = robust_standard_deviation(residual);
      return deviation * deviation * static_cast<double>(part.size());
    };
    sums.before = of_before;
    sums.after = of_after;
    sums.bulk_squares_before = bulk_squares(was);
    sums.bulk_squares = bulk_squares(is);
  };
  add(rows.used(), false);
  add(rows.held_out(), true);
  if (!is_of_fit) return result;
  // Delta-p of the reference from its unchanged file, so that R2 does not grow with a fitted reference.
  const std::vector<double> reference_defect = residuals.target_defect(task.start.data());
  const std::vector<double>& static_pressure = *samples.model.find(Quantity::static_pressure);
  for (const std::size_t i : rows.used()) {
    const double relative = after[i] / static_pressure[i];
    sums.relative_squares += relative * relative;
    sums.reference_defect += reference_defect[i];
    sums.reference_defect_squares += reference_defect[i] * reference_defect[i];
  }
  result.longest_run = longest_run_of(rows, after, noise);
  result.flaps_out = flaps_out(residuals, coefficients.data());
  for (const Note& note : samples.notes) result.notes.emplace_back(samples.name, note);
  for (const Interval& interval : samples.intervals)
    result.flown.set(static_cast<std::size_t>(interval.regime));
  return result;
}

/// Flights in the fit, and held-out flights.
std::vector<Compared> compared(FitFlights& flights, const Eigen::VectorXd& values, bool is_first_reference) {
  const FitTask& task = flights.task();
  const std::vector<std::size_t>& requested = flights.setup().requested;
  std::vector<Compared> each = flights.of_each(
      [&](std::size_t, const FitFlight& fit) {
        return compared(fit.linear_rows(), task, values, requested, is_first_reference);
      },
      values);
  const FlightSet& holdout = task.options.holdout;
  const auto held_out = holdout.partition().all_gather_flights<Compared>([&](std::size_t number) {
    const auto samples = holdout.samples(number, task.model, task.reference, task.options.mask);
    constexpr double fitted = 0.0;  // fraction of the samples
    std::vector<Mask> mask;
    const LinearRows rows(residuals_at(samples, task, values, mask), task.model, task.reference,
                          {Inputs::none, {}, fitted});
    return compared(rows, task, values, requested, false);
  });
  each.insert(each.end(), held_out.begin(), held_out.end());
  return each;
}

}  // namespace

void FitSums::add(const FitSums& other) {
  before.add(other.before);
  after.add(other.after);
  bulk_squares_before += other.bulk_squares_before;
  bulk_squares += other.bulk_squares;
  relative_squares += other.relative_squares;
  reference_defect += other.reference_defect;
  reference_defect_squares += other.reference_defect_squares;
}

BeforeAndAfter before_and_after(FitFlights& flights, const Eigen::VectorXd& values,
                                const Eigen::MatrixXd& covariance, double misfit_rms, RefitResult& result) {
  const std::vector<Compared> each = compared(flights, values, true);
  BeforeAndAfter all;
  FittedMeans fitted;
  ResidualSums with_flaps;
  std::vector<FlightNote> notes;
  for (const Compared& one : each) {
    fitted.add(one.fitted_blocks);
    with_flaps.add(one.flaps_out);
    all.sums.add(one.sums);
    if (one.longest_run.duration() > all.longest_run.duration()) all.longest_run = one.longest_run;
    notes.insert(notes.end(), one.notes.begin(), one.notes.end());
    all.flown |= one.flown;
  }
  all.notes = notes_of_flights(notes, each.size());
  result.flaps_out = with_flaps.statistics();
  for (const Compared& one : each) {
    for (FlightFit part : one.parts) {
      if (part.holdout) {
        // The noise of the part itself determines a part that is shorter than half of a block.
        const double by_wander = std::max(fitted.expected_bias(one.held_out_blocks), part.after.bias_error);
        const double by_coefficients =
            one.held_out_derivatives.dot(covariance * one.held_out_derivatives);  // hPa^2
        part.expected_bias = std::sqrt(by_wander * by_wander + by_coefficients + misfit_rms * misfit_rms);
      }
      result.flights.push_back(std::move(part));
    }
  }
  for (const std::unique_ptr<FitFlights>& with : flights.further()) {
    for (const Compared& one : compared(*with, values, false))
      result.further.insert(result.further.end(), one.parts.begin(), one.parts.end());
  }
  return all;
}

}  // namespace internal
}  // namespace pcor

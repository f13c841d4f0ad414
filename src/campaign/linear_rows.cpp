#include "campaign/linear_rows.hpp"

#include <algorithm>
#include <utility>

#include "numerics/triangular_factor.hpp"
#include "residuals/masks.hpp"
#include "residuals/predicted_pressures.hpp"

namespace pcor::internal {
namespace {

/// Excludes the samples that depend on excluded neighbours.
void mask_by_neighbours(std::vector<Mask>& masks, std::size_t half_width) {
  const std::vector<Mask> initial = masks;
  for (std::size_t i = 0; i < initial.size(); ++i) {
    // If only the residual is missing, its inputs are present.
    if (initial[i] == Mask::none || initial[i] == Mask::reference) continue;
    for (std::size_t k = i - std::min(i, half_width); k < std::min(i + half_width + 1, initial.size()); ++k) {
      if (masks[k] == Mask::none) masks[k] = Mask::reference;
    }
  }
}

/// Parameters after the residual's parameters, of a system on which it does not depend, are not counted as
/// linear.
bool are_linear(const std::vector<std::size_t>& parameters, const std::vector<bool>& linear) {
  return std::all_of(parameters.begin(), parameters.end(),
                     [&](std::size_t parameter) { return parameter < linear.size() && linear[parameter]; });
}

}  // namespace

bool keeps_derivatives(const Reference& reference) {
  return reference.model() != nullptr || !reference.is_static_pressure();
}

Binning bins_of(const FlightSamples& samples, double window, const std::vector<double>& series) {
  return {series, samples.time, samples.step, std::max(window, Binning::usual_width)};
}

LinearRows::LinearRows(Residuals residuals, const ModelDefinition& model, const Reference& reference,
                       const RowsSetup& setup)
    : residuals_(std::move(residuals)),
      window_(reference.window()),
      linear_(keeps_derivatives(reference) || are_linear(setup.free, residuals_.is_linear())),
      at_sensor_(setup.inputs == Inputs::noise_free || !linear_),
      mask_(residuals_.mask()) {
  choose_inputs(model, reference, setup.inputs);
  if (setup.inputs == Inputs::noise_free && residuals_.half_width() > 0)
    mask_by_neighbours(mask_, residuals_.half_width());
  used_ = used_samples(mask_, setup.first_part);
  held_out_ = used_samples(mask_);
  held_out_.erase(held_out_.begin(), held_out_.begin() + static_cast<std::ptrdiff_t>(used_.size()));
  if (!setup.regimes.empty()) keep_regimes(setup.regimes);
}

/// A column must not hold noise that its own row holds. A diagnosis takes pressures and the speed of the
/// laser from predictions; rates of change and temperatures are recorded values, and so is all that a
/// residual over neighbouring samples reads. A fit takes the pressures of two systems from their mean.
void LinearRows::choose_inputs(const ModelDefinition& model, const Reference& reference, Inputs inputs) {
  if (inputs == Inputs::none) return;
  std::shared_ptr<const FlightSamples> elsewhere = residuals_.at_common_pressures();
  if (inputs == Inputs::noise_free && residuals_.half_width() == 0) {
    auto predicted = std::make_shared<FlightSamples>(
        with_predicted_pressures(elsewhere ? *elsewhere : samples(), samples()));
    const Residuals of_predicted(predicted, model, reference, residuals_.mask());
    if (auto sensor = of_predicted.predicted_sensor(residuals_.parameters().data()))
      *predicted->model.find(sensor->first) = std::move(sensor->second);
    elsewhere = std::move(predicted);
  }
  if (elsewhere) derived_.emplace(std::move(elsewhere), model, reference, residuals_.mask());
}

/// Keeps the used samples in the requested regimes. The first interval that contains a sample counts.
void LinearRows::keep_regimes(const std::vector<Regime>& regimes) {
  const std::vector<double>& time = samples().time;
  constexpr auto outside = static_cast<std::size_t>(-1);
  intervals_.assign(time.size(), outside);
  for (const Interval& interval : samples().intervals) {
    if (std::find(regimes.begin(), regimes.end(), interval.regime) == regimes.end()) continue;
    bool any = false;
    for (const std::size_t i : used_) {
      if (intervals_[i] != outside || time[i] < interval.begin || time[i] >= interval.end) continue;
      intervals_[i] = interval_count_;
      any = true;
    }
    if (any) ++interval_count_;
  }
  used_.erase(
      std::remove_if(used_.begin(), used_.end(), [&](std::size_t i) { return intervals_[i] == outside; }),
      used_.end());
}

Eigen::MatrixXd LinearRows::evaluate(const std::vector<std::size_t>& samples, const double* parameters,
                                     const std::vector<std::size_t>& requested, bool as_recorded) const {
  Eigen::MatrixXd result(as_index(samples.size()), as_index(requested.size()) + 1);
  const auto put = [&](const Residuals& residuals, const std::vector<std::size_t>& derivatives) {
    const auto evaluate = at_sensor_ ? &Residuals::evaluate_at_sensor : &Residuals::evaluate;
    (residuals.*evaluate)(samples, parameters, derivatives, result.rightCols(1).data(), result.data());
  };
  const bool elsewhere = derived_ && !as_recorded && !requested.empty();
  put(elsewhere ? *derived_ : residuals_, requested);
  if (elsewhere) put(residuals_, {});  // residual only
  return result;
}

Eigen::MatrixXd LinearRows::bin_means(const Binning& bins, const Eigen::MatrixXd& rows) const {
  Eigen::MatrixXd sums = Eigen::MatrixXd::Zero(as_index(bins.size()), rows.cols());
  std::size_t i = 0;
  for (std::size_t k = 0; k < bins.records().size(); ++k) {
    while (used_[i] != bins.records()[k]) ++i;
    sums.row(bins.bins()[k]) += rows.row(as_index(i));
  }
  return bins.counts().cwiseInverse().asDiagonal() * sums;
}

}  // namespace pcor::internal

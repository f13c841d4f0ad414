#include "improve/surface_offer.hpp"

#include <algorithm>
#include <array>
#include <utility>
#include <vector>

#include <pcor/base/error.hpp>
#include <pcor/effects/static_surface.hpp>
#include <pcor/roles/add_effects.hpp>
#include "diagnose/rms.hpp"
#include "fit/fitted_model.hpp"
#include "numerics/missing.hpp"

namespace pcor::internal {
namespace {

constexpr std::size_t held_out_blocks = 5;

/// A model without and with a surface.
using Pair = std::array<TrialModel, 2>;

/// Number `block` of the samples of a flight, from its begin to its end; s since 1970 UTC.
Exclusion block_of(const TrialFlight& flight, std::size_t block) {
  const std::vector<double>& time = flight.samples->time;
  const std::vector<std::size_t>& used = flight.fitted;
  const auto at = [&](std::size_t number) { return used.size() * number / held_out_blocks; };
  const double begin = time[used[at(block)]];
  const double end = at(block + 1) < used.size() ? time[used[at(block + 1)]] : time[used.back()] + 1.0;
  const double half = 0.5 * flight.samples->step;
  return {begin - half, end - half, "held out"};
}

/// The residuals without and with the surface on five blocks, each with coefficients of the other four.
/// @param outline the samples of all blocks
/// @param surfaces the priors in a fit to all blocks, where the search for those of each block starts
TrialComparison out_of_blocks(const FlightSet& flights, const Pair& models, const References& references,
                              const RefitOptions& options, const std::vector<TrialFlight>& outline,
                              std::vector<SurfaceRoughness> surfaces) {
  std::vector<TrialModel> trials;
  std::array<std::vector<SurfaceRoughness>, 2> priors{{{}, std::move(surfaces)}};
  for (std::size_t block = 0; block < held_out_blocks; ++block) {
    RefitOptions without_block = options;
    without_block.shared_effects = models[0].shared_effects;
    for (const TrialFlight& flight : outline) {
      if (flight.first_reference && flight.fitted.size() >= held_out_blocks)
        without_block.mask.excluded_times.push_back(block_of(flight, block));
    }
    for (std::size_t k = 0; k < models.size(); ++k) {
      trials.push_back({fitted_coefficients(flights, models[k].file, references, without_block, priors[k]),
                        models[k].shared_effects});
    }
  }
  std::vector<TrialFlight> tried = try_models(flights, trials, references, options);
  const std::size_t per_reference = tried.size() / references.size();
  for (std::size_t f = 0; f < tried.size(); ++f) {
    TrialFlight& flight = tried[f];
    const TrialFlight& first = tried[f % per_reference];
    std::vector<std::vector<double>> out(2, std::vector<double>(flight.samples->time.size(), nan));
    for (std::size_t block = 0; block < held_out_blocks && first.fitted.size() >= held_out_blocks; ++block) {
      const Exclusion span = block_of(first, block);
      for (const std::size_t i : flight.fitted) {
        const double time = flight.samples->time[i];
        if (time < span.begin || time >= span.end) continue;
        for (std::size_t k = 0; k < out.size(); ++k) out[k][i] = flight.residuals[2 * block + k][i];
      }
    }
    flight.residuals = std::move(out);
  }
  return comparison_of(tried, 0, 1, false);
}

}  // namespace

std::optional<SurfaceOffer> offer_surface(const FlightSet& flights, const TrialModel& model,
                                          const References& references, const RefitOptions& options) {
  const std::string id(surface_info.front().id);
  const bool is_in_memory = flights.path(0).empty();
  if (is_in_memory || has_effect(model.file, id)) return std::nullopt;
  Pair models{model, model};
  try {
    const auto flight = [&flights](std::size_t number) -> const Flight& { return flights[number]; };
    models[1].file = add_effects(model.file, {surface_over(flights.size(), flight, model.file, id)},
                                 flights[0].variables());
  } catch (const Error& error) {
    if (error.code() == Error::Code::file) throw;
    return std::nullopt;
  }
  SurfaceOffer offer;
  offer.model = models[1];
  RefitOptions of_all = options;
  of_all.shared_effects = model.shared_effects;
  std::vector<SurfaceRoughness> surfaces;
  TrialModel fitted = models[1];
  fitted.file = fitted_coefficients(flights, models[1].file, references, of_all, surfaces);
  const std::vector<TrialFlight> tried = try_models(flights, {model, fitted}, references, options);
  offer.static_change = square_sum_of(static_changes_of(tried, 0, 1)).rms();
  offer.may_be_of_reference = !options.trust_reference &&
                              std::none_of(references.begin(), references.end(),
                                           [](const auto& reference) { return reference->reads_laser(); });
  if (!options.holdout.empty() || options.training_share < 1.0) {
    offer.compared_on = "held-out samples";
    offer.compared = comparison_of(tried, 0, 1, true);
    return offer;
  }
  offer.compared_on = "the fitted samples";
  offer.compared = comparison_of(tried, 0, 1, false);
  if (!(offer.compared.rms_after <= unnamed_limit * offer.compared.rms_before)) return offer;
  offer.compared_on = "five held-out blocks with outliers";
  offer.compared = out_of_blocks(flights, models, references, options, tried, std::move(surfaces));
  return offer;
}

}  // namespace pcor::internal

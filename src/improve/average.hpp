#pragma once

#include <vector>

#include <pcor/laws/model_file.hpp>

namespace pcor::internal {

/// One of the models that may be right, fitted, and the probability that it is.
struct WeighedModel {
  ModelFile model;
  double weight = 0.0;
};

/// The models one of which is right, their weights adding up to 1, and the share of their average that is
/// applied to a model without what they differ in.
struct Mixture {
  std::vector<WeighedModel> rivals{};
  ModelFile without{};
  double share = 1.0;
};

/// The model whose coefficients are the average over mixtures that are independent of each other. The rivals
/// of each are what `best` may be at one place, `best` among them.
///
/// Moments of the mixtures (Hoeting et al., Statistical Science 14, 382, 1999): the coefficients are
/// best + sum over mixtures of (delivered - best), with delivered = without + share (mean of the rivals -
/// without), where an effect that a model does not have has its neutral ones. Their covariance is the mean of
/// those of the rivals and, for each mixture, the mean square of rival - delivered: what is not applied is
/// part of it. Delta-p is linear in nearly all coefficients, so it is the average of those of the models, and
/// its stated uncertainty holds their spread. Effects that not all models have are held in later fits: only
/// their average has a meaning.
ModelFile averaged(const ModelFile& best, const std::vector<Mixture>& mixtures);

/// The largest share of the average, 0 to 1, that does not take the corrected static pressure further from
/// where any rival has it than doing nothing would, but for `tolerance`.
///
/// @param rivals by how much each changes the static pressure, hPa, of the same samples, NaN where missing
/// @param weights of the rivals, which add up to 1
/// @param tolerance rms, hPa
double harmless_share(const std::vector<std::vector<double>>& rivals, const std::vector<double>& weights,
                      double tolerance);

/// The rms over samples of how rivals differ from their average, hPa. Arguments as of `harmless_share`.
double spread_of(const std::vector<std::vector<double>>& rivals, const std::vector<double>& weights);

}  // namespace pcor::internal

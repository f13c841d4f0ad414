#pragma once

#include <vector>

#include <pcor/laws/model_file.hpp>

namespace pcor::internal {

/// One of the models that may be right, fitted, and the weight that it has; those of a mixture add up to 1.
struct WeighedModel {
  ModelFile model;
  double weight = 0.0;
};

using Mixture = std::vector<WeighedModel>;

/// The model whose coefficients are the average over mixtures that are independent of each other. Each of
/// them has what `best` may be at one place, `best` among them.
///
/// Moments of the mixtures (Hoeting et al., Statistical Science 14, 382, 1999): the coefficients are
/// best + sum over mixtures of (mean - best), where an effect that a model does not have has its neutral
/// ones; their covariance is the mean of those of the models and, for each mixture, the spread of its models
/// about their mean. Delta-p is linear in nearly all coefficients, so it is the average of those of the
/// models, and its stated uncertainty holds their spread. Effects that not all models have are held in later
/// fits: only their average has a meaning.
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

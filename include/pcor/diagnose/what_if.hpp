#pragma once

#include <pcor/diagnose/diagnose.hpp>
#include <pcor/report/report.hpp>

#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace pcor {

/// How many effects the reader of a report may try.
inline constexpr std::size_t max_what_if_effects = 12;

/// An effect that the reader of a report may add to the model.
struct WhatIfCandidate {
  std::string id;                       ///< as that of a finding
  std::string why;                      ///< it is in the list, e.g. "found", "instead of static-lag"
  std::optional<ModelEffect> effect{};  ///< with its shape; without, the shape is that of the catalogue
  bool is_alike = false;                ///< as `Finding::is_alike`
  std::string stands_for{};  ///< the effect that was found in whose place it stands, itself or another
};

struct WhatIfOptions {
  /// Masks, formulas and training share of the diagnosis. If its `series_of` is said,
  /// `WhatIf::flights` are those flights alone, and all that are held out; else all.
  DiagnoseOptions diagnose;
  FlightSet holdout{};    ///< flights that take no part in any fit
  bool is_robust = true;  ///< outliers count less, as by the loss of a refit
  /// The model's own coefficients at which the residual of the report was found; of the model without.
  std::vector<Estimate> own{};
};

/// What a what-if needs of a flight.
struct WhatIfFlight {
  std::shared_ptr<const FlightSamples> samples{};
  /// Of each coefficient of the panel, one value for each record.
  std::vector<std::vector<double>> columns{};
};

/// A what-if, its columns still by flights and records.
struct WhatIf {
  WhatIfPanel panel;
  std::vector<ModelEffect> effects{};  ///< of the panel, neutral, in their shapes
  std::vector<WhatIfFlight> flights{};
};

/// The effects of a diagnosis to try: what was found, with what it cannot be told from, the formulas of the
/// user, and what comes nearest to a finding; at most `max_what_if_effects`.
std::vector<WhatIfCandidate> what_if_candidates(const Diagnosis& diagnosis,
                                                const std::vector<ModelEffect>& formulas);

/// What a reader needs to add effects to a model under his hand: the derivatives of the residual by the
/// coefficients of model and effects, sums in units of the noise for fits that are those of `refit`, but for
/// effects in whose coefficients the residual is not linear, and what would tell the effects apart.
///
/// @throws Error as `diagnose`.
WhatIf what_if(const FlightSet& flights, const ModelDefinition& model, const References& references,
               const std::vector<WhatIfCandidate>& candidates, const WhatIfOptions& options);

}  // namespace pcor

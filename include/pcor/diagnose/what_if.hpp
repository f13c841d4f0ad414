#pragma once

#include <pcor/diagnose/diagnose.hpp>
#include <pcor/report/report.hpp>

#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace pcor {

/// Maximum number of effects in a what-if panel.
inline constexpr std::size_t max_what_if_effects = 12;

/// Effect that the reader of a report may add to the model.
struct WhatIfCandidate {
  std::string id;                       ///< id of a finding
  std::string why;                      ///< reason for its inclusion, e.g. "found", "instead of static-lag"
  std::optional<ModelEffect> effect{};  ///< effect with its shape; default: the shape of the catalogue
  bool is_shared = false;               ///< see `Finding::is_shared`
  std::string stands_for{};             ///< the finding that it represents or replaces
};

struct WhatIfOptions {
  /// Masks, formulas and training share of the diagnosis. If its `series_of` is given, `WhatIf::flights` are
  /// those flights and all held-out ones; otherwise all flights.
  DiagnoseOptions diagnose;
  FlightSet holdout{};    ///< flights not used in any fit
  bool is_robust = true;  ///< true: outliers are down-weighted, as by the loss of a refit
  /// Coefficients of the model at the residual of the report; default: unchanged.
  std::vector<CoefficientEstimate> refitted_coefficients{};
};

/// Data of a flight for the what-if panel.
struct WhatIfFlight {
  std::shared_ptr<const FlightSamples> samples{};
  /// Column of each coefficient of the panel, one value per record.
  std::vector<std::vector<double>> columns{};
};

/// What-if panel with its columns by flights and records.
struct WhatIf {
  WhatIfPanel panel;
  std::vector<ModelEffect> effects{};  ///< neutral effects of the panel, with their shapes
  std::vector<WhatIfFlight> flights{};
};

/// Effects of a diagnosis for the panel: findings, their alternatives, formulas of the user, and the closest
/// effects to a finding; at most `max_what_if_effects`.
std::vector<WhatIfCandidate> what_if_candidates(const Diagnosis& diagnosis,
                                                const std::vector<ModelEffect>& formulas);

/// Data for interactive addition of effects to a model: derivatives of the residual with respect to the
/// coefficients of model and effects, and whitened sums for fits equivalent to `refit` (except for effects
/// with a nonlinear residual).
///
/// @throws Error as `diagnose`.
WhatIf what_if(const FlightSet& flights, const ModelDefinition& model, const References& references,
               const std::vector<WhatIfCandidate>& candidates, const WhatIfOptions& options);

}  // namespace pcor

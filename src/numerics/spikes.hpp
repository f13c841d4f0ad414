#pragma once

#include <vector>

namespace pcor::internal {

/// Replaces outliers of a residual by predictions from earlier values. An outlier is a sample whose
/// innovation exceeds 4.5 robust standard deviations of its five minutes: a sudden departure, not a large
/// value that its neighbours share, so that an effect is not cut where it is strongest.
///
/// @param residual NaN where not used; @param predicted by model and effects, likewise; @param time s
/// @return the residual with its outliers replaced; `count` receives their number
std::vector<double> without_outliers(const std::vector<double>& residual,
                                     const std::vector<double>& predicted, const std::vector<double>& time,
                                     double step, std::size_t& count);

}  // namespace pcor::internal

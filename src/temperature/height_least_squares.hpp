#pragma once

#include <vector>

#include <pcor/temperature/temperature.hpp>
#include "temperature/height_record.hpp"

namespace pcor::internal {

/// Least squares on height (memo eq. 23 and 24): the coefficients with which the integral keeps closest to
/// the height by GPS, from the mean height of each stretch. Errors take every sample for independent, as the
/// memo does.
TemperatureFit fit_height_by_least_squares(const std::vector<HeightRecord>& records, std::size_t terms);

/// How many samples that follow each other tell as much as one that is independent, by the correlation of the
/// heights that least squares leaves: errors are too small by its square root.
double samples_as_one(const std::vector<HeightRecord>& records, const std::vector<double>& coefficients);

/// The height by GPS less the integral with a correction, about its mean in each stretch, m.
std::vector<double> height_differences(const HeightRecord& record, const std::vector<double>& coefficients);

}  // namespace pcor::internal

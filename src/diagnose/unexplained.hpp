#pragma once

#include <string>

#include <pcor/campaign/flight_set.hpp>
#include <pcor/diagnose/diagnose.hpp>
#include "diagnose/analysis.hpp"

namespace pcor::internal {

/// Tests whether structure remains in any variable of the files, and adds it to a diagnosis with its flights.
/// If a straight line in one variable is more likely than all findings, with a probability of 95 %, these are
/// withdrawn, and the structure is that of the base alone. A line with a probability above 5 % is the rival.
///
/// @param extended model with all roles that the flights record @param references in the order of the
/// analysis
/// @return chi2 of the best variable in addition to the findings
double add_unexplained(const Analysis& analysis, const FlightSet& files, const ModelDefinition& model,
                       const ModelDefinition& extended, const References& references,
                       const DiagnoseOptions& options, Diagnosis& diagnosis);

/// Name of an effect that describes a predictor.
std::string id_of_predictor(const std::string& variable);

/// Formula of a predictor as an effect with the estimated slope.
/// @param flights description of the flights in which it was found
ModelEffect effect_of(const EmpiricalPredictor& variable, const std::string& flights);

}  // namespace pcor::internal

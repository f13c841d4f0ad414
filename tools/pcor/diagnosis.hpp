#pragma once

#include <CLI/CLI.hpp>
#include <optional>
#include <string>
#include <vector>

#include <pcor/diagnose/what_if.hpp>

namespace pcor::tool {

/// Effect of the catalogue in the syntax of a command: its id and, after a colon, shape parameters that
/// differ from the default, with the powers of its scaling: "static-transonic:onset=0.8",
/// "static-beta-odd:static_pressure=-1,dynamic_pressure=1".
std::string argument_of(const ModelEffect& effect);

/// Effect named by such an argument, neutral except for its shape. @throws Error if there is no such effect.
ModelEffect shaped_effect(const std::string& argument);

/// The surface named by an argument such as "static-surface:splines=8", over the range of a flight; empty for
/// other effects. @param flight may be null @throws Error if the flight is missing or does not determine the
/// axes.
std::optional<ModelEffect> surface_argument(const std::string& argument, const Flight* flight,
                                            const ModelDefinition& model);

/// Options of every sub-command that searches for missing effects: candidates in addition to the catalogue.
struct CandidateOptions {
  std::vector<std::string> formulas{};
  std::string file{};
};

void add_candidate_options(CLI::App& command, CandidateOptions& options);

/// Names of the variables of all flights, each once.
std::vector<std::string> variables_of_any(const FlightSet& flights);

/// Formula effects given by the options, except effects of `model`: try-1, try-2 ... on the command line, and
/// effects in the file of candidates.
/// @throws Error if a formula cannot be read, with the position in it, or the file cannot be read or has no
/// formula; or if a formula of the command line names an unknown quantity or variable.
std::vector<ModelEffect> candidate_formulas(const CandidateOptions& options, const ModelDefinition& model,
                                            const FlightSet& flights);

/// Options as on a command line, each after a blank.
std::string command_line(const CandidateOptions& options);

/// User-defined effect at the static ports, with one coefficient k, which starts at 0.
/// @throws Error that names `option`, if the formula cannot be read or does not use k.
ModelEffect formula_effect(const std::string& id, const std::string& formula, const std::string& option);

/// Checks that every name in the formula of `option` is a quantity or one of `variables`, which belong to
/// `where`. @throws Error with suggestions.
void require_known_variables(const ModelEffect& effect, const std::string& option,
                             const std::vector<std::string>& variables, const std::string& where);

/// Adds to a what-if the commands that add its effects and refit, ready to be copied.
/// @param fit the flights and options of the refit, as on a command line
void add_commands(WhatIf& what_if, const std::string& model, const std::string& first_flight,
                  const std::string& fit);

/// Text "< 0.001", or the number.
std::string probability(double p);

/// Prints the unexplained residual, and correlated variables; prints no text if it is not significant.
void print_unexplained(const Unexplained& unexplained);

}  // namespace pcor::tool

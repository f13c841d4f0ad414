#pragma once

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include <pcor/diagnose/what_if.hpp>

namespace pcor::tool {

/// The options of every sub-command that looks for missing effects: what is tried beside the catalogue.
struct CandidateOptions {
  std::vector<std::string> formulas{};
  std::string file{};
};

void add_candidate_options(CLI::App& command, CandidateOptions& options);

/// The formula effects that the options name, without those that `model` has: try-1, try-2 ... for those of
/// the command line, and those of the file of candidates.
/// @throws Error if a formula cannot be read, with the place in it, or the file cannot be; or if a formula of
/// the command line names what is neither a quantity nor a variable of any of the flights.
std::vector<ModelEffect> candidate_formulas(const CandidateOptions& options, const ModelDefinition& model,
                                            const FlightSet& flights);

/// The options as they stand on a command line, each with a blank before it.
std::string command_line(const CandidateOptions& options);

/// An effect of the user's own at the static ports, with one coefficient k, which starts at 0.
/// @throws Error that names `option`, if the formula cannot be read or does not use k.
ModelEffect formula_effect(const std::string& id, const std::string& formula, const std::string& option);

/// Makes sure that whatever the formula of `option` names is a quantity or one of `variables`, which are
/// those of `place`. @throws Error that says what may have been meant.
void require_known_variables(const ModelEffect& effect, const std::string& option,
                             const std::vector<std::string>& variables, const std::string& place);

/// Puts into a what-if the commands that add its effects and refit, ready to be copied.
/// @param fit the flights and options of the refit, as they stand on a command line
void add_commands(WhatIf& what_if, const std::string& model, const std::string& first_flight,
                  const std::string& fit);

/// "< 0.001", or the number.
std::string probability(double p);

/// Prints what no effect explains, and the variables that go with it; nothing where there is nothing.
void print_unexplained(const Unexplained& unexplained);

nlohmann::ordered_json as_json(const ModelEffect& effect);
nlohmann::ordered_json as_json(const Unexplained& unexplained);
nlohmann::ordered_json as_json(const Diagnosis& diagnosis);

}  // namespace pcor::tool

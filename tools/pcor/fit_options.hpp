#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

#include <pcor/model_io/model_definition.hpp>

namespace pcor::tool {

/// Options of a fit that refit, diagnose and improve share.
struct FitOptions {
  std::vector<std::string> fix;   ///< coefficients or effects that are fixed in addition to the model file
  std::vector<std::string> free;  ///< coefficients that the model file fixes
  std::vector<std::string> holdout;
  std::string loss = "huber";
  double training_share = 1.0;
  bool trust_reference = false;
};

/// Adds `--fix` and `--free`.
void add_fit_options(CLI::App& command, FitOptions& options);

/// Adds the other options. @param tested object of the held-out samples, for the help: "the fit"
void add_training_options(CLI::App& command, FitOptions& options, const std::string& tested);

/// Model with its coefficients fixed and freed by the options. @throws Error if a name is unknown.
ModelDefinition with_fit_options(ModelDefinition model, const FitOptions& options);

/// Options as on a command line, each after a blank.
std::string command_line(const FitOptions& options);

}  // namespace pcor::tool

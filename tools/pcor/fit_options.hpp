#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

#include <pcor/model_io/model_definition.hpp>

namespace pcor::tool {

/// Coefficients that refit, diagnose and improve fix or free in addition to the model file.
struct FitOptions {
  std::vector<std::string> fix;
  std::vector<std::string> free;
};

void add_fit_options(CLI::App& command, FitOptions& options);

/// Model with its coefficients fixed and freed by the options. @throws Error if a name is unknown.
ModelDefinition with_fit_options(ModelDefinition model, const FitOptions& options);

/// Options as on a command line, each after a blank.
std::string command_line(const FitOptions& options);

}  // namespace pcor::tool

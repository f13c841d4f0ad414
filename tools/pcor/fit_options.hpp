#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

#include <pcor/model_io/model_definition.hpp>

namespace pcor::tool {

/// Which coefficients refit, diagnose and improve leave as they are, and which they fit all the same.
struct FitOptions {
  std::vector<std::string> fix;
  std::vector<std::string> free;
};

void add_fit_options(CLI::App& command, FitOptions& options);

/// The model with its coefficients held and freed as the options say. @throws Error if it has none of a name.
ModelDefinition with_fit_options(ModelDefinition model, const FitOptions& options);

/// The options as they stand on a command line, each with a blank before it.
std::string command_line(const FitOptions& options);

}  // namespace pcor::tool

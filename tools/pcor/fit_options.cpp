#include "fit_options.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <pcor/base/error.hpp>
#include <pcor/base/suggest.hpp>
#include "command.hpp"

namespace pcor::tool {
namespace {

/// Fixes or frees a coefficient, or all coefficients of an effect.
void set_fixed(ModelDefinition& model, const std::string& name, bool fixed, const char* option) {
  bool found = false;
  std::vector<std::string> known;
  model.fits.resize(model.model.effects.size());
  for (std::size_t e = 0; e < model.model.effects.size(); ++e) {
    const ModelEffect& effect = model.model.effects[e];
    const std::vector<std::string> names = parameter_names(effect);
    model.fits[e].resize(names.size());
    for (std::size_t p = 0; p < names.size(); ++p) {
      known.push_back(effect.id + "." + names[p]);
      if (name != known.back() && name != effect.id) continue;
      model.fits[e][p].fixed = fixed;
      found = true;
    }
  }
  if (found) return;
  const std::string meant = did_you_mean(name, known);
  throw Error(Error::Code::usage,
              fmt::format("{} {}: the model has no such parameter or effect; {}", option, name,
                          meant.empty() ? fmt::format("it has {}", fmt::join(known, ", ")) : meant));
}

}  // namespace

void add_fit_options(CLI::App& command, FitOptions& options) {
  add_list_option(command, "--fix", options.fix,
                  "fix a coefficient, or all of an effect, at its value, e.g. static-qp.a2")
      ->type_name("NAME");
  add_list_option(command, "--free", options.free, "fit a coefficient that the model file fixes")
      ->type_name("NAME");
}

void add_training_options(CLI::App& command, FitOptions& options, const std::string& tested) {
  command
      .add_option("--loss", options.loss,
                  "loss function, which limits the weight of outliers; none: least squares")
      ->check(CLI::IsMember({"huber", "none"}))
      ->capture_default_str();
  add_list_option(command, "--holdout", options.holdout, "a flight that is not fitted, but tests " + tested)
      ->type_name("T.nc");
  command
      .add_option("--training-share", options.training_share,
                  "fit only this fraction of every flight, its first part; the rest tests " + tested)
      ->check(CLI::Range(0.01, 1.0))
      ->capture_default_str();
  command.add_flag("--trust-reference", options.trust_reference,
                   "assume exact calibrations of the reference and the thermometer: standard errors exclude "
                   "their uncertainty ([uncertainty] of the model or default sizes); improve then tests no "
                   "effects of the reference");
}

ModelDefinition with_fit_options(ModelDefinition model, const FitOptions& options) {
  for (const std::string& name : options.free) set_fixed(model, name, false, "--free");
  for (const std::string& name : options.fix) set_fixed(model, name, true, "--fix");
  return model;
}

std::string command_line(const FitOptions& options) {
  std::string line;
  for (const std::string& flight : options.holdout) line += " --holdout " + shell_path(flight);
  if (options.training_share < 1.0) line += fmt::format(" --training-share {}", options.training_share);
  if (options.loss != FitOptions().loss) line += " --loss " + options.loss;
  if (options.trust_reference) line += " --trust-reference";
  for (const std::string& name : options.fix) line += " --fix " + shell_quote(name);
  for (const std::string& name : options.free) line += " --free " + shell_quote(name);
  return line;
}

}  // namespace pcor::tool

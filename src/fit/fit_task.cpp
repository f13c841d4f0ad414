#include "fit/fit_task.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include <pcor/base/error.hpp>
#include <pcor/base/suggest.hpp>
#include <pcor/effects/catalogue.hpp>
#include "campaign/model_parameters.hpp"
#include "campaign/reference_id.hpp"
#include "model_io/model_names.hpp"
#include "model_io/parameter_unit.hpp"
#include "numerics/triangular_factor.hpp"

namespace pcor::internal {
namespace {

/// Adds the parameters of a model, and its surfaces.
void add_parameters(FitTask& task, const ModelDefinition& file, const std::string& prefix, bool fitted) {
  for (const auto& [name, e, p] : named_parameters(file.model)) {
    const ModelEffect& effect = file.model.effects[e];
    if (effect.is_surface() && p == 0) {
      task.surfaces.push_back({prefix + effect.id, task.parameters.size(), effect.parameters.size(),
                               second_differences(*effect.surface)});
    }
    FitParameter& parameter = task.parameters.emplace_back();
    parameter.effect = prefix + effect.id;
    parameter.name = prefix + name;
    parameter.start = effect.parameters[p];
    parameter.bounds = file.bounds(e, p);
    parameter.fixed = !fitted || file.fit(e, p).fixed;
    parameter.unit = parameter_unit(effect, p);
    if (effect.is_formula()) continue;
    const EffectInfo& info = *effect_named(effect.id);
    parameter.neutral = info.parameters[p].neutral;
    parameter.typical = std::abs(info.parameters[p].typical);
    parameter.manoeuvre = info.manoeuvre;
    if (info.memory.of == Quantity::count || info.memory.parameter != p) continue;
    const auto& tried = info.parameters[p].tried;
    parameter.tried.assign(tried.begin(), std::find(tried.begin(), tried.end(), 0.0));
    parameter.tried.push_back(parameter.neutral);
  }
}

/// Indices of the named parameter, or of all parameters of the named effect.
std::vector<std::size_t> indices_of(const std::vector<FitParameter>& parameters, const std::string& name,
                                    const char* option) {
  std::vector<std::size_t> found;
  std::vector<std::string> known;
  for (std::size_t p = 0; p < parameters.size(); ++p) {
    if (parameters[p].name == name || parameters[p].effect == name) found.push_back(p);
    known.push_back(parameters[p].name);
  }
  if (!found.empty()) return found;
  const std::string meant = did_you_mean(name, known);
  throw Error(Error::Code::usage,
              fmt::format("{} {}: the model has no such parameter or effect; {}", option, name,
                          meant.empty() ? fmt::format("it has {}", fmt::join(known, ", ")) : meant));
}

void find_parameters(FitTask& task) {
  std::vector<FitParameter>& parameters = task.parameters;
  const ModelDefinition* const system = task.reference.model();
  add_parameters(task, task.model, "", true);
  if (system != nullptr)
    add_parameters(task, *system, id_on_other_system("", ""), task.options.fit_reference);
  for (const std::string& name : task.options.free) {
    for (const std::size_t p : indices_of(parameters, name, "--free")) parameters[p].fixed = false;
  }
  for (const std::string& name : task.options.fix) {
    for (const std::size_t p : indices_of(parameters, name, "--fix")) parameters[p].fixed = true;
  }
  task.start = task.lower = task.upper = Eigen::VectorXd(as_index(parameters.size()));
  for (std::size_t p = 0; p < parameters.size(); ++p) {
    const auto& [lower, upper] = parameters[p].bounds;
    if (!(lower < upper)) {
      throw Error(Error::Code::usage,
                  fmt::format("{}: its bounds [{}, {}] are empty; give the smaller one first",
                              parameters[p].name, lower, upper));
    }
    task.start[as_index(p)] = parameters[p].start;
    task.lower[as_index(p)] = lower;
    task.upper[as_index(p)] = upper;
  }
}

/// Covariance of all parameters from the standard errors and covariances in the files.
Eigen::MatrixXd stated_covariance_of(const FitTask& task) {
  const Eigen::Index size = task.start.size();
  const Eigen::MatrixXd of_model = stated_covariance(task.model);
  Eigen::MatrixXd all = Eigen::MatrixXd::Zero(size, size);
  all.topLeftCorner(of_model.rows(), of_model.cols()) = of_model;
  if (task.reference.model() != nullptr) {
    const Eigen::Index rest = size - of_model.rows();
    all.bottomRightCorner(rest, rest) = stated_covariance(*task.reference.model());
  }
  return all;
}

constexpr std::size_t passes_expected = 40;

}  // namespace

std::vector<std::vector<std::size_t>> fit_stages(const FitTask& task) {
  const std::vector<FitParameter>& parameters = task.parameters;
  std::vector<bool> remaining;
  for (const FitParameter& parameter : parameters) remaining.push_back(!parameter.fixed);
  if (std::find(remaining.begin(), remaining.end(), true) == remaining.end()) {
    throw Error(
        Error::Code::usage,
        fmt::format("model '{}': no coefficient is free; add an effect, or free one with --free EFFECT",
                    task.model.model.name));
  }
  std::vector<std::vector<std::size_t>> result;
  for (const FitStage& stage : task.options.stages) {
    std::vector<std::size_t>& requested = result.emplace_back();
    for (const std::string& name : stage.parameters) {
      for (const std::size_t p : indices_of(parameters, name, "--stage")) {
        if (!remaining[p])
          throw Error(Error::Code::usage,
                      fmt::format("--stage: {} is fixed, or fitted in a stage before", parameters[p].name));
        remaining[p] = false;
        requested.push_back(p);
      }
    }
  }
  std::vector<std::size_t>& rest = result.emplace_back();
  for (std::size_t p = 0; p < remaining.size(); ++p) {
    if (remaining[p]) rest.push_back(p);
  }
  return result;
}

FitTask fit_task(const ModelDefinition& model, const References& references, const RefitOptions& options,
                 const FlightSet& flights) {
  const Reference& reference = first_of(references);
  FitTask task{model, reference, options, flights};
  find_parameters(task);
  task.stated_covariance = stated_covariance_of(task);
  task.report_progress = [&progress = options.progress, passes = std::size_t{0}]() mutable {
    ++passes;
    if (progress) progress(std::min(passes, passes_expected - 1), passes_expected);
  };
  for (std::size_t i = 1; i < references.size(); ++i) {
    FitTask with{model,      *references[i],         options, flights, task.parameters,
                 task.start, task.stated_covariance, [] {}};
    const ModelDefinition* const first = reference.model();
    const ModelDefinition* const other = references[i]->model();
    with.shares_system = first != nullptr && other != nullptr && first->model.name == other->model.name &&
                         first->variables == other->variables;
    task.further.push_back(std::move(with));
  }
  return task;
}

}  // namespace pcor::internal

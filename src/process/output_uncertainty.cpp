#include "process/output_uncertainty.hpp"

#include <fmt/format.h>

#include <algorithm>

#include <pcor/base/error.hpp>
#include "base/phrasing.hpp"
#include "base/quoting.hpp"
#include "model_io/sensor_uncertainty.hpp"

namespace pcor::internal {
namespace {

ModelUncertainty requested(const ModelDefinition& model, UncertaintyPart part) {
  if (part == UncertaintyPart::none) return {};
  ModelUncertainty stated = uncertainty_of(model);
  if (part == UncertaintyPart::systematic) {
    stated = stated_uncertainty(model).has_systematic() ? stated.systematic_part() : ModelUncertainty{};
  }
  if (part == UncertaintyPart::random) stated = stated.random_part();
  if (stated.has_systematic() || stated.has_random()) return stated;
  if (part == UncertaintyPart::total_if_stated) return {};
  const char* const what = part == UncertaintyPart::systematic
                               ? "no standard error or covariance of a parameter"
                           : part == UncertaintyPart::random ? "no uncertainty of a sample in [uncertainty]"
                                                             : "no noise, misfit, stderr or covariance";
  throw Error(
      Error::Code::model,
      fmt::format("model '{}': it states {} (the calibration of a sensor alone does not suffice); run 'pcor "
                  "refit' for the covariance, set the noise of the sensors in [uncertainty], or omit "
                  "--uncertainty",
                  model.model.name, what));
}

}  // namespace

OutputUncertainty::OutputUncertainty(const ModelDefinition& model, std::shared_ptr<const Chain> chain,
                                     const ProcessOptions& options)
    : chain_(std::move(chain)),
      part_(options.uncertainty),
      correct_with_(options.correct_with),
      stated_(requested(model, part_)) {}

bool OutputUncertainty::states(std::initializer_list<EffectLocation> locations,
                               std::initializer_list<Quantity> roles) const {
  std::size_t count = chain_->parameters().size();
  for (const ModelEffect& each : stated_.calibration) count += each.parameters.size();
  for (std::size_t effect = 0; !stated_.covariance.empty() && effect < chain_->effect_count(); ++effect) {
    if (std::find(locations.begin(), locations.end(), chain_->location_of(effect)) == locations.end())
      continue;
    const std::size_t first = chain_->first_parameter_of(effect);
    for (std::size_t i = first; i < first + chain_->parameter_count_of(effect); ++i) {
      if (stated_.covariance[i * count + i] > 0.0) return true;
    }
  }
  return std::any_of(roles.begin(), roles.end(),
                     [this](Quantity role) { return stated_.random[index(role)] > 0.0; });
}

bool OutputUncertainty::states_defect_error() const {
  return part_ == UncertaintyPart::random || stated_.static_defect > 0.0 ||
         stated_.static_defect_ratio > 0.0 || states({EffectLocation::static_defect}, {});
}

void OutputUncertainty::note_unstated(const ModelDefinition& model, Notes& notes) const {
  if (!stated_.has_systematic() && !stated_.has_random()) return;
  if (correct_with_ == CorrectWith::lams) {
    notes.emplace_back(
        "LAMS-corrected samples have an uncertainty of PCOR only: the model covariance does not apply");
  }
  using Q = Quantity;
  if (!states_defect_error())
    notes.emplace_back(
        "refit the model or set static_defect in [uncertainty]: pressures have no uncertainty, the others "
        "exclude the error of delta-p");
  Names unstated;
  const auto require = [&](std::initializer_list<EffectLocation> locations, Quantity role) {
    if (!states(locations, {role})) unstated.emplace_back(info_of(role).name);
  };
  require({EffectLocation::static_transducer, EffectLocation::static_line}, Q::static_pressure);
  require({EffectLocation::dynamic_transducer, EffectLocation::static_line, EffectLocation::total_line,
           EffectLocation::pitot},
          Q::dynamic_pressure);
  // The systematic error of a thermometer has a usual size.
  if (chain_->has_temperature() && part_ != UncertaintyPart::systematic)
    require({}, model.variables.count(Q::recovery_temperature) > 0 ? Q::recovery_temperature
                                                                   : Q::ambient_temperature);
  if (!unstated.empty())
    notes.emplace_back(fmt::format(
        "set {} in [uncertainty]: the uncertainties exclude errors of these sensors", join_list(unstated)));
  for (const SensorUncertainty& uncertainty : uncertainties_of(model, thermometer_calibration)) {
    if (stated_.calibration.empty()) break;
    const std::vector<std::string>& known = model.covariance.parameters;
    if (!uncertainty.is_usual || std::find(known.begin(), known.end(), uncertainty.name()) != known.end())
      continue;
    notes.emplace_back(
        fmt::format("set \"{}\" in [uncertainty] of the model: the uncertainties assume 0 +- {:g}, the usual "
                    "size",
                    uncertainty.name(), uncertainty.size));
  }
}

std::string OutputUncertainty::comment() const {
  const bool systematic = stated_.has_systematic();
  const bool random = stated_.has_random();
  return fmt::format("one standard deviation: {}",
                     systematic && random ? "the systematic part, which is the same error in neighbouring "
                                            "samples, and the random part, which is not"
                     : systematic ? "the systematic part alone, the same error in neighbouring samples"
                                  : "the random part alone, of a single sample");
}

}  // namespace pcor::internal

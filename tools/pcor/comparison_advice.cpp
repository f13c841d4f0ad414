#include "comparison_advice.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "model_name.hpp"

namespace pcor::tool {
namespace {

bool changes_total_pressure(const ModelEffect& effect) {
  const EffectLocation location = location_of(effect);
  return location == EffectLocation::static_transducer || location == EffectLocation::dynamic_transducer ||
         location == EffectLocation::total_line || location == EffectLocation::pitot;
}

/// Whether an effect of the model changes the residual by a reference: static defects cancel in total
/// pressures.
bool can_refit(const ComparedModel& compared, const std::string& reference) {
  const auto sees = [&reference](const auto& each) {
    return each->name() == reference && each->sees_static_defect();
  };
  return std::any_of(compared.references.begin(), compared.references.end(), sees) ||
         std::any_of(compared.model.model.effects.begin(), compared.model.model.effects.end(),
                     changes_total_pressure);
}

/// Effects that no reference determines: static defects cancel in total pressures.
std::vector<std::string> undetermined_effects(const ComparedModel& compared) {
  std::vector<std::string> ids;
  const bool sees_static_defect =
      std::any_of(compared.references.begin(), compared.references.end(),
                  [](const auto& reference) { return reference->sees_static_defect(); });
  if (sees_static_defect) return ids;
  for (const ModelEffect& effect : compared.model.model.effects) {
    if (!changes_total_pressure(effect)) ids.push_back(effect.id);
  }
  return ids;
}

/// Null if GPS was not requested.
const LevelByGps* level_of(const Levels& levels, const std::string& model) {
  const auto found =
      std::find_if(levels.begin(), levels.end(), [&model](const auto& each) { return each.first == model; });
  return found == levels.end() ? nullptr : &found->second;
}

// hPa, error of delta-p of a model that is worth applying: the rms of the published laws
// (data/models/README.md).
constexpr double max_model_error = 0.3;

/// Evidence about a model, best first.
enum class Support { supported, undecided, refuted };

/// Whether the residuals are consistent with the model. By GPS the error of its delta-p and two standard
/// errors are small; the rms of all residuals not by GPS is close to the noise. Effects with zero
/// coefficients correct nothing, which a reference that determines the level shows. @param worst of all
/// references
Support evidence_for(const ModelComparison& worst, const ModelDefinition& model, const Levels& levels) {
  const LevelByGps* const level = level_of(levels, worst.name);
  if (worst.is_by_gps() && level != nullptr && !level->is_determined()) return Support::undecided;
  const std::vector<ModelEffect>& effects = model.model.effects;
  const bool is_zero = std::all_of(effects.begin(), effects.end(), [](const ModelEffect& effect) {
    return !effect.is_surface() && std::all_of(effect.parameters.begin(), effect.parameters.end(),
                                               [](double value) { return value == 0.0; });
  });
  if (is_zero && !effects.empty()) return Support::refuted;
  if (level != nullptr) {
    const double margin = 2.0 * level->standard_error;
    const bool is_small = std::abs(level->missing) + margin <= max_model_error;
    const bool is_off = std::abs(level->missing) > margin && level->is_determined();
    if (is_off && !is_small) return Support::refuted;
    if (worst.is_by_gps()) return is_small ? Support::supported : Support::undecided;
  }
  if (worst.is_by_gps()) return Support::undecided;
  return is_close_to_noise(worst) ? Support::supported : Support::refuted;
}

/// Composes the steps for the best model.
class ComparisonAdvice {
 public:
  ComparisonAdvice(const ComparisonWithGps& result, const std::vector<ComparedModel>& models,
                   const CompareArguments& options)
      : result_(result),
        models_(models),
        options_(options),
        best_(best_model()),
        compared_(compared(best_)) {}

  std::vector<NextStep> steps() const {
    if (best_.is_circular && result_.comparison.further.empty()) return not_tested();
    switch (support_of(best_)) {
      case Support::supported:
        return to_apply();
      case Support::undecided:
        return to_test();
      default:
        return to_correct();
    }
  }

 private:
  const ComparedModel& compared(const ModelComparison& model) const {
    return *std::find_if(models_.begin(), models_.end(),
                         [&model](const ComparedModel& each) { return each.name == model.name; });
  }

  Support support_of(const ModelComparison& model) const {
    return evidence_for(worst_by_noise(result_.comparison, model), compared(model).model, result_.levels);
  }

  const ModelComparison& best_model() const {
    const auto rank = [this](const ModelComparison& model) {
      const LevelByGps* const level = level_of(result_.levels, model.name);
      return std::pair(support_of(model), level == nullptr ? 0.0 : std::abs(level->missing));
    };
    const std::vector<ModelComparison>& all = result_.comparison.models;
    return *std::min_element(all.begin(), all.end(), [&](const ModelComparison& a, const ModelComparison& b) {
      return by_gps_ ? rank(a) < rank(b) : a.all.rms < b.all.rms;
    });
  }

  const std::string& model_option() const {
    return options_.models[static_cast<std::size_t>(&compared_ - models_.data())];
  }

  /// Why this model was chosen, if there are several.
  std::string choice() const {
    if (models_.size() == 1) return "";
    return by_gps_ ? "An rms by GPS does not rank models. " : best_.name + " has the smallest rms. ";
  }

  static std::string ratio_of(const ModelComparison& model) {
    return fmt::format("{:.1f} times the noise by {}", model.noise_ratio(), model.reference);
  }

  /// Largest ratio of several references.
  std::string largest_ratio() const {
    return result_.comparison.further.empty() || std::isnan(worst_.noise_ratio()) ? "" : ratio_of(worst_);
  }

  /// The mean correction by GPS, if determined.
  std::string correction() const {
    const LevelByGps* const level = level_of(result_.levels, best_.name);
    return level != nullptr && level->is_determined()
               ? "needs a mean correction of " + correction_text(*level)
               : "";
  }

  /// Absolute mean correction plus two standard errors, hPa.
  double bound() const {
    const LevelByGps& level = *level_of(result_.levels, best_.name);
    return std::abs(level.missing) + 2.0 * level.standard_error;
  }

  std::vector<NextStep> not_tested() const {
    return {{fmt::format(
        "{} reads the pressures of {}, so the residual does not test it; give another --reference",
        best_.reference, best_.name)}};
  }

  std::vector<NextStep> to_apply() const {
    const std::string ratio = largest_ratio();
    return {
        {fmt::format("{}{}. To apply it", choice(),
                     by_gps_ ? fmt::format("By GPS {} {}, which with two standard errors is within {} hPa",
                                           best_.name, correction(), max_model_error)
                             : fmt::format("The residual of {} is close to the noise{}", best_.name,
                                           ratio.empty() ? "" : ", at most " + ratio)),
         process_command(options_.comparison.flights, compared_.model, model_option(),
                         options_.comparison.timestamp_alignment)}};
  }

  std::vector<NextStep> to_test() const {
    const bool is_single = models_.size() == 1;
    const std::string found = correction();
    return {{fmt::format(
        "{}GPS does not decide whether {} is right. {}To test it, give flights with circles or reverse "
        "headings and --reference wind, or another --reference",
        choice(), is_single ? best_.name : "one of the models",
        found.empty()
            ? ""
            : fmt::format("{} {}: with two standard errors up to {:.2f} hPa, above the tolerance of {} hPa. ",
                          is_single ? "It" : best_.name, found, bound(), max_model_error))}};
  }

  std::vector<NextStep> to_correct() const {
    if (by_gps_ && compared_.model.model.effects.empty()) {
      return {{fmt::format(
          "GPS does not support {}, which has no coefficient to refit; add an effect, or give another "
          "--reference",
          best_.name)}};
    }
    if (!(best_.all.rms > 0.0)) return not_tested();
    const bool is_worst_close = is_close_to_noise(worst_);
    const bool is_beyond_refit =
        &worst_ != &best_ && !is_worst_close && !can_refit(compared_, worst_.reference);
    const std::string ratio = largest_ratio();
    std::string reason = choice();
    if (is_beyond_refit && !is_close_to_noise(best_) && !std::isnan(best_.noise_ratio()))
      reason += fmt::format("The rms is {}, and {}, which a refit does not change. ", ratio_of(best_), ratio);
    else if (!is_worst_close && !ratio.empty())
      reason += fmt::format("The rms is {}. ", ratio);
    if (is_beyond_refit && is_close_to_noise(best_)) {
      return {{reason + "A refit does not change it. To find the error",
               fmt::format("{} diagnose {}", program(), arguments())}};
    }
    std::vector<NextStep> steps = to_refit(!reason.empty());
    steps.front().text.insert(0, reason);
    return steps;
  }

  std::string arguments() const {
    return fmt::format("{} -m {}", advised_command_line(options_.comparison), model_argument(model_option()));
  }

  std::vector<NextStep> to_refit(bool has_reason) const {
    const std::vector<std::string> undetermined = undetermined_effects(compared_);
    if (!undetermined.empty() && undetermined.size() == compared_.model.model.effects.size()) {
      return {{fmt::format(
          "Static defects cancel in the total pressure, so a refit to it cannot determine {}; compare it "
          "with a static pressure, for example --reference static:OTHER.toml",
          best_.name)}};
    }
    const std::vector<std::filesystem::path> inputs = input_files(options_.comparison, options_.models);
    std::string refit =
        fmt::format("{} refit {} -o {}", program(), arguments(), output_file("fitted.toml", inputs));
    for (const std::string& id : undetermined) refit += " --fix " + shell_quote(id);
    if (is_verbose() && result_.comparison.total_pressure && result_.comparison.is_static_pressure) {
      return {{"To refit its coefficients", refit},
              {"To refit both systems together",
               fmt::format("{} --refit-reference {}", refit, output_file("fitted-reference.toml", inputs))}};
    }
    return {{fmt::format("To refit {}", by_gps_ && has_reason ? best_.name : "its coefficients"), refit}};
  }

  const ComparisonWithGps& result_;
  const std::vector<ComparedModel>& models_;
  const CompareArguments& options_;
  const bool by_gps_ = result_.comparison.models.front().is_by_gps();
  const ModelComparison& best_;
  const ComparedModel& compared_;
  const ModelComparison& worst_ = worst_by_noise(result_.comparison, best_);
};

}  // namespace

std::string correction_text(const LevelByGps& level) {
  return fmt::format("{:+.2f} +- {:.2f} hPa", level.missing, level.standard_error);
}

bool is_close_to_noise(const ModelComparison& worst) { return worst.noise_ratio() < 1.15; }

std::vector<NextStep> next_steps(const ComparisonWithGps& result, const std::vector<ComparedModel>& models,
                                 const CompareArguments& options) {
  return ComparisonAdvice(result, models, options).steps();
}

}  // namespace pcor::tool

#include "improve/improve_loop.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include <pcor/base/error.hpp>
#include <pcor/diagnose/diagnosis_report.hpp>
#include <pcor/effects/static_surface.hpp>
#include "campaign/reference_id.hpp"
#include "diagnose/finding_page.hpp"
#include "diagnose/rms.hpp"
#include "diagnose/unexplained.hpp"
#include "improve/rival_choice.hpp"
#include "residuals/flight_statistics.hpp"

namespace pcor::internal {
namespace {

// Tolerated growth of the fit's rms, because the fit weighs samples by their noise and ignores outliers.
constexpr double fit_limit = 1.005;
/// Factor on an rms of held-out samples, or of all, from which a model is worse than the input model.
constexpr double much_worse = 1.02;
/// Such a factor on held-out parts of the fitted flights. On flights of an hour a right law, fitted to parts,
/// is up to 1.17 times worse than its true coefficients by chance (tests/real); above 1.05 a warning is
/// given.
constexpr double much_worse_on_parts = 1.25;
constexpr double worse_on_parts = 1.05;
// Tolerance relative to the noise: smaller differences of the static pressure do not matter.
constexpr double negligible = 0.05;

/// rms of the held-out samples, hPa; NaN if there are no such samples
double held_out_rms(const RefitResult& fit) {
  SquareSum sum;
  for (const FlightFit& flight : fit.flights) {
    if (!flight.holdout || flight.after.samples == 0) continue;
    const auto count = static_cast<double>(flight.after.samples);
    sum += {flight.after.rms * flight.after.rms * count, count};
  }
  return sum.rms();
}

std::string shown(double rms) { return fmt::format("{:.4f} hPa", rms); }

/// Fitted coefficients of an effect: "tau = 0.21 +- 0.02 s".
std::string coefficients_of(const RefitResult& fit, const std::string& effect) {
  std::vector<std::string> words;
  for (const FittedParameter& parameter : fit.parameters) {
    const std::string prefix = effect + ".";
    if (!parameter.fitted || parameter.name.rfind(prefix, 0) != 0) continue;
    const std::string error = std::isnan(parameter.standard_error)
                                  ? std::string(" (error unknown)")
                                  : fmt::format(" +- {:.2g}", parameter.standard_error);
    words.push_back(parameter.name.substr(prefix.size()) + " = " +
                    report::with_unit(fmt::format("{:.4g}{}", parameter.value, error), parameter.unit));
  }
  return fmt::format("{}", fmt::join(words, ", "));
}

/// Whether one fitted coefficient of an effect at least is more than three standard errors from its neutral
/// value, at which a fit by GPS alone starts; a formula starts at an estimate and is neutral at 0.
bool is_significant(const RefitResult& fit, const ModelEffect& effect) {
  return std::any_of(fit.parameters.begin(), fit.parameters.end(), [&](const FittedParameter& parameter) {
    const double neutral = effect.is_formula() ? 0.0 : parameter.start;
    return parameter.fitted && parameter.name.rfind(effect.id + ".", 0) == 0 &&
           std::abs(parameter.value - neutral) > 3.0 * parameter.standard_error;
  });
}

/// Whether a surface of the attack may describe what the model lacks: structure without a named cause, or an
/// effect of the attack, and no larger effect of another kind. The surface would imitate that effect on these
/// flights.
bool surface_may_describe(const Diagnosis& diagnosis) {
  bool is_open = diagnosis.verdict == Verdict::partial || diagnosis.verdict == Verdict::unexplained;
  double lacking = is_open ? diagnosis.unexplained.rms : 0.0;
  double other = 0.0;
  for (const Finding& finding : diagnosis.findings) {
    const bool is_of_attack = finding.family == "attack";
    is_open = is_open || is_of_attack;
    double& part = is_of_attack ? lacking : other;
    part = std::max(part, finding.rms);
  }
  return is_open && lacking >= other;
}

/// Forward selection of effects: the steps so far, and the next ones.
class ForwardSelection {
 public:
  ForwardSelection(const ImproveLoop& loop, const ModelDefinition& model) : loop_(loop), given_{model} {
    result_.holdout_is_flights = loop.has_holdout;
    ImproveStep first;
    RefitResult fit = loop.refit(given_);
    set_errors(first, fit, {});
    if (std::isnan(first.rms_holdout)) {
      throw Error(
          Error::Code::samples,
          "no held-out sample is usable, so no step can be tested; give flights longer than 7 minutes, or "
          "one with --holdout");
    }
    const std::string before =
        std::isnan(fit.rms_before) ? "" : fmt::format("{} before, ", shown(fit.rms_before));
    first.summary = fmt::format("the coefficients fitted again: rms {}{} after", before, shown(fit.rms));
    accept_step(std::move(first), std::move(fit), {}, {});
  }

  Improvement run() {
    while (result_.stop_explanation.empty()) next_step();
    choose_among_rivals();
    add_surface();
    compare_with_the_given();
    result_.model = std::move(delivered_.file);
    for (const auto& [id, reason] : rejected_) notes_.push_back(reason);
    result_.fit.notes.insert(result_.fit.notes.end(), notes_.begin(), notes_.end());
    return std::move(result_);
  }

 private:
  const Diagnosis& diagnosis() const { return result_.steps.back().diagnosis; }
  TrialModel top() const { return {result_.fit.model, shared_effects_}; }

  /// Index among the rivals of a step; empty if no rival is applied.
  using AppliedRival = std::optional<std::size_t>;

  /// The model with one rival of each step, fitted.
  TrialModel model_with(const std::vector<AppliedRival>& choices) const {
    TrialModel model = given_;
    for (std::size_t index = 0; index < alternatives_.size(); ++index) {
      if (choices[index]) model = loop_.add(model, alternatives_[index][*choices[index]]);
    }
    model.file = loop_.refit(model).model;
    return model;
  }

  /// If the rivals of a step differ in static pressure, the model gets the one from `choose_rival`, or no
  /// effect; the uncertainty is part of its stated error.
  void choose_among_rivals() {
    const std::vector<AppliedRival> first_of_each(alternatives_.size(), 0);
    std::vector<AppliedRival> choices = first_of_each;
    error_of_first_.assign(alternatives_.size(), 0.0);
    for (std::size_t index = 0; index < alternatives_.size(); ++index) {
      if (alternatives_[index].size() < 2) continue;
      choices[index] = choice_of(index, result_.steps[index + 1]);
    }
    delivered_ = top();
    if (choices != first_of_each) {
      try {
        delivered_ = model_with(choices);
      } catch (const Error& error) {  // single choices may not be fittable together
        for (std::size_t index = 0; index < alternatives_.size(); ++index) {
          ImproveStep& step = result_.steps[index + 1];
          step.delivered = step.added;
          step.rival_error = error_of_first_[index];
        }
        notes_.push_back(fmt::format(
            "the rivals that were chosen cannot be fitted together, so the model has the effects that "
            "were added: {}",
            error.what()));
      }
    }
    add_rival_error(delivered_.file);
  }

  /// States the expected error of the choice among rivals, and the rivals, in a model.
  void add_rival_error(ModelDefinition& model) const {
    double squares = 0.0;
    ProvenanceList rivals;
    for (const ImproveStep& step : result_.steps) {
      squares += step.rival_error * step.rival_error;
      for (const StepRival& rival : step.rivals)
        rivals.emplace_back(fmt::format("{} for {}: probability {:.3f}{}", rival.effect, step.added,
                                        rival.probability,
                                        rival.effect == step.delivered ? ", applied" : ""));
    }
    if (squares > 0.0) {
      double& stated = model.uncertainty.static_defect.emplace(model.uncertainty.static_defect.value_or(0.0));
      stated = std::sqrt(stated * stated + squares);
    }
    if (!rivals.empty()) model.provenance.emplace_back("rivals", ProvenanceValue{rivals});
  }

  /// Measures the change of static pressure by the rivals of a step, with the other effects as after the
  /// last step. The first rival stays if all are similar.
  AppliedRival choice_of(std::size_t index, ImproveStep& step) {
    std::vector<AppliedRival> choices(alternatives_.size(), 0);
    std::vector<TrialModel> models;
    std::vector<std::size_t> tested;
    try {
      choices[index].reset();
      models.push_back(model_with(choices));
    } catch (const Error&) {
      return 0;
    }
    for (std::size_t k = 0; k < alternatives_[index].size(); ++k) {
      choices[index] = k;
      try {
        models.push_back(k == 0 ? top() : model_with(choices));
      } catch (const Error&) {
        continue;  // an effect that cannot be fitted here is not a rival
      }
      tested.push_back(k);
    }
    double sum = 0.0;
    for (const std::size_t k : tested) sum += alternatives_[index][k].probability;
    const std::vector<TrialFlight> tried = loop_.try_models(models);
    std::vector<std::vector<double>> changes;
    std::vector<double> weights;
    for (std::size_t i = 0; i < tested.size(); ++i) {
      weights.push_back(alternatives_[index][tested[i]].probability / sum);
      changes.push_back(static_changes_of(tried, 0, i + 1));
    }
    const double matters = negligible * step.noise_rms;
    const RivalChoice choice = choose_rival(changes, weights, matters);
    if (choice.rival == 0U && choice.error <= matters) return 0;
    step.rival_error = choice.error;
    error_of_first_[index] = choice.error_of_first;
    step.delivered.clear();
    for (std::size_t i = 0; i < tested.size(); ++i)
      step.rivals.push_back(
          {alternatives_[index][tested[i]].effect.id, weights[i], square_sum_of(changes[i]).rms()});
    if (!choice.rival) return std::nullopt;
    step.delivered = step.rivals[*choice.rival].effect;
    return tested[*choice.rival];
  }

  /// If structure remains, or an effect of attack with an undetermined shape: adds a smooth surface if it
  /// reduces the residual of samples outside its fit by more than chance.
  void add_surface() {
    if (!loop_.offer_surface || !surface_may_describe(diagnosis())) return;
    const EffectInfo& surface = surface_info.front();
    const std::string id(surface.id);
    std::optional<SurfaceOffer> offer;
    std::string figures;
    RefitResult fit;
    try {
      offer = loop_.offer_surface(delivered_);
      if (!offer) return;
      const TrialComparison& compared = offer->compared;
      figures = fmt::format("rms {} with it, {} without it on {}", shown(compared.rms_after),
                            shown(compared.rms_before), offer->compared_on);
      const bool is_smaller = compared.rms_after <= unnamed_limit * compared.rms_before;
      if (!is_smaller || !compared.is_better()) {
        const std::string why =
            is_smaller ? fmt::format("the decrease of chi2, {:.0f} +- {:.0f}, is not significant",
                                     compared.chi2_reduction, compared.chi2_reduction_error)
                       : fmt::format("it must reduce the rms by {:.0f} %", 100.0 * (1.0 - unnamed_limit));
        result_.stop_explanation += fmt::format("; rejected: {}, {}; {}", id, figures, why);
        return;
      }
      fit = loop_.refit(offer->model);
    } catch (const Error& error) {  // keeps the model without a surface
      if (error.code() == Error::Code::file) throw;
      result_.stop_explanation += fmt::format("; a surface was not fitted: {}", error.what());
      return;
    }
    ImproveStep step;
    step.added = step.delivered = id;
    step.title = std::string(surface.title);
    set_errors(step, fit, delivered_.shared_effects);
    // The parts are others than those of the steps before: their ratio is applied to the step before.
    if (!loop_.has_holdout)
      step.rms_holdout =
          result_.steps.back().rms_holdout * offer->compared.rms_after / offer->compared.rms_before;
    double degrees = 0.0;
    for (const SurfaceFit& each : fit.surfaces) {
      if (each.effect == id) degrees = each.degrees_of_freedom;
    }
    step.summary = fmt::format(
        "{}: {:.1f} degrees of freedom; {}, decrease of chi2 {:.0f} +- {:.0f}; the surface describes "
        "the residual and identifies no cause",
        id, degrees, figures, offer->compared.chi2_reduction, offer->compared.chi2_reduction_error);
    if (offer->may_be_of_reference) {
      // The two systems are equivalent: the surface is as probable on each.
      constexpr double probability = 0.5;
      step.rivals = {{id, probability, offer->static_change},
                     {id_on_other_system("", id), 1.0 - probability}};
      step.rival_error = std::sqrt(1.0 - probability) * offer->static_change;
    }
    accept_step(std::move(step), std::move(fit), {}, delivered_.shared_effects);
    // The uncertainty of the choice among rivals stays part of the stated error.
    add_rival_error(result_.fit.model);
    delivered_.file = result_.fit.model;
  }

  /// Compares the delivered model with the input model.
  void compare_with_the_given() {
    std::vector<TrialFlight> tried = loop_.try_models({given_, {result_.refitted}, delivered_, top()});
    const TrialComparison train = comparison_of(tried, 0, 2, false);
    const TrialComparison holdout = comparison_of(tried, 0, 2, true);
    if (delivered_.file.law.rms_hpa) delivered_.file.law.rms_hpa = train.rms_after;
    result_.given_rms_train = train.rms_before;
    result_.rms_train = train.rms_after;
    result_.given_rms_holdout = holdout.rms_before;
    result_.rms_holdout = holdout.rms_after;
    // Without an applied rival the model explains less than with the best one, which shows whether the loop
    // did harm.
    const TrialComparison given = comparison_of(tried, 0, 3, loop_.has_holdout);
    result_.rejection_reason =
        std::isnan(given.rms_before)  // the input model has no residual on these samples
            ? why_worse(comparison_of(tried, 1, 3, loop_.has_holdout), "refitted")
            : why_worse(given, "input");
    if (result_.rejection_reason.empty()) result_.rejection_reason = why_worse_on_parts();
    for (TrialFlight& flight : tried) {
      if (!flight.first_reference) continue;
      std::vector<std::size_t> used = flight.fitted;
      used.insert(used.end(), flight.held_out.begin(), flight.held_out.end());
      const auto shown = [&](std::size_t model) { return select_samples(flight.residuals[model], used); };
      result_.flights.push_back(
          {flight.samples, flight.fitted.size(), flight.held_out.size(), shown(0), shown(1), shown(2)});
    }
  }

  /// Whether all steps together increased the residual, by a large or significant amount. @param before name
  /// of the model without the steps
  std::string why_worse(const TrialComparison& whole, const char* before) const {
    // Gusts are in the residual of GPS: a better law need not make it smaller in the fit.
    if (loop_.is_by_gps && !loop_.has_holdout) return "";
    const double growth = whole.rms_after / whole.rms_before;
    if (!(growth > much_worse) && !(growth > fit_limit && whole.is_worse())) return "";
    return fmt::format(
        "{}: the rms of the best model is {:.4f} times the rms of the {} model (increase of chi2 {:.0f} +- "
        "{:.0f})",
        loop_.has_holdout ? "held-out samples" : "these flights", growth, before, -whole.chi2_reduction,
        whole.chi2_reduction_error);
  }

  /// Whether all steps together increased the residual of held-out parts of the fitted flights by a large
  /// amount, although the fit follows these flights more closely than the input model. A smaller increase is
  /// a note.
  std::string why_worse_on_parts() {
    const double before = result_.given_rms_train;
    const double after = result_.steps.back().rms_holdout;
    if (loop_.has_holdout || loop_.is_by_gps || !(much_worse * result_.rms_train < before) ||
        !(after > worse_on_parts * before))
      return "";
    std::string why = fmt::format(
        "held-out parts of these flights: the rms of the best model is {}, the rms of the input model {}; "
        "the "
        "flights do not determine the coefficients",
        shown(after), shown(before));
    if (after > much_worse_on_parts * before) return why;
    notes_.push_back(warning_note("add flights: " + why));
    return "";
  }

  void next_step() {
    const bool all = names_causes();
    std::vector<OfferedEffect> candidates = candidates_now();
    if (candidates.empty()) return stop_without_candidates();
    const std::size_t added = result_.steps.size() - 1;
    if (added >= loop_.max_steps)
      return stop(StopReason::max_steps, fmt::format("{} effects were added, the maximum", added));
    std::vector<std::string> reasons;
    for (OfferedEffect& candidate : candidates) {
      const std::string id = candidate.choices.front().effect.id;
      rejected_.erase(id);
      std::string reason = rejection_reason_of(std::move(candidate));
      if (!reason.empty()) {
        reasons.push_back(reason);
        rejected_[id] = std::move(reason);
      } else if (!all || result_.steps.size() > loop_.max_steps) {
        break;
      }
    }
    // After an addition, the diagnosis of the extended model has the next candidates.
    if (result_.steps.size() > added + 1) return;
    rejected_.clear();  // `stop_explanation` has them
    stop(StopReason::no_gain,
         fmt::format("no candidate is kept{}; {}", role_advice(), fmt::join(reasons, "; ")));
  }

  /// Advice to name the variable of a role, without which an effect is not tested; empty if no role lacks
  /// one.
  std::string role_advice() const {
    if (diagnosis().unnamed_roles.empty()) return "";
    const UnnamedRole& unnamed = diagnosis().unnamed_roles.front();
    return fmt::format("; write {} = \"{}\" into [variables] of the model to test {}", unnamed.role,
                       unnamed.variable, unnamed.effect);
  }

  void stop(StopReason reason, std::string why) {
    result_.stop_reason = reason;
    result_.stop_explanation = std::move(why);
  }

  /// Whether the diagnosis names each cause: then all candidates that help are added, otherwise the first.
  bool names_causes() const {
    return diagnosis().verdict == Verdict::identified || diagnosis().verdict == Verdict::ambiguous;
  }

  std::vector<OfferedEffect> candidates_now() const {
    const Diagnosis& now = diagnosis();
    std::vector<OfferedEffect> candidates;
    if (now.verdict == Verdict::none_detected) return candidates;
    for (const Finding& finding : now.findings) {
      if (!finding.may_be_of_reference() && !has_effect(result_.fit.model, finding.effect.id))
        candidates.push_back(offered_effect(finding, now));
    }
    if (names_causes() || !loop_.trace_variables) return candidates;
    if (const EmpiricalPredictor* const variable = predictor_with_formula(now.unexplained))
      candidates.push_back(offered_effect(*variable, loop_.flights));
    return candidates;
  }

  /// The first predictor with a formula that is not in the model; nullptr without such a predictor.
  const EmpiricalPredictor* predictor_with_formula(const Unexplained& unexplained) const {
    for (const EmpiricalPredictor& variable : unexplained.variables) {
      if (!variable.formula.empty() && !has_effect(result_.fit.model, id_of_predictor(variable.name)))
        return &variable;
    }
    return nullptr;
  }

  void stop_without_candidates() {
    const Diagnosis& now = diagnosis();
    if (now.findings.empty() && !now.unexplained.significant) {
      std::vector<std::string> off;
      for (const HeldOutPart& part : now.held_out) {
        if (part.is_off()) off.push_back(part.text());
      }
      const auto [detectable, all] = detectable_at_usual_size(now);
      return stop(
          StopReason::nothing_missing,
          fmt::format("no missing effect is detectable on {} flights: {} of {} effects would be detected at "
                      "their usual size; the fitted rms residual is {} with a noise of {}{}{}",
                      off.empty() ? "these" : "the fitted", detectable, all, shown(now.rms_given),
                      shown(now.noise_rms), off.empty() ? "" : "; but ", fmt::join(off, "; ")));
    }
    for (const Finding& finding : now.findings) {
      if (finding.may_be_of_reference()) {
        return stop(StopReason::reference_system,
                    fmt::format("{} {} of the reference system, so it is not added (--trust-reference "
                                "assumes that this system is right){}{}",
                                finding.id(), finding.may_be_of_model() ? "may be an error" : "is an error",
                                finding.advice.sentence.empty() ? "" : "; ", finding.advice.sentence));
      }
    }
    if (!now.findings.empty())
      return stop(StopReason::in_model, "the effects named by the diagnosis are already in the model");
    const Unexplained& unexplained = now.unexplained;
    std::string about = "not correlated with any variable of the files";
    if (!unexplained.variables.empty()) {
      about = fmt::format("correlated with {}", unexplained.variables.front().name);
      about += role_advice();
      if (now.unnamed_roles.empty()) {
        const EmpiricalPredictor* const predictor = predictor_with_formula(unexplained);
        about += loop_.trace_variables || predictor == nullptr
                     ? "; no formula of this variable can be added"
                     : fmt::format("; --trace-variables adds a formula of {}", predictor->name);
      }
    }
    stop(StopReason::unexplained,
         fmt::format("{} rms is unexplained{}{}, {}", shown(unexplained.rms),
                     unexplained.regime.empty() ? "" : ", largest in ", unexplained.regime, about));
  }

  /// Adds the candidate and keeps it if it helps. @return the reason if it does not; empty if it is kept
  std::string rejection_reason_of(OfferedEffect candidate) {
    const std::string id = candidate.choices.front().effect.id;
    ImproveStep& step = candidate.step;
    step.added = step.delivered = id;
    // The prior of a fit by GPS alone would make the effect small for any cause.
    if (loop_.is_by_gps && candidate.impossible_size > 0.0) {
      return fmt::format(
          "rejected: {}, its size is {} times the usual one: confirm it with a laser or a second system, "
          "because the atmosphere is a more likely cause",
          id, report::ratio_text(candidate.impossible_size));
    }
    TrialModel model;
    RefitResult fit;
    try {
      model = loop_.add(top(), candidate.choices.front());
      fit = loop_.refit(model);
    } catch (const Error& error) {
      return fmt::format("rejected: {}, not fitted: {}", id, error.what());
    }
    // If held-out samples are compared by height, an error of the dynamic pressure hardly changes their rms.
    if (loop_.is_by_gps && !is_significant(fit, candidate.choices.front().effect)) {
      return fmt::format("rejected: {}, {}; by GPS alone a coefficient must exceed three standard errors", id,
                         coefficients_of(fit, id));
    }
    const std::vector<TrialFlight> tried = loop_.try_models({top(), {fit.model, model.shared_effects}});
    const TrialComparison fitted = comparison_of(tried, 0, 1, false);
    const TrialComparison held_out = comparison_of(tried, 0, 1, true);
    if (fitted.rms_after > fit_limit * fitted.rms_before && !fitted.is_better()) {
      return fmt::format("rejected: {}, rms of the fit {} with it, {} without it", id,
                         shown(fitted.rms_after), shown(fitted.rms_before));
    }
    // Without held-out flights, the cross-validation parts of the diagnosis are used. If the model describes
    // more samples than before (flaps extended), both models are compared on these samples.
    const bool same_samples = fit.samples == result_.fit.samples;
    const bool is_cross_validated = !loop_.has_holdout && same_samples;
    const TrialComparison& judged = loop_.has_holdout ? held_out : fitted;
    double before = judged.rms_before;
    double after = judged.rms_after;
    if (is_cross_validated) {
      // A diagnosis of the extended model could not change this.
      if (!candidate.is_sure)
        return fmt::format(
            "rejected: {}, the diagnosis found no significant decrease of chi2 on held-out blocks", id);
      set_errors(step, fit, model.shared_effects);
      before = result_.steps.back().rms_holdout;
      after = step.rms_holdout;
    }
    const bool better = is_cross_validated ? after <= before : judged.is_better();
    const bool worse = after > before || (!is_cross_validated && judged.is_worse());
    const std::string figures =
        fmt::format("held-out rms {} with it, {} without it", shown(after), shown(before));
    const std::string gain = is_cross_validated
                                 ? ""
                                 : fmt::format(" (decrease of chi2 {:.0f} +- {:.0f})", judged.chi2_reduction,
                                               judged.chi2_reduction_error);
    if (worse || !(better || (candidate.is_named && candidate.is_sure && fitted.is_better()))) {
      return fmt::format("rejected: {}, {}{}{}", id, figures, gain, worse ? "" : ", not significant");
    }
    if (!candidate.is_named && !(after <= unnamed_limit * before)) {
      return fmt::format("rejected: {}, {}; a term with an unknown cause must reduce the rms by {:.0f} %", id,
                         figures, 100.0 * (1.0 - unnamed_limit));
    }
    if (!is_cross_validated) set_errors(step, fit, model.shared_effects);
    step.summary = fmt::format(
        "{}: {}; held-out rms {} before, {} after{}{}", id, coefficients_of(fit, id), shown(before),
        shown(after),
        better ? "" : ", not significant; kept because the residual of the fitted flights decreases",
        candidate.caution);
    accept_step(std::move(step), std::move(fit), std::move(candidate.choices),
                std::move(model.shared_effects));
    return "";
  }

  /// Figures of a step. The diagnosis replaces missing held-out samples.
  void set_errors(ImproveStep& step, const RefitResult& fit,
                  const std::vector<std::string>& shared_effects) const {
    step.rms_train = fit.rms;
    step.noise_rms = fit.noise_rms;
    step.terms = static_cast<std::size_t>(
        std::count_if(fit.parameters.begin(), fit.parameters.end(),
                      [](const FittedParameter& parameter) { return parameter.fitted; }));
    if (loop_.has_holdout) {
      step.rms_holdout = held_out_rms(fit);
    } else {
      step.diagnosis = loop_.diagnose({fit.model, shared_effects});
      step.rms_holdout = step.diagnosis.residual_rms_held_out;
    }
  }

  /// Appends a measured step, with a diagnosis of the remaining residual.
  void accept_step(ImproveStep step, RefitResult fit, std::vector<AddedEffect> choices,
                   std::vector<std::string> shared_effects) {
    if (result_.steps.empty())
      result_.refitted = fit.model;
    else
      alternatives_.push_back(std::move(choices));
    shared_effects_ = std::move(shared_effects);
    if (loop_.has_holdout) step.diagnosis = loop_.diagnose({fit.model, shared_effects_});
    std::vector<HeldOutPart>& held_out = step.diagnosis.held_out;
    held_out.clear();
    for (const FlightFit& flight : fit.flights) {
      if (flight.holdout) held_out.push_back({flight.flight, flight.after, flight.expected_bias});
    }
    judge_held_out(step.diagnosis);
    result_.steps.push_back(std::move(step));
    result_.fit = std::move(fit);
  }

  const ImproveLoop& loop_;
  Improvement result_;
  TrialModel given_;
  std::vector<std::string> shared_effects_{};  // effects of the model after the last step
  TrialModel delivered_{};                     // the model to write, with the rivals that were chosen
  // alternatives for each added effect, the effect itself first
  std::vector<std::vector<AddedEffect>> alternatives_{};
  std::vector<double> error_of_first_{};           // hPa, of each of them, if the first rival is applied
  Notes notes_{};                                  // notes of the selection, after the notes of the last fit
  std::map<std::string, std::string> rejected_{};  // why the last trial of an effect was dropped
};

}  // namespace

Improvement ImproveLoop::run(const ModelDefinition& model) const {
  return ForwardSelection(*this, model).run();
}

}  // namespace pcor::internal

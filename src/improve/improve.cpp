#include <pcor/improve/improve.hpp>
#include <pcor/roles/with_effects.hpp>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include <pcor/flight/flight.hpp>
#include <pcor/words/error.hpp>
#include "improve/improve_loop.hpp"
#include "numerics/missing.hpp"

namespace pcor {

using namespace internal;

namespace {

// An effect that is named stays unless the held-out rms gets worse. One that is not the cause, or not known
// to be, must earn its place.
constexpr double named_limit = 1.0;
constexpr double unnamed_limit = 0.99;
constexpr double unseen_limit = 1.01;  // of an effect that another reference than the first shows
// Of the fit, which weighs samples by their noise and outliers not at all, the rms may grow so much.
constexpr double fit_limit = 1.005;

/// An effect that the loop may add, and what has to come of it.
struct Candidate {
  ModelEffect effect;
  std::string title;
  std::vector<std::string> aliases;
  double limit = named_limit;  ///< of the held-out rms, as a part of that before
  std::string caution;         ///< ends the sentence on what was learnt
};

/// What may be added after a diagnosis: all of it, or the first that helps.
struct Candidates {
  std::vector<Candidate> effects;
  bool all = false;
};

bool has(const ModelFile& model, const std::string& effect) {
  const std::vector<ModelEffect>& effects = model.model.effects;
  return std::any_of(effects.begin(), effects.end(),
                     [&effect](const ModelEffect& each) { return each.id == effect; });
}

/// The coefficients with which an effect does nothing.
std::vector<double> neutral_of(const ModelEffect& effect) {
  return effect.is_formula() ? std::vector<double>(effect.parameters.size(), 0.0)
                             : neutral_effect(effect.id).parameters;
}

std::string id_of_trace(const std::string& variable) {
  std::string id = "traced-";
  for (const char letter : variable) {
    const bool upper = letter >= 'A' && letter <= 'Z';
    const bool plain = (letter >= 'a' && letter <= 'z') || (letter >= '0' && letter <= '9');
    id += upper ? static_cast<char>(letter - 'A' + 'a') : plain ? letter : '-';
  }
  return id;
}

Candidate candidate_of(const Finding& finding, Verdict verdict) {
  Candidate candidate;
  candidate.effect = finding.effect;
  candidate.title = finding.title;
  for (const Alias& alias : finding.aliases) candidate.aliases.push_back(alias.effect);
  if (verdict == Verdict::partial) {
    candidate.limit = unnamed_limit;
    candidate.caution =
        "; structure is left that it does not explain, so its name is not to be taken for the cause";
  } else if (!candidate.aliases.empty()) {
    candidate.caution =
        fmt::format("; these flights cannot tell it from {}{}{}", fmt::join(candidate.aliases, ", "),
                    finding.advice.sentence.empty() ? "" : ": ", finding.advice.sentence);
  }
  return candidate;
}

Candidate candidate_of(const TracedVariable& variable, const std::string& flights) {
  Candidate candidate;
  candidate.effect.id = id_of_trace(variable.name);
  candidate.effect.parameter_names = {"k"};
  candidate.effect.parameters = {variable.slope};
  candidate.effect.formula = variable.formula;
  candidate.effect.unit = "hPa";
  candidate.effect.source =
      fmt::format("traced in the residuals of {}: {:.0f} % of their variance, p = {:.2g}", flights,
                  100.0 * variable.r2, variable.p_value);
  candidate.title = fmt::format("what goes with {}{}", variable.name,
                                variable.description.empty() ? "" : ", " + variable.description);
  candidate.limit = unnamed_limit;
  candidate.caution = "; no effect of the catalogue explains it, so the cause is still to be found";
  return candidate;
}

std::string shown(double rms) { return fmt::format("{:.4f} hPa", rms); }

/// Some of the samples of a fit, before and after it.
struct Judged {
  double rms_before = nan;  ///< hPa; NaN where there are none
  double rms_after = nan;
  double gain = 0.0;  ///< fall of the squared residuals of all references, in units of the noise
  double gain_variance = 0.0;

  /// Whether the fall is more than chance.
  bool is_sure() const { return gain > 2.0 * std::sqrt(gain_variance); }
};

/// Those that took no part in the fit, or those that did.
Judged judged(const RefitResult& fit, bool held_out) {
  Judged result;
  double before = 0.0;
  double after = 0.0;
  double samples = 0.0;
  for (const FlightFit& flight : fit.further) {
    if (flight.holdout != held_out || flight.after.samples == 0) continue;
    result.gain += flight.gain;
    result.gain_variance += flight.gain_error * flight.gain_error;
  }
  for (const FlightFit& flight : fit.flights) {
    if (flight.holdout != held_out || flight.after.samples == 0) continue;
    const auto count = static_cast<double>(flight.after.samples);
    before += flight.before.rms * flight.before.rms * count;
    after += flight.after.rms * flight.after.rms * count;
    samples += count;
    result.gain += flight.gain;
    result.gain_variance += flight.gain_error * flight.gain_error;
  }
  if (samples == 0.0) return result;
  result.rms_before = std::sqrt(before / samples);
  result.rms_after = std::sqrt(after / samples);
  return result;
}

/// "tau = 0.21 +- 0.02 s": the fitted coefficients of an effect.
std::string coefficients_of(const RefitResult& fit, const std::string& effect) {
  std::vector<std::string> words;
  for (const FittedParameter& parameter : fit.parameters) {
    const std::string prefix = effect + ".";
    if (!parameter.fitted || parameter.name.rfind(prefix, 0) != 0) continue;
    const std::string error = std::isnan(parameter.standard_error)
                                  ? std::string(" (error unknown)")
                                  : fmt::format(" +- {:.2g}", parameter.standard_error);
    words.push_back(fmt::format("{} = {:.4g}{}{}", parameter.name.substr(prefix.size()), parameter.value,
                                error,
                                parameter.unit.empty() || parameter.unit == "1" ? "" : " " + parameter.unit));
  }
  return fmt::format("{}", fmt::join(words, ", "));
}

/// The climb: the ladder so far, and how it goes on.
class Climb {
 public:
  Climb(const ImproveLoop& loop, const ModelFile& model) : loop_(loop) {
    result_.holdout_is_flights = loop.has_holdout;
    ImproveStep first;
    RefitResult fit = loop.refit(model);
    measure(first, fit);
    if (std::isnan(first.rms_holdout)) {
      throw Error(
          "no sample of what is held out can be used, so no step can be tested; give another flight with "
          "--holdout");
    }
    first.learnt = fmt::format("the coefficients fitted again: rms {} before, {} after",
                               shown(fit.rms_before), shown(fit.rms));
    const Judged by_fit = judged(fit, loop_.has_holdout);
    if (by_fit.rms_before > 0.0) growth_ = by_fit.rms_after / by_fit.rms_before;
    gain_ = by_fit.gain;
    gain_error_ = std::sqrt(by_fit.gain_variance);
    take(std::move(first), std::move(fit));
  }

  Improvement run() {
    while (result_.why_stopped.empty()) climb_on();
    result_.model = result_.fit.model;
    result_.worse = why_worse();
    return std::move(result_);
  }

 private:
  const Diagnosis& diagnosis() const { return result_.steps.back().diagnosis; }

  /// Whether the ladder as a whole made the residual worse: much, or surely.
  std::string why_worse() const {
    constexpr double much = 1.02;
    constexpr double surely = 2.0;  // standard deviations
    if (!(growth_ > much) && !(growth_ > 1.0 && gain_ < -surely * gain_error_)) return "";
    return fmt::format(
        "{} the rms of the best model is {:.4f} times that of the model as it was given (fitting the latter "
        "again added {:.0f} +- {:.0f} to its squared residuals in units of the noise)",
        loop_.has_holdout ? "on what was held out" : "on these flights", growth_, -gain_, gain_error_);
  }

  void climb_on() {
    Candidates candidates = candidates_now();
    if (candidates.effects.empty()) {
      result_.why_stopped = why_nothing_is_added();
      return;
    }
    const std::size_t added = result_.steps.size() - 1;
    if (added >= loop_.most_steps) {
      result_.why_stopped = fmt::format("{} effects were added, as many as were allowed", added);
      return;
    }
    candidates.effects.resize(std::min(candidates.effects.size(), loop_.most_steps - added));
    std::vector<std::string> refusals;
    for (const Candidate& candidate : candidates.effects) {
      const std::string refusal = refusal_of(candidate);
      if (refusal.empty()) {
        refusals.clear();
      } else {
        refusals.push_back(refusal);
      }
      if (refusal.empty() != candidates.all) break;
    }
    result_.why_stopped = fmt::format("{}", fmt::join(refusals, "; "));
  }

  Candidates candidates_now() const {
    const Diagnosis& now = diagnosis();
    Candidates candidates;
    if (now.verdict == Verdict::silent) return candidates;
    candidates.all = now.verdict == Verdict::identified || now.verdict == Verdict::ambiguous;
    for (const Finding& finding : now.findings) {
      if (!finding.of_reference && !has(result_.fit.model, finding.effect.id) && !is_a_gamble(finding, now))
        candidates.effects.push_back(candidate_of(finding, now.verdict));
    }
    if (candidates.all || !loop_.trace_variables) return candidates;
    for (const TracedVariable& variable : now.unexplained.variables) {
      if (variable.formula.empty() || has(result_.fit.model, id_of_trace(variable.name))) continue;
      candidates.effects.push_back(candidate_of(variable, loop_.flights));
      break;
    }
    return candidates;
  }

  /// Whether the wrong choice does harm: another of its aliases would correct the static pressure otherwise,
  /// or the effect is not surely the cause and changes that pressure by much more than it takes off the
  /// residual.
  static bool is_a_gamble(const Finding& finding, const Diagnosis& diagnosis) {
    constexpr double tolerable = 0.35;  // of the noise
    constexpr double leverage = 2.0;
    const double limit = tolerable * diagnosis.noise_rms_with_findings;
    if (finding.static_risk > limit) return true;
    if (diagnosis.verdict == Verdict::identified) return false;
    const double explained = std::sqrt(
        std::max(0.0, finding.rms_before * finding.rms_before - finding.rms_after * finding.rms_after));
    return finding.static_change > std::max(limit, leverage * explained);
  }

  std::string why_nothing_is_added() const {
    const Diagnosis& now = diagnosis();
    if (now.findings.empty() && !now.unexplained.significant) {
      std::vector<std::string> off;
      for (const HeldOutPart& part : now.held_out) {
        if (part.is_off()) off.push_back(part.text());
      }
      return fmt::format(
          "nothing is missing that {} flights could show: {} effects were tested, and the rms of {} is "
          "left at a noise of {}{}{}",
          off.empty() ? "these" : "the fitted", now.candidates, shown(now.rms_given), shown(now.noise_rms),
          off.empty() ? "" : "; but ", fmt::join(off, "; "));
    }
    for (const Finding& finding : now.findings) {
      if (finding.of_reference) {
        return fmt::format(
            "{} is of the system that the model is held against, and nothing of the model is to be changed "
            "for it",
            finding.id());
      }
      if (!is_a_gamble(finding, now)) continue;
      std::vector<std::string> names;
      for (const Alias& alias : finding.aliases) names.push_back(alias.effect);
      if (names.empty()) {
        return fmt::format(
            "{} may not be the cause, and would change the corrected static pressure by {}, much more than "
            "it takes off the residual; choose it yourself with pcor add",
            finding.id(), shown(finding.static_change));
      }
      return fmt::format(
          "these flights cannot tell {} from {}, and the corrected static pressure would differ by {} "
          "between them; {}; or choose one yourself with pcor add",
          finding.id(), fmt::join(names, ", "), shown(std::max(finding.static_risk, finding.static_change)),
          finding.advice.sentence.empty() ? "fly a manoeuvre that tells them apart"
                                          : finding.advice.sentence);
    }
    if (!now.findings.empty()) return "what the diagnosis names is in the model already";
    const Unexplained& left = now.unexplained;
    const std::string what =
        fmt::format("{} of structure are left that no effect of the catalogue explains{}{}", shown(left.rms),
                    left.regime.empty() ? "" : ", most of it in ", left.regime);
    if (left.variables.empty()) return what + ", and that no variable of the files goes with";
    return fmt::format("{}; it goes with {}, {}", what, left.variables.front().name,
                       loop_.trace_variables
                           ? "of which no further formula can be added"
                           : "of which --trace-variables would add a formula, wherever its cause lies");
  }

  /// Adds the candidate and keeps it where that helps; else says why not.
  std::string refusal_of(const Candidate& candidate) {
    const std::string& id = candidate.effect.id;
    ImproveStep step;
    step.added = id;
    step.title = candidate.title;
    step.aliases = candidate.aliases;
    RefitResult fit;
    try {
      fit = loop_.refit(loop_.add(result_.fit.model, candidate.effect));
    } catch (const Error& error) {
      return fmt::format("{} was tried, but cannot be fitted: {}", id, error.what());
    }
    measure(step, fit);
    double before = result_.steps.back().rms_holdout;
    double train = result_.steps.back().rms_train;
    double after = step.rms_holdout;
    // Where the model describes more samples than before, those with flaps out, both are compared on these.
    if (fit.samples != result_.fit.samples) {
      ModelEffect nothing = candidate.effect;
      nothing.parameters = neutral_of(candidate.effect);
      const RefitResult from_before = loop_.refit(loop_.add(result_.fit.model, nothing));
      const Judged same_samples = judged(from_before, loop_.has_holdout);
      train = from_before.rms_before;
      before = same_samples.rms_before;
      after = same_samples.rms_after;
    }
    if (!loop_.has_holdout && step.rms_train > fit_limit * train) {
      return fmt::format("{} was tried and dropped: with it the rms of the fit is {}, without it {}", id,
                         shown(step.rms_train), shown(train));
    }
    // What another reference shows, the first may not see: then the sum of all decides, as long as the first
    // hardly minds.
    const bool shown_elsewhere = candidate.limit == named_limit && !fit.further.empty() &&
                                 after <= unseen_limit * before && judged(fit, loop_.has_holdout).is_sure();
    if (!(after <= candidate.limit * before) && !shown_elsewhere) {
      const std::string condition =
          candidate.limit < 1.0 ? fmt::format("; a term whose cause is not known has to take {:.0f} % off it",
                                              100.0 * (1.0 - candidate.limit))
                                : "";
      return fmt::format("{} was tried and dropped: with it the held-out rms is {}, without it {}{}", id,
                         shown(after), shown(before), condition);
    }
    step.learnt = fmt::format("{}: {}; held-out rms {} before, {} after{}", id, coefficients_of(fit, id),
                              shown(before), shown(after), candidate.caution);
    growth_ *= after / before;
    take(std::move(step), std::move(fit));
    return "";
  }

  /// The figures of a rung. Without samples that are held out those of a diagnosis stand for them.
  void measure(ImproveStep& step, const RefitResult& fit) const {
    step.rms_train = fit.rms;
    step.noise_rms = fit.noise_rms;
    step.terms = static_cast<std::size_t>(
        std::count_if(fit.parameters.begin(), fit.parameters.end(),
                      [](const FittedParameter& parameter) { return parameter.fitted; }));
    if (loop_.has_holdout) {
      step.rms_holdout = judged(fit, true).rms_after;
    } else {
      step.diagnosis = loop_.diagnose(fit.model);
      step.rms_holdout = step.diagnosis.residual_rms_held_out;
    }
  }

  /// A rung that was measured is part of the ladder, with what is still missing there.
  void take(ImproveStep step, RefitResult fit) {
    if (loop_.has_holdout) step.diagnosis = loop_.diagnose(fit.model);
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
  // On what is held out, else on all samples.
  double growth_ = 1.0;  // of the rms, over the whole ladder
  double gain_ = 0.0;    // by the first fit
  double gain_error_ = 0.0;
};

/// The variables that all the flights have.
std::vector<std::string> common_variables(const std::vector<std::filesystem::path>& flights,
                                          TimeStamp time_stamp) {
  std::vector<std::string> common;
  for (std::size_t i = 0; i < flights.size(); ++i) {
    const Flight flight(flights[i], time_stamp);
    if (i == 0) common = flight.variables();
    common.erase(std::remove_if(common.begin(), common.end(),
                                [&flight](const std::string& name) { return !flight.has(name); }),
                 common.end());
  }
  return common;
}

/// Holds parameters of the last effect, which its flights cannot tell from others.
void hold(ModelFile& file, const std::vector<std::string>& parameters) {
  const std::vector<std::string> names = parameter_names(file.model.effects.back());
  file.fits.resize(file.model.effects.size());
  EffectFit& fit = file.fits.back();
  fit.resize(names.size());
  for (std::size_t p = 0; p < names.size(); ++p) {
    if (std::find(parameters.begin(), parameters.end(), names[p]) != parameters.end()) fit[p].fixed = true;
  }
}

}  // namespace

Improvement ImproveLoop::run(const ModelFile& model) const { return Climb(*this, model).run(); }

Improvement improve(const std::vector<std::filesystem::path>& flights, const ModelFile& model,
                    const References& references, const ImproveOptions& options) {
  std::vector<std::filesystem::path> all = flights;
  all.insert(all.end(), options.refit.holdout.begin(), options.refit.holdout.end());
  const std::vector<std::string> variables = common_variables(all, options.refit.time_stamp);
  std::vector<std::string> names;
  for (const std::filesystem::path& flight : flights) names.push_back(flight.filename().string());
  const auto tell = [&options](const std::string& what) {
    if (options.progress) options.progress(what);
  };
  const auto last_of = [&model](const ModelFile& file) {
    return file.model.effects.size() == model.model.effects.size() ? std::string("the model as it is")
                                                                   : file.model.effects.back().id;
  };
  DiagnoseOptions diagnose_with;
  diagnose_with.mask = options.refit.mask;
  diagnose_with.time_stamp = options.refit.time_stamp;
  diagnose_with.formulas = options.formulas;
  diagnose_with.training_share = options.refit.training_share;
  diagnose_with.progress = options.refit.progress;

  std::map<std::string, Finding> found;  // of all rungs, by effect
  ImproveLoop loop;
  loop.refit = [&](const ModelFile& file) {
    tell("fitting with " + last_of(file));
    return refit(flights, file, references, options.refit);
  };
  loop.diagnose = [&](const ModelFile& file) {
    tell("looking for what is missing beside " + last_of(file));
    diagnose_with.explained = 0.0;
    for (const ModelEffect& effect : file.model.effects) {
      const auto before = found.find(effect.id);
      if (before != found.end()) diagnose_with.explained += before->second.chi2;
    }
    Diagnosis diagnosis = diagnose(flights, file, references, diagnose_with);
    for (const Finding& finding : diagnosis.findings) {
      if (!finding.of_reference) found.insert_or_assign(finding.effect.id, finding);
    }
    return diagnosis;
  };
  loop.add = [&](const ModelFile& file, const ModelEffect& effect) {
    ModelFile extended = with_effects(file, {effect}, variables);
    const auto finding = found.find(effect.id);
    if (finding != found.end()) hold(extended, finding->second.held);
    return extended;
  };
  loop.has_holdout = !options.refit.holdout.empty() || options.refit.training_share < 1.0;
  loop.trace_variables = options.trace_variables;
  loop.most_steps = options.most_steps;
  loop.flights = fmt::format("{}", fmt::join(names, ", "));
  return loop.run(model);
}

}  // namespace pcor

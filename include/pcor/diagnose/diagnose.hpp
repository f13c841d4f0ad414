#pragma once

#include <pcor/campaign/flight_set.hpp>
#include <pcor/model_io/model_definition.hpp>
#include <pcor/residuals/reference.hpp>
#include <pcor/residuals/residuals.hpp>
#include <pcor/residuals/statistics.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace pcor {

/// What a diagnosis comes to.
enum class Verdict {
  silent,       ///< nothing is missing that these flights could show
  identified,   ///< effects are missing, and each can be named
  ambiguous,    ///< an effect is missing, but these flights cannot tell it from others
  partial,      ///< effects explain much, but structure is left that they do not explain
  unexplained,  ///< structure is there, and no effect explains it
};

/// As JSON and text have it: "silent", "identified", "cannot be told apart", "partial", "unexplained".
std::string_view to_string(Verdict verdict);

struct DiagnoseOptions {
  MaskOptions mask;
  /// The flights, by number, of which `Diagnosis::flights` holds the records. If not said, all of up to
  /// sixteen; of more those with the largest residual, and others spread over the time in which they were
  /// flown.
  std::optional<std::vector<std::size_t>> series_of{};
  /// Formula effects that are tried beside the catalogue. Those that the model has are part of the model.
  std::vector<ModelEffect> formulas{};
  bool whole_file = true;                    ///< look for structure in every variable of the files
  std::vector<std::string> not_variables{};  ///< variables of the files that are not looked at
  double training_share = 1.0;  ///< only the first part of every flight, this share of the samples
  bool trust_reference =
      false;  ///< the references are exact: no effect of a laser or of another system is tested
  /// Ids of effects that an earlier diagnosis found and that the model has now. The shape of an effect of the
  /// flow is uncertain, so what the formula leaves of such an effect is not named as a further effect.
  std::vector<std::string> added{};
  std::uint64_t seed = 20120106;  ///< of the draws that set thresholds
  /// Told after every flight of this member.
  std::function<void(std::size_t done, std::size_t total)> progress{};
};

/// A coefficient as the diagnosis estimates it.
struct Estimate {
  std::string name;  ///< of the parameter, e.g. "tau"
  std::string unit;
  double value = 0.0;
  double standard_error = 0.0;  ///< with the memory of the noise
  double typical = 0.0;         ///< size met in practice; 0 where nobody knows
};

/// A stretch of a flight that speaks for an effect.
struct Evidence {
  std::string flight;
  double begin = 0.0;   ///< s since 1970 UTC
  double end = 0.0;     ///< s since 1970 UTC
  std::string regimes;  ///< what was flown, e.g. "level, yaw manoeuvre"
  double share = 0.0;   ///< of all evidence for the effect, 0 to 1
};

/// An effect that explains the data as well as the one that is named, within the uncertainty.
struct Alias {
  std::string effect;
  std::string title;
  double correlation = 0.0;    ///< of what the two leave after the model's own coefficients, -1 to 1
  double chi2_less = 0.0;      ///< by so much its chi2 is below that of the one named; negative: above
  double size_to_usual = 0.0;  ///< its coefficient over its typical size; 0 where nobody knows
  std::vector<Estimate> estimates{};
  /// As `chi2_less` of the logarithm of the marginal likelihood, which knows how large either is met.
  double log_likelihood_less = 0.0;
  double probability = 0.0;         ///< of being the one that is there, among the one named and its aliases
  ModelEffect correction{};         ///< with the estimated coefficients, ready for a model
  std::vector<std::string> held{};  ///< as `Finding::held`
  bool is_alike = false;            ///< as `Finding::is_alike`
};

/// Which of the regimes that were flown, flown again, would separate rivals.
struct Advice {
  /// For people: what to fly, how long, and how surely it would separate them; where no regime that was flown
  /// helps, what separates the effect in general.
  std::string sentence{};
  std::string manoeuvre{};  ///< the name of the regime, e.g. "yaw manoeuvre"; empty where none helps
  double duration = 0.0;    ///< of all repeats, s
  double power = 0.0;       ///< probability that it separates the effect from all rivals with 95 % confidence
};

/// The name of an effect, or of a coefficient, of a system that the model is held against: "reference:NAME".
/// @param system which one, where there are several: "reference:PSFRD+QCFR:NAME"; else empty
std::string id_on_other_system(const std::string& system, const std::string& name);

/// A missing effect.
struct Finding {
  ModelEffect effect;         ///< with the estimated coefficients, ready for a model
  bool is_alike = false;      ///< the systems that the model is held against have it too
  bool of_reference = false;  ///< it acts on a system that the model is held against
  std::string system{};       ///< which one, where there are several: "PSFRD+QCFR"; else empty
  std::string title;
  std::vector<Estimate> estimates{};
  /// Parameters that the model's own coefficients imitate: neutral in `effect`, to be held in a fit.
  std::vector<std::string> held{};
  double rms = 0.0;    ///< of what it adds to the residual over the samples used, hPa
  double worst = 0.0;  ///< the largest of it, with sign, hPa
  std::string worst_flight;
  double worst_time = 0.0;  ///< s since 1970 UTC
  double chi2 = 0.0;        ///< evidence: fall of the squared residuals in units of the noise
  double p_value = 0.0;     ///< of the best of all candidates being as good on flights without any effect
  /// Of residuals on stretches that took no part in the fit of model and effect (five parts in turn), hPa.
  double rms_before = 0.0;
  double rms_after = 0.0;
  /// On these stretches, with all references: fall of the squared innovations by the effect, in units of the
  /// noise, and its error from how it differs between minutes.
  double gain = 0.0;
  double gain_error = 0.0;
  double events = 0.0;               ///< on how many separate events the evidence rests
  std::vector<Evidence> evidence{};  ///< the strongest first, at most six
  std::vector<Alias> aliases{};      ///< the most likely first
  std::string family{};              ///< what it shares with its other shapes and places, e.g. "lag"
  std::string shape{};               ///< in which it was found; empty: that of the catalogue
  /// Of the shape what no model file can hold: "alike on the other system"; empty
  /// where it can hold all of it.
  std::string shape_beyond_model{};
  std::vector<std::string> variants{};  ///< shapes of it that do as well, empty text for the catalogue's
  std::vector<std::string> places{};    ///< where it may act, e.g. "port", "other-system"; its own first
  double probability = 1.0;             ///< of being the one that is there, among itself and its aliases
  double times_usual = 0.0;             ///< its size over the usual one; 0 where nobody knows
  /// By how much the corrected static pressure would differ, rms hPa, were the worst of the aliases the cause
  /// and not this effect; 0 without aliases.
  double static_risk = 0.0;
  /// By how much the corrected static pressure changes, rms hPa, when model and findings are fitted anew: for
  /// an effect that the model nearly imitates, many times what it takes off the residual.
  double static_change = 0.0;
  Advice advice{};

  /// That of the effect; on another system "reference:ID", or "reference:PSFRD+QCFR:ID" where there are
  /// several.
  std::string id() const;
};

/// An effect that the model's own coefficients imitate.
struct AbsorbedEffect {
  std::string effect;
  std::string title;
  std::vector<std::string> by{};  ///< coefficients like "static-qp.a2"
  double remaining = 0.0;         ///< the part of its variance that they leave, 0 to 1
};

/// An effect that was looked for and not found, and how large it may be nevertheless.
struct UpperLimit {
  std::string effect;
  std::string title;
  std::vector<Estimate> estimates{};  ///< what came out
  std::vector<double> limits{};       ///< of each coefficient's size, 95 % confidence, in its unit
  double rms = 0.0;    ///< hPa that an effect at its limit would add beyond the model's coefficients
  std::string note{};  ///< e.g. "would have to be impossible in size to explain what is left"
};

struct NotTestable {
  std::string effect;
  std::string title;
  std::string reason;  ///< e.g. "needs the role 'cabin_pressure'"
};

/// A variable of the files with which unexplained structure goes.
struct EmpiricalPredictor {
  std::string name;
  std::string unit;
  std::string description{};
  double r2 = 0.0;         ///< part of the residual's variance that goes with it, 0 to 1
  double p_value = 0.0;    ///< that the best of all variables does as well on residuals shifted in time
  double linear_r2 = 0.0;  ///< part that a straight line explains; 0 for an angle
  double slope = 0.0;      ///< of the line, hPa per unit of the variable
  double slope_error = 0.0;
  double centre = 0.0;     ///< mean of the variable over the samples used
  std::string formula{};   ///< of an effect that would describe it, e.g. "k * (ENGTRQ - 48)"
  std::string sampling{};  ///< how it was brought to one value a record, in words; empty where it has one
  /// Where what goes with it may act, as far as references that do not see the static ports tell it:
  /// e.g. "port", "laser"; empty where they do not.
  std::vector<std::string> places{};
  EffectLocation location =
      EffectLocation::static_defect;  ///< of the formula: at the pitot where the total pressures have it too
};

/// What is known of where the cause of a traced variable acts, a clause without its full stop.
std::string places_text(const EmpiricalPredictor& variable);

/// A flight whose residual lies above or below those of the others.
struct FlightOffset {
  std::string flight;
  double size = 0.0;  ///< hPa; positive where delta-p should be larger than in the others
  double standard_error = 0.0;
  double p_value = 1.0;  ///< after protection against chance over all flights
};

/// Structure that no effect explains.
struct Unexplained {
  bool significant = false;
  double rms = 0.0;        ///< hPa
  double drift_rms = 0.0;  ///< of it the part that wanders slowly, with nothing that is recorded, hPa
  double p_value = 1.0;
  std::string regime{};                         ///< where most of it lies, e.g. "climb"
  std::vector<EmpiricalPredictor> variables{};  ///< the strongest first
  std::vector<FlightOffset> steps{};            ///< only those that are significant, the largest first
  std::vector<std::string> shares_noise{};      ///< variables left out: their noise is that of the residual
  /// Variables left out: the files say that they are computed from what the residual is computed from.
  std::vector<std::string> computed{};
};

/// A flight as the diagnosis saw it, for pictures. All arrays have one value for each record.
struct FlightDiagnosis {
  std::size_t number = 0;                        ///< of the flight
  std::string name;                              ///< that of its file
  std::shared_ptr<const FlightSamples> samples;  ///< none of a flight whose records are not held
  std::vector<Mask> mask;
  std::vector<double> before;  ///< residual, the model's own coefficients refitted, hPa; NaN where not used
  std::vector<double> after;   ///< residual with all findings, everything refitted, hPa
  std::vector<std::vector<double>> added;     ///< by each finding, hPa
  std::vector<std::vector<double>> evidence;  ///< for each finding: gain in chi2 per minute around the sample
  std::vector<double> drift;                  ///< what wanders slowly, hPa
  std::vector<double> traced;                 ///< the first traced variable, in its unit; empty without
  std::vector<double> static_pressure;        ///< corrected, hPa
  std::vector<double> mach;
  std::vector<double> attack;    ///< deg; NaN where unknown
  std::vector<double> sideslip;  ///< deg; NaN where unknown
};

struct Diagnosis {
  Verdict verdict = Verdict::silent;
  std::string reference;
  std::vector<Finding> findings{};  ///< the strongest first
  Unexplained unexplained;
  std::vector<AbsorbedEffect> absorbed{};
  std::vector<UpperLimit> limits{};  ///< the effect that could be largest first
  std::vector<NotTestable> not_testable{};
  /// The model's own free coefficients fitted again, as `residual_rms` has them, by names like
  /// "static-qp.a2"; behind them those of the models of the references.
  std::vector<Estimate> own{};
  std::size_t candidates = 0;  ///< effects that were tested
  double threshold = 0.0;      ///< chi2 that an effect had to exceed
  /// Of the residual with the model's coefficients as they are, hPa: what `compare` and `refit` tell of these
  /// samples.
  double rms_given = 0.0;
  double noise_rms = 0.0;  ///< the same of the noise
  /// With the model's free coefficients fitted again by the diagnosis, hPa: linearised, by generalised least
  /// squares.
  double residual_rms = 0.0;
  double residual_rms_held_out = 0.0;  ///< the same on stretches that took no part (five parts in turn), hPa
  double noise_rms_with_findings = 0.0;  ///< of what is left when all findings are taken off, hPa
  std::size_t samples = 0;
  Statistics flaps_out;                 ///< of samples left out because flaps are out, as the model is given
  std::vector<HeldOutPart> held_out{};  ///< the later parts of flights, or flights that `improve` held out
  std::array<std::size_t, mask_count> masks{};
  std::vector<FlightDiagnosis> flights{};  ///< against the first reference
  std::vector<std::string> notes{};

  /// The numbers of the flights whose records are held.
  std::vector<std::size_t> flights_with_records() const;
};

/// What is held out is part of the verdict: where it is off, nothing is not an answer.
void judge_held_out(Diagnosis& diagnosis);

/// Looks for the physical effect that a fitted model lacks.
///
/// Every effect of the catalogue that is not in the model, and every formula of the options, is tested: does
/// what it would add explain residuals that the model's own free coefficients cannot? Columns are derivatives
/// through the whole chain where the model says that the air is; the noise is an autoregression with a level
/// of its own every five minutes and a slow drift; the threshold is that of the best of all candidates on
/// flights without any effect. The noise of several flights is found on all processors.
///
/// @throws Error if a flight cannot be read, a variable of the model is absent, or too few samples are left.
Diagnosis diagnose(const FlightSet& flights, const ModelDefinition& model, const References& references,
                   const DiagnoseOptions& options = {});

}  // namespace pcor

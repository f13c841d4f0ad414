#pragma once

#include <pcor/base/note.hpp>
#include <pcor/campaign/flight_set.hpp>
#include <pcor/model_io/model_definition.hpp>
#include <pcor/residuals/reference.hpp>
#include <pcor/residuals/residuals.hpp>
#include <pcor/residuals/statistics.hpp>

#include <array>
#include <cstddef>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace pcor {

/// Outcome of a diagnosis.
enum class Verdict {
  none_detected,  ///< no missing effect detectable on these flights
  identified,     ///< effects are missing, and each can be named
  ambiguous,      ///< an effect is missing, but these flights do not separate it from others
  partial,        ///< effects explain much of the residual, but significant structure remains
  unexplained,    ///< significant structure that no effect explains
};

/// Text for JSON and reports: "silent", "identified", "cannot be told apart", "partial", "unexplained".
std::string_view to_string(Verdict verdict);

struct DiagnoseOptions {
  MaskOptions mask;
  /// Numbers of the flights whose records `Diagnosis::flights` keeps. Default: all of up to sixteen flights;
  /// of more flights, those with the largest residual and others spread over the period of the flights.
  std::optional<std::vector<std::size_t>> series_of{};
  /// Formula effects tested in addition to the catalogue. Effects of the model are not tested again.
  std::vector<ModelEffect> formulas{};
  bool whole_file = true;                    ///< look for structure in every variable of the files
  std::vector<std::string> not_variables{};  ///< variables of the files to exclude
  double training_share = 1.0;               ///< fraction of each flight used, from its start, 0 to 1
  /// True: references are exact; no effect of a laser or of another system is tested.
  bool trust_reference = false;
  /// Callback after every flight of this rank.
  std::function<void(std::size_t done, std::size_t total)> progress{};
};

/// Coefficient estimated by the diagnosis.
struct CoefficientEstimate {
  std::string name;  ///< parameter, e.g. "tau"
  std::string unit;
  double value = 0.0;
  double standard_error = 0.0;  ///< includes the autocorrelation of the noise
  double typical = 0.0;         ///< typical size; 0 if unknown
};

template <class Field>
void describe(const CoefficientEstimate& self, Field& field) {
  field("name", self.name, "name of the coefficient");
  field("unit", self.unit, "unit of the coefficient");
  field("value", self.value, "estimate", "see unit");
  field("stderr", self.standard_error, "standard error", "see unit");
  field("typical", self.typical, "typical size; 0 if unknown", "see unit");
}

/// Time range of a flight that supports an effect.
struct Evidence {
  std::string flight;
  double begin = 0.0;   ///< s since 1970 UTC
  double end = 0.0;     ///< s since 1970 UTC
  std::string regimes;  ///< e.g. "level, yaw manoeuvre"
  double share = 0.0;   ///< fraction of all evidence for the effect, 0 to 1

  template <class Archive>
  void serialize(Archive& archive) {
    archive(flight, begin, end, regimes, share);
  }
};

template <class Field>
void describe(const Evidence& self, Field& field) {
  field("flight", self.flight, "file of the flight");
  field.time("begin", self.begin, "begin of the interval");
  field.time("end", self.end, "end of the interval");
  field("regimes", self.regimes, "regimes in the interval");
  field("share", self.share, "fraction of all evidence");
}

/// Effect that explains the data as well as the named one within the uncertainty.
struct Alias {
  std::string effect;
  std::string title;
  /// Correlation of the two after projection onto the model's coefficients, -1 to 1.
  double correlation = 0.0;
  double chi2_difference = 0.0;  ///< chi2 of the named effect minus chi2 of this one
  double relative_size = 0.0;    ///< coefficient divided by its typical size; 0 if unknown
  std::vector<CoefficientEstimate> estimates{};
  double probability = 0.0;          ///< posterior probability among the named effect and its aliases, 0 to 1
  ModelEffect correction{};          ///< effect with the estimated coefficients, ready for a model
  std::vector<std::string> fixed{};  ///< see `Finding::fixed`
  bool is_shared = false;            ///< see `Finding::is_shared`
  std::size_t candidate = 0;         ///< index among the tested effects, of which each shape is one
};

template <class Field>
void describe(const Alias& self, Field& field) {
  field("effect", self.effect, "id of the effect");
  field("title", self.title, "title of the effect");
  field("correlation", self.correlation, "correlation with the named effect after projection onto the model");
  field("chi2_less", self.chi2_difference, "chi2 of the named effect minus chi2 of this one");
  field("size_to_usual", self.relative_size, "size divided by the typical size; 0 if unknown");
  field("estimates", self.estimates, "estimated coefficients");
}

/// Regime whose repetition would separate confounded effects.
struct Advice {
  /// Recommended manoeuvre, its duration and its power; if no flown regime helps, a method that separates the
  /// effect in general.
  std::string sentence{};
  std::string manoeuvre{};  ///< regime, e.g. "yaw manoeuvre"; empty if no regime helps
  double duration = 0.0;    ///< total of all repeats, s
  double power = 0.0;       ///< probability that it separates the effect from all rivals with 95 % confidence
};

template <class Field>
void describe(const Advice& self, Field& field) {
  field("manoeuvre", self.manoeuvre, "recommended regime; empty if no regime helps");
  field("duration_s", self.duration, "total duration of all repeats");
  field("power", self.power, "probability that it separates the effect from all rivals with 95 % confidence");
}

/// Coefficients of an effect, and its formula if it has one.
template <class Field>
void describe(const ModelEffect& self, Field& field) {
  field("parameters",
        field.named(self.id.empty() ? std::vector<std::string>() : parameter_names(self), self.parameters),
        "coefficients", "unit of the coefficient");
  if (field.has(!self.scaling.is_none())) {
    field.object("scaling", "scaling of the effect, if any", [&self](Field& scaling) {
      scaling("static_pressure", self.scaling.static_pressure, "power of p/700 hPa");
      scaling("dynamic_pressure", self.scaling.dynamic_pressure, "power of q/70 hPa");
    });
  }
  if (!field.has(self.is_formula())) return;
  field("where", info_of(self.location).name, "stage at which a formula acts; absent for others");
  field("formula", self.formula, "formula; absent for effects of the catalogue");
  field("unit", self.unit, "unit of the formula; absent for effects of the catalogue");
  field("source", self.source, "source of the formula; absent for effects of the catalogue");
}

/// Missing effect.
struct Finding {
  ModelEffect effect;  ///< effect with the estimated coefficients, ready for a model
  /// True: common mode, also present in the compared systems, which a model file cannot express.
  bool is_shared = false;
  bool of_reference = false;  ///< true: acts on a compared system
  std::string system{};       ///< system, if several are compared: "PSFRD+QCFR"; otherwise empty
  std::string title;
  std::vector<CoefficientEstimate> estimates{};
  /// Parameters absorbed by the model's coefficients: neutral in `effect`, fixed in a refit.
  std::vector<std::string> fixed{};
  double rms = 0.0;  ///< rms contribution to the residual over the samples used, hPa
  /// Largest of such contributions to the residual by a single reference, hPa: the first reference, or
  /// another one except wind and height. A drift of a transducer hardly changes the residual by a laser, but
  /// the total pressure.
  double largest_rms = 0.0;
  std::string largest_reference{};  ///< name of that reference; empty if it is the first one
  double worst = 0.0;               ///< largest contribution, with sign, hPa
  std::string worst_flight;
  double worst_time = 0.0;  ///< s since 1970 UTC
  double chi2 = 0.0;        ///< evidence: decrease of chi2, the sum of squared whitened residuals
  double p_value = 0.0;     ///< probability that the best candidate reaches this chi2 if no effect is present
  /// Cross-validated rms residual without and with the effect (five folds), hPa.
  double rms_before = 0.0;
  double rms_after = 0.0;
  /// Decrease of the sum of squared whitened innovations in the same cross-validation, all references; its
  /// standard error follows from the scatter between minutes.
  double chi2_reduction = 0.0;
  double chi2_reduction_error = 0.0;
  double events = 0.0;               ///< number of separate events that support the finding
  std::vector<Evidence> evidence{};  ///< up to six, sorted by decreasing evidence
  std::vector<Alias> aliases{};      ///< sorted by decreasing probability
  std::string family{};              ///< family of its alternative shapes and locations, e.g. "lag"
  std::string shape{};               ///< detected shape; empty: the shape of the catalogue
  /// Equally good shapes; an empty string is the shape of the catalogue.
  std::vector<std::string> variants{};
  /// Possible locations, e.g. "port", "other-system"; location of `effect` first.
  std::vector<std::string> components{};
  double probability = 1.0;    ///< posterior probability among the finding and its aliases, 0 to 1
  double relative_size = 0.0;  ///< size divided by the typical size; 0 if unknown
  Advice advice{};
  /// Cause outside the catalogue that may replace it: "the atmosphere", "an unknown error"; otherwise empty.
  std::string rival{};

  /// Id of the effect; on another system "reference:ID", or "reference:PSFRD+QCFR:ID" if there are several.
  std::string id() const;

  /// `largest_rms` with a unit and its reference: "0.440 hPa rms by total:PSFRD+QCFR".
  std::string size_text(const char* unit = " hPa rms") const;

  /// Whether an effect on the static system of the model may be the cause: this one or an alias.
  bool may_be_of_model() const;
  /// Whether an effect on the system of a reference may be the cause, likewise.
  bool may_be_of_reference() const;
};

template <class Field>
void describe(const Finding& self, Field& field) {
  std::vector<std::string> aliases;
  for (const Alias& alias : self.aliases) aliases.push_back(alias.effect);
  field("effect", self.id(), "id of the missing effect");
  describe(self.effect, field);
  field("title", self.title, "title of the effect");
  field("stderr", field.named(self.estimates, &CoefficientEstimate::standard_error), "standard errors",
        "unit of the coefficient");
  field("units", field.named(self.estimates, &CoefficientEstimate::unit), "units of the coefficients");
  field("estimates", self.estimates, "estimated coefficients");
  field("rms_hpa", self.rms, "contribution to the residual that the model does not absorb, rms");
  field("largest_rms_hpa", self.largest_rms, "the same in the reference in which it is largest, rms");
  field("largest_reference", self.largest_reference, "reference of largest_rms_hpa; empty: the first one");
  field("worst_hpa", self.worst, "largest contribution of the effect alone, with sign");
  field("worst_flight", self.worst_flight, "flight of the largest contribution");
  field.time("worst_time", self.worst_time, "time of the largest contribution");
  field("chi2", self.chi2, "evidence: decrease of chi2");
  field("p_value", self.p_value, "probability of this chi2 if no effect is present");
  field("rms_before_hpa", self.rms_before, "rms residual without the effect, cross-validated");
  field("rms_after_hpa", self.rms_after, "rms residual with the effect, cross-validated");
  field("events", self.events, "number of separate events that support the effect");
  field("evidence", self.evidence, "intervals with the most evidence");
  field("aliases", aliases, "effects that these flights do not separate from this one");
  field("alias_details", self.aliases, "the same effects with their estimates");
  field("family", self.family, "group of alternative shapes and locations");
  field("shape", self.shape, "detected shape; empty: the shape of the catalogue");
  field("variants", self.variants, "shapes that fit as well");
  field("places", self.components, "possible instrument components");
  field("times_usual", self.relative_size, "size divided by the typical size; 0 if unknown");
  field("probability", self.probability, "posterior probability among the effect and its aliases");
  field("advice", self.advice.sentence, "manoeuvre that would separate the effect from its aliases");
  field("advice_details", self.advice, "the same advice in numbers");
}

/// Effect absorbed by the model's coefficients.
struct AbsorbedEffect {
  std::string effect;
  std::string title;
  std::vector<std::string> by{};  ///< coefficients like "static-qp.a2"
  double remaining = 0.0;         ///< fraction of its variance not absorbed, 0 to 1
};

template <class Field>
void describe(const AbsorbedEffect& self, Field& field) {
  field("effect", self.effect, "id of the effect");
  field("title", self.title, "title of the effect");
  field("by", self.by, "coefficients of the model that absorb the effect");
  field("remaining", self.remaining, "fraction of its variance not absorbed");
}

/// Upper limit of an effect that was tested and not found.
struct UpperLimit {
  std::string effect;
  std::string title;
  std::vector<CoefficientEstimate> estimates{};  ///< estimated coefficients
  std::vector<double> limits{};  ///< 95 % confidence limits of each coefficient's size, in its unit
  double rms = 0.0;              ///< contribution at the limit that the model does not absorb, hPa
  std::string note{};            ///< e.g. "size needed to explain the residual is outside physical bounds"
  /// Expected decrease of chi2 by the effect at its usual size; NaN if its usual size is not known.
  double chi2_at_usual_size = std::numeric_limits<double>::quiet_NaN();
};

template <class Field>
void describe(const UpperLimit& self, Field& field) {
  field("effect", self.effect, "id of the effect");
  field("title", self.title, "title of the effect");
  field("estimates", self.estimates, "estimated coefficients");
  field("limits", self.limits, "95 % limit of the size of each coefficient", "unit of the coefficient");
  field("rms_hpa", self.rms, "contribution at the limit that the model does not absorb, rms");
  field("chi2_at_usual_size", self.chi2_at_usual_size,
        "expected decrease of chi2 by the effect at its usual size");
  field("note", self.note, "note on the limit");
}

struct NotTestable {
  std::string effect;
  std::string title;
  std::string reason;  ///< e.g. "needs the role 'cabin_pressure'"
};

template <class Field>
void describe(const NotTestable& self, Field& field) {
  field("effect", self.effect, "id of the effect");
  field("title", self.title, "title of the effect");
  field("reason", self.reason, "reason for which it cannot be tested");
}

/// Variable of the files that correlates with unexplained structure.
struct EmpiricalPredictor {
  std::string name;
  std::string unit;
  std::string description{};
  double r2 = 0.0;         ///< fraction of the residual variance explained, 0 to 1
  double p_value = 0.0;    ///< probability that the best variable does as well on residuals shifted in time
  double linear_r2 = 0.0;  ///< fraction explained by a straight line; 0 for an angle
  double slope = 0.0;      ///< slope of that line, hPa per unit of the variable
  double slope_error = 0.0;
  double centre = 0.0;     ///< mean of the variable over the samples used
  std::string formula{};   ///< formula of a corresponding effect, e.g. "k * (ENGTRQ - 48)"
  std::string sampling{};  ///< method of reduction to one value per record; empty if the file has one
  /// Stronger variable of the same list with a correlation above 0.95 in size, for example another record of
  /// the same angle; empty without such a variable.
  std::string similar_to{};
  /// Possible locations according to references independent of the static ports, e.g. "port", "laser"; empty
  /// if undetermined.
  std::vector<std::string> components{};
  /// Location of the formula: the pitot if the total pressures show the same structure.
  EffectLocation location = EffectLocation::static_defect;
};

template <class Field>
void describe(const EmpiricalPredictor& self, Field& field) {
  field("name", self.name, "variable of the flights");
  field("unit", self.unit, "unit of the variable");
  field("description", self.description, "description of the variable");
  field("r2", self.r2, "fraction of the residual variance that the variable explains");
  field("p_value", self.p_value, "probability that the best variable does as well by chance");
  field("linear_r2", self.linear_r2, "fraction that a straight line explains");
  const double unknown = std::numeric_limits<double>::quiet_NaN();
  const bool has_line = self.slope_error > 0.0;
  field("slope", has_line ? self.slope : unknown, "slope of that line; null without a linear trend",
        "hPa per unit");
  field("slope_stderr", has_line ? self.slope_error : unknown,
        "standard error of the slope; null without a linear trend", "hPa per unit");
  field("centre", self.centre, "mean of the variable", "see unit");
  field("formula", self.formula, "formula of a corresponding effect");
  field("places", self.components, "possible instrument components; empty if undetermined");
  field("sampling", self.sampling, "reduction to one value per record");
  field("similar_to", self.similar_to,
        "stronger variable of the list with a correlation above 0.95 in size; empty without such a variable");
}

/// Clause on the location of the cause, without full stop.
std::string component_text(const EmpiricalPredictor& variable);

/// Bias of a flight relative to the others.
struct FlightOffset {
  std::string flight;
  double size = 0.0;  ///< hPa; positive if delta-p should be larger than in the others
  double standard_error = 0.0;
  double p_value = 1.0;  ///< corrected for the number of flights
};

template <class Field>
void describe(const FlightOffset& self, Field& field) {
  field("flight", self.flight, "file of the flight");
  field("size_hpa", self.size, "bias of the flight relative to the others");
  field("stderr_hpa", self.standard_error, "standard error of the bias");
  field("p_value", self.p_value, "probability of the bias by chance, corrected for the number of flights");
}

/// Structure not explained by any effect.
struct Unexplained {
  bool significant = false;
  double rms = 0.0;        ///< hPa
  double drift_rms = 0.0;  ///< part due to slow drift, uncorrelated with recorded variables, hPa
  double p_value = 1.0;
  std::string regime{};                         ///< regime with most of the structure, e.g. "climb"
  std::vector<EmpiricalPredictor> variables{};  ///< sorted by decreasing gain in likelihood
  std::vector<FlightOffset> steps{};            ///< significant offsets only, by decreasing size
  /// Excluded variables whose noise is correlated with that of the residual.
  std::vector<std::string> shares_noise{};
  /// Variables excluded because, by attributes of the files, they derive from inputs of the residual.
  std::vector<std::string> computed{};
};

template <class Field>
void describe(const Unexplained& self, Field& field) {
  field("significant", self.significant, "whether the structure is significant");
  field("rms_hpa", self.rms, "rms of the structure");
  field("drift_rms_hpa", self.drift_rms, "part due to slow drift, rms");
  field("p_value", self.p_value, "probability of the structure by chance");
  field("regime", self.regime, "regime with most of the structure");
  field("variables", self.variables, "variables that correlate with the structure");
  field("steps", self.steps, "flights with significant biases relative to the others");
  field("shares_noise", self.shares_noise, "variables excluded because they share noise with the residual");
  field("computed", self.computed, "variables excluded because they derive from inputs of the residual");
}

/// Diagnosed flight, for figures. All arrays have one value per record.
struct FlightDiagnosis {
  std::size_t number = 0;                        ///< flight number
  std::string name;                              ///< file name
  std::shared_ptr<const FlightSamples> samples;  ///< records; nullptr if they are not kept
  /// Residual with the model's coefficients refitted (`Diagnosis::is_refitted`), hPa; NaN for samples not
  /// used.
  std::vector<double> before;
  std::vector<double> after;               ///< the same with all findings, hPa
  std::vector<std::vector<double>> added;  ///< contribution of each finding, hPa
  /// For each finding: chi2 reduction per minute around the sample.
  std::vector<std::vector<double>> evidence;
  std::vector<double> drift;            ///< drift of the residual, hPa
  std::vector<double> predictor;        ///< first empirical predictor, in its unit; otherwise empty
  std::vector<double> static_pressure;  ///< corrected, hPa
  std::vector<double> mach;
  std::vector<double> attack;    ///< deg; NaN if unknown
  std::vector<double> sideslip;  ///< deg; NaN if unknown

  template <class Archive>
  void serialize(Archive& archive) {
    archive(number, name, samples, before, after, added, evidence, drift, predictor, static_pressure, mach,
            attack, sideslip);
  }
};

/// Recorded variable with which the residual is correlated, and which seems to be a role that the model does
/// not name but an untested effect reads.
struct UnnamedRole {
  std::string role;
  std::string variable;
  std::string effect;
};

struct Diagnosis {
  Verdict verdict = Verdict::none_detected;
  std::string reference;
  std::vector<Finding> findings{};  ///< sorted by decreasing gain in likelihood
  Unexplained unexplained;
  /// Variable of the files in which a straight line may be the cause in place of the findings, with a
  /// probability of 5 to 95 %; otherwise empty.
  std::string rival{};
  std::vector<AbsorbedEffect> absorbed{};
  std::vector<UpperLimit> limits{};  ///< sorted by decreasing size
  std::vector<NotTestable> not_testable{};
  std::vector<UnnamedRole> unnamed_roles{};  ///< the notes state them
  /// Free coefficients of the model, refitted (see `is_refitted`), with names like "static-qp.a2", followed
  /// by those of the references' models.
  std::vector<CoefficientEstimate> refitted_coefficients{};
  std::size_t candidates = 0;  ///< number of effects tested
  double threshold = 0.0;      ///< chi2 threshold for a detection
  /// rms residual of the unchanged model, hPa, as in `compare` and `refit`.
  double rms_given = 0.0;
  double noise_rms = 0.0;  ///< rms noise with the unchanged model, hPa
  /// Whether the free coefficients of the model and of the references' models are refitted in
  /// `refitted_coefficients`, `residual_rms` and `flights`, by linearised least squares. By GPS alone they
  /// stay as given.
  bool is_refitted = true;
  double residual_rms = 0.0;             ///< rms residual, hPa
  double residual_rms_held_out = 0.0;    ///< cross-validated rms residual (five folds), hPa
  double noise_rms_with_findings = 0.0;  ///< rms noise of the residual with all findings, hPa
  std::size_t samples = 0;
  Statistics flaps_out;                 ///< residuals of samples excluded because of flaps, model unchanged
  std::vector<HeldOutPart> held_out{};  ///< later parts of flights, or flights held out by `improve`
  std::array<std::size_t, mask_count> masks{};
  std::vector<FlightDiagnosis> flights{};  ///< residuals of the first reference
  Notes notes{};

  /// Numbers of the flights whose records are kept.
  std::vector<std::size_t> flights_with_records() const;
};

template <class Field>
void describe(const Diagnosis& self, Field& field) {
  field("verdict", self.verdict, "silent, identified, cannot be told apart, partial or unexplained");
  field("reference", self.reference, "description of the references");
  field("findings", self.findings, "missing effects, strongest first");
  field("unexplained", self.unexplained, "structure that no effect explains");
  field("rival", self.rival, "variable that may be the cause in place of the findings; otherwise empty");
  field("absorbed", self.absorbed, "effects absorbed by coefficients of the model");
  field("limits", self.limits, "effects that were tested and not found");
  field("not_testable", self.not_testable, "effects that cannot be tested on these flights");
  field("candidates", self.candidates, "number of tested effects");
  field("threshold", self.threshold, "chi2 threshold of a detection");
  field("rms_given_hpa", self.rms_given, "rms residual of the unchanged model");
  field("residual_rms_hpa", self.residual_rms, "rms residual after a linearised refit; by GPS as given");
  field("residual_rms_held_out_hpa", self.residual_rms_held_out,
        "rms residual after a linearised refit, cross-validated");
  field("noise_rms_hpa", self.noise_rms, "rms noise with the unchanged model");
  field("noise_rms_with_findings_hpa", self.noise_rms_with_findings, "rms noise with all findings");
  field("samples", self.samples, "number of samples");
  field("flaps_out", self.flaps_out, "residual of samples excluded because of flaps");
  field.list("held_out", self.held_out, "residual of held-out parts",
             [](const HeldOutPart& part, Field& of_part) {
               of_part("name", part.flight, "file of the flight");
               of_part("is_off", part.is_off(), "whether the bias is significant");
               of_part("expected_bias_hpa", part.expected, "expected standard deviation of the bias");
               describe(part.statistics, of_part);
             });
  field("masks", field.named(mask_info, self.masks), "samples with each mask");
  field("notes", self.notes, "notes on the diagnosis");
}

/// Changes `none_detected` to `unexplained` if a held-out part has a significant bias.
void judge_held_out(Diagnosis& diagnosis);

/// Searches for physical effects that a fitted model lacks.
///
/// Tests each formula of the options and each effect of the catalogue that the model lacks: does its
/// contribution explain residuals that the model's free coefficients cannot? Columns are derivatives through
/// the whole chain at pressures that the height and the radome predict. The findings compete with straight
/// lines in the recorded variables. The noise model is an autoregression with a separate level
/// every five minutes and a slow drift. The threshold is the distribution of the best of all candidates on
/// flights without any effect. The noise of several flights is estimated on all processors.
///
/// @throws Error if a flight cannot be read, a variable of the model is absent, or too few samples remain.
Diagnosis diagnose(const FlightSet& flights, const ModelDefinition& model, const References& references,
                   const DiagnoseOptions& options = {});

}  // namespace pcor

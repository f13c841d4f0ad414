#include <pcor/diagnose/diagnose.hpp>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include <pcor/base/error.hpp>
#include <pcor/roles/add_effects.hpp>
#include "campaign/gps_rows.hpp"
#include "campaign/gps_system.hpp"
#include "campaign/reference_id.hpp"
#include "diagnose/analysis.hpp"
#include "diagnose/candidates.hpp"
#include "diagnose/findings.hpp"
#include "diagnose/flaps.hpp"
#include "diagnose/flight_columns.hpp"
#include "diagnose/rms.hpp"
#include "diagnose/shape_uncertainty.hpp"
#include "diagnose/step_dates.hpp"
#include "diagnose/unexplained.hpp"
#include "numerics/missing.hpp"
#include "numerics/triangular_factor.hpp"
#include "report/shown_flights.hpp"
#include "residuals/flight_statistics.hpp"
#include "residuals/masks.hpp"
#include "residuals/serialization.hpp"

namespace pcor {

using namespace internal;

namespace {

/// Changes of all coefficients by base and groups in pictures: by least squares; by GPS alone, where the
/// atmosphere is in the residual, those by maximum likelihood less those of the base alone.
Eigen::VectorXd changes(const Analysis& analysis, const std::vector<std::size_t>& groups, bool is_refitted) {
  if (is_refitted) return analysis.least_squares(groups);
  return analysis.coefficients(groups) - analysis.coefficients({});
}

/// Local flights; entries of the others are empty. @param before, @param corrected changes of all
/// coefficients by the base, and by base and findings
std::vector<FlightDiagnosis> flights_of(const Analysis& analysis, const Eigen::VectorXd& before,
                                        const Eigen::VectorXd& corrected) {
  const std::vector<std::size_t>& chosen = analysis.result().chosen;
  const Eigen::VectorXd with = analysis.coefficients(chosen);
  const std::vector<Eigen::VectorXd> evidence = evidence_of_findings(analysis);
  std::vector<FlightDiagnosis> flights(analysis.flights().size());
  for (std::size_t f = 0; f < flights.size(); ++f) {
    if (!analysis.partition().is_local(f)) continue;
    const FlightColumns& columns = analysis.flights()[f];
    FlightDiagnosis& flight = flights[f];
    flight.samples = columns.samples;
    flight.before = residual_after(columns, before);
    flight.after = residual_after(columns, corrected);
    for (std::size_t k = 0; k < chosen.size(); ++k) {
      flight.added.push_back(analysis.added_by(f, chosen[k], with));
      flight.evidence.push_back(evidence_along(analysis, f, evidence[k]));
    }
    flight.drift = analysis.drift(f, corrected);
    flight.static_pressure = columns.corrected_pressure;
    flight.mach = columns.quantity(Quantity::corrected_mach);
    flight.attack = columns.quantity(Quantity::attack);
    flight.sideslip = columns.quantity(Quantity::sideslip);
  }
  return flights;
}

/// Keeps the records of the flights in pictures and shares them with all ranks.
void keep_series(const Analysis& analysis, const std::optional<std::vector<std::size_t>>& requested,
                 std::vector<FlightDiagnosis>& flights) {
  std::vector<std::size_t> kept;
  if (requested) {
    for (std::size_t f = 0; f < flights.size(); ++f) {
      if (std::find(requested->begin(), requested->end(), analysis.flights()[f].file) != requested->end())
        kept.push_back(f);
    }
  } else {
    kept = flights_to_show(analysis.partition().all_gather_flights<FlightToShow>([&](std::size_t f) {
      return FlightToShow{flights[f].samples->time.front(), square_sum_of(flights[f].before).rms()};
    }));
  }
  auto series = analysis.partition().of_entries(kept).all_gather_flights<FlightDiagnosis>(
      [&](std::size_t k) { return std::move(flights[kept[k]]); });
  flights.assign(flights.size(), {});
  for (std::size_t k = 0; k < kept.size(); ++k) flights[kept[k]] = std::move(series[k]);
  for (std::size_t f = 0; f < flights.size(); ++f) {
    flights[f].number = analysis.flights()[f].file;
    flights[f].name = analysis.flights()[f].samples->name;
  }
}

/// Model coefficients of least squares, as a refit has them, with the errors by the noise.
/// @param refitted their change
std::vector<CoefficientEstimate> refitted_coefficients(const Analysis& analysis,
                                                       const std::vector<BaseCoefficient>& base,
                                                       const Eigen::VectorXd& refitted) {
  const Eigen::MatrixXd covariance = analysis.search().fit({}).covariance;
  std::vector<CoefficientEstimate> estimates;
  for (std::size_t b = 0; b < base.size(); ++b) {
    const Eigen::Index k = as_index(b);
    estimates.push_back({base[b].name, base[b].unit, base[b].value + refitted[k],
                         std::sqrt(std::max(0.0, covariance(k, k)))});
  }
  return estimates;
}

double noise_with_findings(const FlightPartition& partition, const std::vector<FlightDiagnosis>& flights) {
  ResidualSums sums;
  for (const ResidualSums& one : partition.all_gather_flights<ResidualSums>([&flights](std::size_t f) {
         const std::vector<double>& after = flights[f].after;
         return sums_of_samples(after, noise_of_flight(*flights[f].samples, after));
       })) {
    if (std::isfinite(one.noise_squares)) sums.add(one);
  }
  return sums.statistics().noise_rms;
}

/// Residual of the input model on a flight.
struct GivenStatistics {
  ResidualSums used{};
  ResidualSums with_flaps{};
  std::vector<double> blocks{};  // means
  std::optional<Statistics> held_out{};
  std::size_t held_out_blocks = 0;

  template <class Archive>
  void serialize(Archive& archive) {
    archive(used, with_flaps, blocks, held_out, held_out_blocks);
  }
};

GivenStatistics statistics_of(const FlightColumns& flight, double share) {
  GivenStatistics found;
  const FlightSamples& samples = *flight.samples;
  const std::vector<std::size_t> first = used_samples(flight.mask, share);
  std::vector<std::size_t> later = used_samples(flight.mask);
  later.erase(later.begin(), later.begin() + static_cast<std::ptrdiff_t>(first.size()));
  const NoiseFloor noise = noise_of_flight(samples, masked(flight.exact, flight.mask, Mask::none));
  const std::vector<double> residual = select_samples(flight.exact, first);
  found.used = sums_of_samples(residual, noise);
  found.blocks = means_of_blocks(samples, residual);
  const std::vector<double> out = masked(flight.exact, flight.mask, Mask::flaps);
  if (has_value(out)) found.with_flaps = sums_of_flight(samples, out);
  if (later.empty()) return found;
  const std::vector<double> held_out = select_samples(flight.exact, later);
  found.held_out = sums_of_flight(samples, held_out, noise).statistics();
  found.held_out_blocks = means_of_blocks(samples, held_out).size();
  return found;
}

/// Residuals of the input model: used samples, later parts of the flights, and samples with flaps extended.
void add_statistics(const PartitionedColumns& columns, double share, Diagnosis& diagnosis) {
  ResidualSums used;
  ResidualSums with_flaps;
  FittedMeans means;
  const auto found = columns.partition.all_gather_flights<GivenStatistics>([&](std::size_t f) {
    const FlightColumns& flight = columns.flights[f];
    return flight.reference == 0 ? statistics_of(flight, share) : GivenStatistics();
  });
  for (std::size_t f = 0; f < found.size(); ++f) {
    if (columns.flights[f].reference != 0) continue;
    used.add(found[f].used);
    means.add(found[f].blocks);
    with_flaps.add(found[f].with_flaps);
  }
  for (std::size_t f = 0; f < found.size(); ++f) {
    if (!found[f].held_out) continue;
    diagnosis.held_out.push_back({columns.flights[f].samples->name, *found[f].held_out,
                                  means.expected_bias(found[f].held_out_blocks)});
  }
  const Statistics statistics = used.statistics();
  diagnosis.samples = statistics.samples;
  diagnosis.rms_given = statistics.rms;
  diagnosis.noise_rms = statistics.noise_rms;
  diagnosis.flaps_out = with_flaps.statistics();
}

/// Samples of all flights by reason of exclusion.
std::array<std::size_t, mask_count> count_masks(const PartitionedColumns& columns) {
  using Counts = std::array<std::size_t, mask_count>;
  Counts all{};
  for (const Counts& part : columns.partition.all_gather_flights<Counts>([&columns](std::size_t f) {
         Counts of_flight{};
         if (columns.flights[f].reference != 0) return of_flight;
         for (const Mask mask : columns.flights[f].mask) ++of_flight[static_cast<std::size_t>(mask)];
         return of_flight;
       })) {
    for (std::size_t m = 0; m < mask_count; ++m) all[m] += part[m];
  }
  return all;
}

Verdict verdict_of(const Diagnosis& diagnosis, double explained, double remaining_chi2) {
  constexpr double notable = 0.03;  // fraction of the explained part
  if (diagnosis.findings.empty())
    return diagnosis.unexplained.significant ? Verdict::unexplained : Verdict::none_detected;
  const Unexplained& unexplained = diagnosis.unexplained;
  if (unexplained.significant && (remaining_chi2 > notable * explained || !unexplained.steps.empty()))
    return Verdict::partial;
  const bool alone =
      std::all_of(diagnosis.findings.begin(), diagnosis.findings.end(),
                  [](const Finding& finding) { return finding.aliases.empty() && finding.rival.empty(); });
  return alone && diagnosis.rival.empty() ? Verdict::identified : Verdict::ambiguous;
}

/// Base coefficients of each added effect of the flow, from the model.
std::vector<Eigen::VectorXd> added_of(const ModelDefinition& model,
                                      const std::vector<BaseCoefficient>& base) {
  const std::vector<std::string> added = added_effects(model);
  std::vector<Eigen::VectorXd> effects;
  for (const ModelEffect& effect : model.model.effects) {
    if (std::find(added.begin(), added.end(), effect.id) == added.end() || !has_uncertain_shape(effect))
      continue;
    Eigen::VectorXd& coefficients = effects.emplace_back(Eigen::VectorXd::Zero(as_index(base.size())));
    for (std::size_t b = 0; b < base.size(); ++b) {
      if (base[b].name.rfind(effect.id + ".", 0) == 0) coefficients[as_index(b)] = base[b].value;
    }
  }
  return effects;
}

/// Prior of the coefficients by GPS alone, as in a refit; none with other references.
Eigen::VectorXd prior_of(const References& references, const std::vector<BaseCoefficient>& base) {
  Eigen::VectorXd precision = Eigen::VectorXd::Zero(as_index(base.size()));
  if (!gps_kind(*references.front())) return precision;
  for (std::size_t b = 0; b < base.size(); ++b) {
    if (base[b].typical > 0.0)
      precision[as_index(b)] = std::pow(gps_prior_in_typical_sizes * base[b].typical, -2.0);
  }
  return precision;
}

/// @param dates on which a step is tried
/// @param found receives the findings of the search, even if a variable of the files overrules them
Diagnosis diagnosis_with(const FlightSet& files, const ModelDefinition& model,
                         const References& all_references, const DiagnoseOptions& options,
                         const std::vector<double>& dates, std::vector<Finding>& found) {
  Diagnosis diagnosis;
  const References references = in_order_of_diagnosis(all_references);
  for (const auto& reference : references)
    diagnosis.reference += (diagnosis.reference.empty() ? "" : "; ") + reference->description();
  CandidateSet set =
      find_candidates(model, options.formulas, files, references, dates, options.trust_reference);
  PartitionedColumns columns = columns_of_flights(files, files.size(), model, set, options, diagnosis.notes);
  diagnosis.masks = count_masks(columns);
  leave_out_empty(columns);
  add_statistics(columns, options.training_share, diagnosis);
  if (diagnosis.samples < diagnosis.masks[0]) {
    diagnosis.notes.push_back(fmt::format("{} samples after the training share of the flights are held out",
                                          diagnosis.masks[0] - diagnosis.samples));
  }
  if (diagnosis.samples < min_samples) {
    throw Error(
        Error::Code::samples,
        fmt::format(
            "{} usable samples, at least {} required: {}; add flights, give another --reference, or relax "
            "--min-airspeed, --max-flaps or --exclude",
            diagnosis.samples, min_samples, mask_text(diagnosis.masks)));
  }
  const FlapsCandidates flaps = find_flaps_candidates(set, columns);
  drop_untestable(set, columns);
  hold_imitated_coefficients(set, columns);
  diagnosis.candidates = static_cast<std::size_t>(
      std::count_if(set.candidates.begin(), set.candidates.end(),
                    [](const Candidate& candidate) { return !candidate.is_variant; }));

  const Analysis analysis(std::move(columns), groups_of(set, set.candidates), added_of(model, set.base),
                          prior_of(references, set.base));
  const std::string disagreement = format_disagreement(analysis.variance_factor());
  if (!disagreement.empty()) diagnosis.notes.push_back(warning_note(disagreement));
  diagnosis.threshold = analysis.result().threshold;
  diagnosis.findings = findings_of(analysis, references, set.candidates);
  found = diagnosis.findings;
  advise(analysis, set.candidates, diagnosis.findings);
  diagnosis.absorbed = absorbed_of(analysis, set.candidates, set.base);
  diagnosis.limits = limits_of(analysis, set.candidates, diagnosis.findings);
  diagnosis.not_testable = std::move(set.not_testable);
  diagnosis.is_refitted = !gps_kind(first_of(references));
  const Eigen::VectorXd base = changes(analysis, {}, diagnosis.is_refitted);
  diagnosis.refitted_coefficients = refitted_coefficients(analysis, set.base, base);
  diagnosis.flights =
      flights_of(analysis, base, changes(analysis, analysis.result().chosen, diagnosis.is_refitted));
  diagnosis.residual_rms = rms_of(
      analysis.partition(), [&](std::size_t f) -> const auto& { return diagnosis.flights[f].before; });
  diagnosis.residual_rms_held_out = analysis.held_out({}).rms;
  diagnosis.noise_rms_with_findings = noise_with_findings(analysis.partition(), diagnosis.flights);
  const double remaining_chi2 =
      add_unexplained(analysis, files, model, set.extended, references, options, diagnosis);
  if (!flaps.candidates.empty())
    diagnose_flaps(analysis, references, flaps, groups_of(set, flaps.candidates), diagnosis);
  keep_series(analysis, options.series_of, diagnosis.flights);
  double explained = 0.0;
  for (const Finding& finding : diagnosis.findings) explained += finding.chi2;
  add_rival_by_size(diagnosis);
  if (diagnosis.is_refitted) warn_by_refit(diagnosis);
  diagnosis.verdict = verdict_of(diagnosis, explained, remaining_chi2);
  judge_held_out(diagnosis);
  std::sort(diagnosis.notes.begin(), diagnosis.notes.end());
  diagnosis.notes.erase(std::unique(diagnosis.notes.begin(), diagnosis.notes.end()), diagnosis.notes.end());
  return diagnosis;
}

/// Every alias counts: probabilities of aliases hold for the exact shapes of the catalogue, and the
/// difference of two systems does not show which of them has the error.
bool may_be_of(bool reference, const Finding& finding) {
  return finding.of_reference == reference ||
         std::any_of(finding.aliases.begin(), finding.aliases.end(), [reference](const Alias& alias) {
           return is_on_other_system(alias.effect) == reference;
         });
}

}  // namespace

std::string_view to_string(Verdict verdict) {
  constexpr std::array<std::string_view, 5> names{"silent", "identified", "cannot be told apart", "partial",
                                                  "unexplained"};
  return names[static_cast<std::size_t>(verdict)];
}

std::string component_text(const EmpiricalPredictor& variable) {
  const bool is_total = variable.location == EffectLocation::pitot;
  std::string text = "the location of the error is unknown";
  if (!variable.components.empty())
    text = fmt::format(
        "the location of the error is one of: {}, since the total pressures of the two systems {} with {}",
        fmt::join(variable.components, ", "), is_total ? "also vary" : "do not vary", variable.name);
  if (!variable.formula.empty())
    text +=
        fmt::format("; the formula is written as added to the {} pressure", is_total ? "total" : "static");
  return text;
}

std::string Finding::id() const { return of_reference ? id_on_other_system(system, effect.id) : effect.id; }

std::string Finding::size_text(const char* unit) const {
  return fmt::format("{:.3f}{}{}{}", largest_rms, unit, largest_reference.empty() ? "" : " by ",
                     largest_reference);
}

bool Finding::may_be_of_model() const { return may_be_of(false, *this); }

bool Finding::may_be_of_reference() const { return may_be_of(true, *this); }

std::vector<std::size_t> Diagnosis::flights_with_records() const {
  std::vector<std::size_t> numbers;
  for (const FlightDiagnosis& flight : flights) {
    if (flight.samples) numbers.push_back(flight.number);
  }
  return numbers;
}

void judge_held_out(Diagnosis& diagnosis) {
  for (HeldOutPart& part : diagnosis.held_out) {
    part.parts = diagnosis.held_out.size();
    if (!part.is_off()) continue;
    const std::string text = part.text();
    Notes& notes = diagnosis.notes;
    if (std::find(notes.begin(), notes.end(), text) == notes.end()) notes.push_back(text);
    if (diagnosis.verdict == Verdict::none_detected) diagnosis.verdict = Verdict::unexplained;
  }
}

Diagnosis diagnose(const FlightSet& flights, const ModelDefinition& model, const References& all_references,
                   const DiagnoseOptions& options) {
  if (flights.empty()) throw Error(Error::Code::usage, "give at least one flight to diagnose");
  flights.require_each_once();
  flights.require_one_aircraft();
  StepDates dates(flights);
  for (;;) {
    std::vector<Finding> found;
    Diagnosis diagnosis = diagnosis_with(flights, model, all_references, options, dates.tried(), found);
    flights.require_unchanged();
    if (!dates.refine(found)) return diagnosis;
  }
}

}  // namespace pcor

#include "diagnose/diagnosis_panels.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include <pcor/base/format_estimate.hpp>
#include <pcor/diagnose/diagnosis_report.hpp>
#include <pcor/effects/catalogue.hpp>
#include <pcor/model/formula.hpp>

#include "campaign/reference_id.hpp"
#include "diagnose/finding_page.hpp"
#include "diagnose/rms.hpp"
#include "report/residual_pictures.hpp"
#include "report/shown_flights.hpp"

namespace pcor::internal::report {
namespace {

constexpr const char* structure_caption =
    "A slope or curvature larger than the error bars indicates a missing effect or slow drift.";
const std::string mach = "mach";
const std::string pressure = "static_pressure";

/// Column of a file variable that is not a quantity of the model.
std::string variable_column(const std::string& variable) { return "variable " + variable; }

/// Column that shows a quantity, or a related quantity.
std::string column_of(Quantity quantity) {
  constexpr std::pair<Quantity, Quantity> stand_ins[]{
      {Quantity::attack_ratio, Quantity::attack},
      {Quantity::attack_differential_pressure, Quantity::attack},
      {Quantity::sideslip_ratio, Quantity::sideslip},
      {Quantity::sideslip_differential_pressure, Quantity::sideslip},
      {Quantity::static_pressure_rate, Quantity::vertical_speed},
      {Quantity::wetness, Quantity::liquid_water},
      {Quantity::dynamic_ratio, Quantity::mach},
      {Quantity::corrected_mach, Quantity::mach},
      {Quantity::port_static_pressure, Quantity::static_pressure},
      {Quantity::corrected_static_pressure, Quantity::static_pressure},
      {Quantity::port_dynamic_pressure, Quantity::dynamic_pressure},
      {Quantity::corrected_dynamic_pressure, Quantity::dynamic_pressure},
      {Quantity::corrected_airspeed, Quantity::true_airspeed},
      {Quantity::lams_airspeed, Quantity::true_airspeed},
  };
  for (const auto& [of, shown] : stand_ins) {
    if (quantity == of) return std::string(info_of(shown).name);
  }
  return std::string(info_of(quantity).name);
}

ReportTable variables_table(const Unexplained& unexplained) {
  ReportTable table{
      "Variables that the unexplained structure varies with",
      "R2: share of the residual's variance that the variable explains, by a smooth curve or by a straight "
      "line, with the most likely drift fitted at the same time. p: probability that the best of all "
      "variables explains as much by a curve if the residuals are shifted in time or have random signs; p "
      "tests the curve, so it can be small although the slope of the line is not significant. No line is "
      "fitted to an angle, or if the model's coefficients imitate the line.",
      {"variable", "R2, curve", "R2, line", "slope of the line", "hPa per", "p", "formula", "similar to",
       "what"}};
  for (const EmpiricalPredictor& variable : unexplained.variables) {
    const bool has_line = variable.slope_error > 0.0;
    table.rows.push_back(
        {variable.name, percent(variable.r2), has_line ? percent(variable.linear_r2) : "",
         has_line ? format_estimate(variable.slope, variable.slope_error, PlusSign::never) : "no line",
         variable.unit, probability(variable.p_value), variable.formula, variable.similar_to,
         variable.description});
  }
  return table;
}

}  // namespace

std::string numbered(const char* name, std::size_t number) { return name + std::to_string(number + 1); }

std::vector<std::string> inputs_of(const ModelEffect& effect) {
  std::vector<std::string> inputs;
  if (effect.is_formula()) {
    if (const auto formula = Formula::parse(effect.formula, effect.parameter_names)) {
      for (const std::string& name : formula->variables()) {
        const Quantity quantity = quantity_named(name);
        inputs.push_back(quantity == Quantity::count ? variable_column(name) : column_of(quantity));
      }
    }
  } else if (const EffectInfo* const info = effect_named(effect.id)) {
    for (std::size_t i = 0; i < info->need_count(); ++i) inputs.push_back(column_of(info->needs[i]));
  }
  std::stable_partition(inputs.begin(), inputs.end(),
                        [](const std::string& name) { return name != pressure; });
  return inputs;
}

std::string refitted_text(const Diagnosis& diagnosis) {
  if (!diagnosis.is_refitted) return "the coefficients as given";
  const bool with_reference =
      std::any_of(diagnosis.refitted_coefficients.begin(), diagnosis.refitted_coefficients.end(),
                  [](const CoefficientEstimate& each) { return is_on_other_system(each.name); });
  return with_reference ? "the coefficients of the model and of the reference system fitted again"
                        : "the model's own coefficients fitted again";
}

std::string cell(double value, int decimals) {
  return std::isfinite(value) ? fmt::format("{:.{}f}", value, decimals) : "";
}

DiagnosisPanels::DiagnosisPanels(const Flights& flights) {
  for (const FlightDiagnosis& flight : flights) {
    if (flight.samples == nullptr) continue;
    std::vector<std::size_t> records;
    for (std::size_t i = 0; i < flight.before.size(); ++i) {
      if (std::isfinite(flight.before[i])) records.push_back(i);
    }
    add_flight(flight.samples, std::move(records));
  }
  add_variables(flights);
}

void DiagnosisPanels::add_finding_columns(const Flights& flights, std::size_t finding, const std::string& id,
                                          std::size_t number) {
  const auto one_of = [finding](std::vector<Series> FlightDiagnosis::*all) {
    return [=](const FlightDiagnosis& flight) {
      return finding < (flight.*all).size() ? (flight.*all)[finding] : Series{};
    };
  };
  add_column(numbered("evidence", number), "evidence for " + id, "1/min", flights,
             one_of(&FlightDiagnosis::evidence));
  add_column(numbered("added", number), "added by " + id, "hPa", flights, one_of(&FlightDiagnosis::added));
}

std::string DiagnosisPanels::binned_caption(const std::vector<std::string>& y) const {
  constexpr double notable = 0.98;
  const ReportColumn* const before = column_named(report().columns, y.front());
  const ReportColumn* const after = column_named(report().columns, y.back());
  if (before == nullptr || after == nullptr || before == after) return structure_caption;
  SquareSum sum_before;
  SquareSum sum_after;
  for (std::size_t i = 0; i < before->values.size(); ++i) {
    if (!std::isfinite(before->values[i]) || !std::isfinite(after->values[i])) continue;
    sum_before.add(before->values[i]);
    sum_after.add(after->values[i]);
  }
  if (!(sum_before.count > 0.0)) return structure_caption;
  return fmt::format("Rms {} hPa before and {} hPa after, with all findings. {}", hpa(sum_before.rms()),
                     hpa(sum_after.rms()),
                     sum_after.squares < notable * notable * sum_before.squares
                         ? "They should remove slopes and curvatures larger than the error bars."
                         : "This picture does not show the evidence; see the pictures of the evidence.");
}

void DiagnosisPanels::add_binned(std::string title, const std::vector<std::string>& y,
                                 const std::vector<std::string>& first) {
  BinnedPanel panel{std::move(title), binned_caption(y), present(report(), y), {}};
  panel.x_choices = choices(panel.columns, first);
  if (panel.x_choices.empty()) return;
  panel.axis = "residual";
  panel.autocorrelation_time = noise_autocorrelation(report(), panel.columns.back());
  add(std::move(panel));
}

std::vector<std::string> DiagnosisPanels::choices(const std::vector<std::string>& y,
                                                  const std::vector<std::string>& first) const {
  std::vector<std::string> all;
  const auto offer = [&](const std::string& x) {
    const bool known = std::find(all.begin(), all.end(), x) != all.end();
    const bool shown = std::any_of(y.begin(), y.end(), [&](const std::string& name) {
      return meet(report().columns, {x, name});
    });
    if (!known && shown) all.push_back(x);
  };
  for (const std::string& x : first) offer(x);
  for (const std::string& x : variables_) offer(x);
  return all;
}

void DiagnosisPanels::add_what_if(const WhatIf& what_if, const std::string& residual,
                                  const std::vector<std::string>& first, double noise,
                                  const std::string& noise_label) {
  if (what_if.panel.effects.empty() || !meet(report().columns, {residual})) return;
  WhatIfPanel panel = what_if.panel;
  for (std::size_t c = 0; c < panel.coefficients.size(); ++c) {
    panel.coefficients[c].column = joined(
        what_if.flights, [c](const WhatIfFlight& flight) -> const auto& { return flight.columns[c]; });
  }
  panel.title = "What if";
  panel.caption =
      "Switch effects on or move a coefficient; the other coefficients are refitted at once (linear "
      "approximation).";
  panel.details =
      "The fit has the weights of pcor refit and equals it if the residual is linear in the coefficients; "
      "otherwise, for example for a lag, it is approximate. Standard errors are by the noise with its drift; "
      "pcor refit adds the misfit of the model and the calibration of the reference. The decrease of chi2 is "
      "in units of the noise with its drift: for one fitted coefficient, the square of its change over its "
      "error. The search gives less weight to slow changes, so its chi2 differs. ";
  const auto model_end =
      panel.coefficients.begin() + static_cast<std::ptrdiff_t>(panel.model_coefficient_count);
  if (std::any_of(panel.coefficients.begin(), model_end,
                  [](const WhatIfCoefficient& each) { return is_on_other_system(each.name); })) {
    panel.caption += " The coefficients of the reference system keep their input values.";
    panel.details +=
        "pcor diagnose and pcor improve fit the coefficients of the reference system, so their chi2 and "
        "held-out rms differ: an effect may explain more with other coefficients of that system. ";
  }
  panel.details +=
      "The numbers use all samples; pictures and tables of a flight of more than 16,000 samples interpolate "
      "derivatives between regular samples.";
  panel.residual = residual;
  panel.x_choices = choices({residual}, first);
  panel.autocorrelation_time = noise_autocorrelation(report(), residual);
  panel.noise = noise;
  panel.noise_label = noise_label;
  add(std::move(panel));
}

void DiagnosisPanels::add_plane(std::string title, std::string caption, const std::string& colour) {
  if (meet(report().columns, {mach, pressure, colour}))
    add(PlanePanel{std::move(title), std::move(caption), mach, pressure, colour});
}

void DiagnosisPanels::add_table(ReportTable table) {
  if (!table.rows.empty()) add(std::move(table));
}

void DiagnosisPanels::add_variables(const Flights& flights) {
  using F = FlightDiagnosis;
  add_variable(mach, "Mach number", "", flights, &F::mach);
  add_variable(pressure, "static pressure", "hPa", flights, &F::static_pressure);
  add_variable("attack", "angle of attack", "deg", flights, &F::attack);
  add_variable("sideslip", "sideslip", "deg", flights, &F::sideslip);
  for (const char* const name : {"vertical_speed", "true_airspeed", "roll", "altitude"}) {
    if (add_motion(name)) variables_.emplace_back(name);
  }
  add_position();
  add_variable("time", "time since the first record", "h", flights, [](const F& f) {
    Series hours;
    for (const double time : f.samples->time) hours.push_back((time - f.samples->time.front()) / 3600.0);
    return hours;
  });
  for (std::size_t i = 0; i < role_count; ++i) {
    const auto quantity = static_cast<Quantity>(i);
    if (column_of(quantity) != info_of(quantity).name) continue;
    const QuantityInfo& info = info_of(quantity);
    add_variable(std::string(info.name), std::string(info.description), std::string(info.unit), flights,
                 [quantity](const F& f) {
                   const Series* values = f.samples->model.find(quantity);
                   return values == nullptr ? Series{} : *values;
                 });
  }
}

void DiagnosisPanels::add_info(const Diagnosis& diagnosis, const ModelDefinition& model,
                               const Info& numbers) {
  Info& info = report().info;
  info.emplace_back("Model", model.model.name);
  info.emplace_back("Reference", diagnosis.reference);
  info.insert(info.end(), numbers.begin(), numbers.end());
  info.emplace_back("Samples", std::to_string(diagnosis.samples));
  std::vector<std::string> excluded;
  for (std::size_t i = 1; i < mask_count; ++i) {
    if (diagnosis.masks[i] > 0)
      excluded.push_back(fmt::format("{} {}", diagnosis.masks[i], mask_info[i].meaning));
  }
  std::string text = format_shown_flights(diagnosis.flights_with_records().size(), diagnosis.flights.size());
  if (!text.empty()) report().summary.push_back(std::move(text));
  if (!excluded.empty()) info.emplace_back("Not used", fmt::format("{}", fmt::join(excluded, "; ")));
  add_flights_to_info();
  info.emplace_back("Program", "pcor " PCOR_VERSION);
  for (const Note& note : diagnosis.notes) info.emplace_back(label_of(note), note.text);
}

void DiagnosisPanels::add_unexplained(const Diagnosis& diagnosis, const std::string& residual) {
  const Unexplained& unexplained = diagnosis.unexplained;
  if (!unexplained.significant) return;
  ReportText page{"Unexplained residual", unexplained_text(unexplained)};
  const std::size_t computed = unexplained.computed.size();
  const std::size_t noisy = unexplained.shares_noise.size();
  if (computed + noisy > 0) {
    page.paragraphs.push_back(fmt::format("Variables not tested: {}.", computed + noisy));
    if (computed > 0)
      page.details = fmt::format("Computed from the sensors of the residual, according to the files: {}. ",
                                 join_list(unexplained.computed));
    if (noisy > 0)
      page.details += fmt::format("With noise of the residual: {}.", join_list(unexplained.shares_noise));
  }
  add(std::move(page));
  if (add_column("drift", "slow drift", "hPa", diagnosis.flights, &FlightDiagnosis::drift))
    add(TimePanel{"Remaining residual and its slow drift",
                  "Drift: slow changes over many minutes.",
                  {residual, "drift"},
                  "residual"});
  add_table(variables_table(unexplained));
  add_against_predictor(diagnosis, residual);
}

void DiagnosisPanels::add_against_predictor(const Diagnosis& diagnosis, const std::string& residual) {
  if (has_predictor_picture_ || diagnosis.unexplained.variables.empty()) return;
  const std::string& variable = diagnosis.unexplained.variables.front().name;
  has_predictor_picture_ = meet(report().columns, {variable_column(variable), residual});
  if (has_predictor_picture_)
    add_binned("Remaining residual against " + variable, {residual}, {variable_column(variable)});
}

void DiagnosisPanels::add_predictor(const Diagnosis& diagnosis) {
  if (diagnosis.unexplained.variables.empty()) return;
  const EmpiricalPredictor& variable = diagnosis.unexplained.variables.front();
  add_variable(variable_column(variable.name), variable.name, variable.unit, diagnosis.flights,
               &FlightDiagnosis::predictor);
}

void DiagnosisPanels::add_residuals(const Diagnosis& diagnosis, const std::vector<std::string>& residuals) {
  add_if_present(report(),
                 TimePanel{"Residual in time",
                           fmt::format("Residual: reference minus model, with {}; regimes are shaded.",
                                       refitted_text(diagnosis)),
                           residuals, "residual"});
  if (report().time.empty()) return;
  add_strip(report());
  add(RegimeTable{
      "By regime",
      fmt::format("Bias and rms of the residual in each regime, with {}.", refitted_text(diagnosis)),
      residuals});
  add_regimes(report(), residuals);
}

void DiagnosisPanels::add_last_panels(const Diagnosis& diagnosis, const std::vector<std::string>& residuals) {
  const std::string residual = residuals.empty() ? "" : residuals.back();
  add_distributions(report(), residuals);
  add_track(report(), "Remaining residual on the map",
            "The track over the ground: one colour over a leg or a heading indicates an error that depends "
            "on place or direction.",
            residual);
  add_unexplained(diagnosis, residual);
  ReportTable limits{
      "Upper limits of effects that were not found",
      "Limits hold with 95 % confidence; the rms is what an effect at its limit would add beyond the model's "
      "coefficients.",
      {"effect", "estimate", "limit", "rms, hPa", "what"},
      {},
      true};
  for (const UpperLimit& limit : diagnosis.limits) {
    limits.rows.push_back({limit.effect, estimates_text(limit.estimates), limits_text(limit),
                           cell(limit.rms, 3),
                           limit.note.empty() ? limit.title : limit.title + ": " + limit.note});
  }
  add_table(std::move(limits));
  ReportTable absorbed{"Effects that the model's own coefficients imitate",
                       "Remaining: part of the effect's variance that the coefficients cannot imitate.",
                       {"effect", "imitated by", "remains", "what"},
                       {}};
  for (const AbsorbedEffect& effect : diagnosis.absorbed)
    absorbed.rows.push_back({effect.effect, join_list(effect.by), percent(effect.remaining), effect.title});
  add_table(std::move(absorbed));
  ReportTable not_testable{"Effects that could not be tested", "", {"effect", "what", "why"}, {}, true};
  for (const NotTestable& effect : diagnosis.not_testable)
    not_testable.rows.push_back({effect.effect, effect.title, effect.reason});
  add_table(std::move(not_testable));
}

}  // namespace pcor::internal::report

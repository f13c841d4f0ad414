#include "pcor/offline/diagnosis_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstddef>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "finding_page.hpp"
#include "pcor/effects/catalogue.hpp"
#include "pcor/offline/error.hpp"
#include "pcor/offline/noise.hpp"
#include "pcor/offline/utc.hpp"
#include "pcor/realtime/formula.hpp"

namespace pcor {
namespace {

using namespace report;

using Flights = std::vector<FlightDiagnosis>;
using Series = std::vector<double>;

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

constexpr std::size_t limits_in_summary = 3;
constexpr std::size_t rivals_in_title = 2;

constexpr const char* structure_caption =
    "A slope or a bend that is more than the error bars is something that the model does not have.";
constexpr const char* effect_caption =
    "Without the effect the residual has a slope or a bend that is more than the error bars; with it none "
    "should be left.";

const std::string mach = "mach";
const std::string pressure = "static_pressure";

std::string numbered(const char* name, std::size_t number) { return name + std::to_string(number + 1); }

/// One of several series of a flight; none where it does not have that many.
Series one_of(const std::vector<Series>& all, std::size_t number) {
  return number < all.size() ? all[number] : Series{};
}

/// The column of a variable of the files that is no quantity of the model.
std::string variable_column(const std::string& variable) { return "variable " + variable; }

/// The column that shows a quantity, its own or that of one that goes with it.
std::string column_of(Quantity quantity) {
  constexpr std::pair<Quantity, Quantity> stand_ins[]{
      {Quantity::attack_ratio, Quantity::attack},
      {Quantity::attack_differential_pressure, Quantity::attack},
      {Quantity::sideslip_ratio, Quantity::sideslip},
      {Quantity::sideslip_differential_pressure, Quantity::sideslip},
      {Quantity::static_pressure_rate, Quantity::vertical_speed},
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
    if (quantity == of) return std::string(facts_of(shown).name);
  }
  return std::string(facts_of(quantity).name);
}

/// What an effect depends on, by the names of columns, the pressure last: most effects grow with it.
std::vector<std::string> inputs_of(const ModelEffect& effect) {
  std::vector<std::string> inputs;
  if (effect.is_formula()) {
    if (const auto formula = Formula::parse(effect.formula, effect.parameter_names)) {
      for (const std::string& name : formula->variables()) {
        const Quantity quantity = quantity_named(name);
        inputs.push_back(quantity == Quantity::count ? variable_column(name) : column_of(quantity));
      }
    }
  } else if (const std::size_t place = effect_named(effect.id); place < catalogue_size) {
    for (std::size_t i = 0; i < effect_facts[place].need_count(); ++i)
      inputs.push_back(column_of(effect_facts[place].needs[i]));
  }
  std::stable_partition(inputs.begin(), inputs.end(),
                        [](const std::string& name) { return name != pressure; });
  return inputs;
}

/// The columns and panels of a report about diagnoses of the same flights. Its samples are those in which the
/// first diagnosis has a residual.
class Builder {
 public:
  explicit Builder(const Flights& flights) {
    for (std::size_t number = 0; number < flights.size(); ++number) {
      const FlightDiagnosis& flight = flights[number];
      if (flight.samples == nullptr) continue;
      Used used{number, flight.samples.get(), {}};
      for (std::size_t i = 0; i < flight.before.size(); ++i) {
        if (std::isfinite(flight.before[i])) used.places.push_back(i);
      }
      if (used.places.empty()) continue;
      report_.flight_starts.push_back(report_.time.size());
      report_.flight_names.push_back(used.samples->name);
      for (const std::size_t i : used.places) report_.time.push_back(used.samples->time[i]);
      for (const Interval& interval : used.samples->intervals) {
        const bool met = std::any_of(used.places.begin(), used.places.end(), [&](std::size_t i) {
          return used.samples->time[i] >= interval.begin && used.samples->time[i] < interval.end;
        });
        if (met)
          report_.intervals.push_back(
              {std::string(facts_of(interval.regime).name), interval.begin, interval.end});
      }
      used_.push_back(std::move(used));
    }
    add_variables(flights);
  }

  Report& report() { return report_; }

  template <class Panel>
  void add(Panel panel) {
    report_.items.emplace_back(std::move(panel));
  }

  /// Adds the column and returns true, if it has any value. @param series of a `FlightDiagnosis`
  template <class Of>
  bool add_column(const std::string& name, const std::string& title, const std::string& unit,
                  const Flights& flights, const Of& series) {
    Series values;
    values.reserve(report_.time.size());
    for (const Used& used : used_) {
      const bool same = used.number < flights.size() && flights[used.number].samples != nullptr &&
                        flights[used.number].samples->time.size() == used.samples->time.size();
      const Series part = same ? series(flights[used.number]) : Series{};
      for (const std::size_t i : used.places) values.push_back(i < part.size() ? part[i] : nan);
    }
    if (std::none_of(values.begin(), values.end(), [](double x) { return std::isfinite(x); })) return false;
    report_.columns.push_back({name, title, unit == "1" ? "" : unit, std::move(values)});
    return true;
  }

  /// As `add_column`, for a variable that residuals are drawn against.
  template <class Of>
  void add_variable(const std::string& name, const std::string& title, const std::string& unit,
                    const Flights& flights, const Of& series) {
    if (column(name) == nullptr && add_column(name, title, unit, flights, series)) variables_.push_back(name);
  }

  /// Whether some sample has a value in all of these columns.
  bool meet(const std::vector<std::string>& names) const {
    std::vector<const Series*> all;
    for (const std::string& name : names) {
      const ReportColumn* one = column(name);
      if (one == nullptr) return false;
      all.push_back(&one->values);
    }
    for (std::size_t i = 0; i < report_.time.size(); ++i) {
      if (std::all_of(all.begin(), all.end(),
                      [i](const Series* values) { return std::isfinite((*values)[i]); }))
        return true;
    }
    return false;
  }

  void add_time(std::string title, std::string caption, std::vector<std::string> columns, std::string axis) {
    if (columns.empty()) return;
    add(TimePanel{std::move(title), std::move(caption), std::move(columns), std::move(axis)});
  }

  /// Residuals against the variables, those of `first` that there are before the others.
  void add_binned(std::string title, std::string caption, std::vector<std::string> y,
                  const std::vector<std::string>& first) {
    BinnedPanel panel;
    y.erase(std::remove_if(y.begin(), y.end(), [&](const std::string& name) { return !meet({name}); }),
            y.end());
    const auto offer = [&](const std::string& x) {
      const bool known =
          std::find(panel.x_choices.begin(), panel.x_choices.end(), x) != panel.x_choices.end();
      const bool shown = std::any_of(y.begin(), y.end(), [&](const std::string& name) {
        return meet({x, name});
      });
      if (!known && shown) panel.x_choices.push_back(x);
    };
    for (const std::string& x : first) offer(x);
    for (const std::string& x : variables_) offer(x);
    if (panel.x_choices.empty()) return;
    panel.title = std::move(title);
    panel.caption = std::move(caption);
    panel.y = std::move(y);
    panel.axis = "residual";
    panel.samples_per_independent = memory_;
    add(std::move(panel));
  }

  void add_plane(std::string title, std::string caption, const std::string& colour) {
    if (meet({mach, pressure, colour}))
      add(PlanePanel{std::move(title), std::move(caption), mach, pressure, colour, true});
  }

  /// Unless it has no rows.
  void add_table(ReportTable table) {
    if (!table.rows.empty()) add(std::move(table));
  }

  /// Takes the memory of the noise, for error bars, from a residual without structure.
  template <class Of>
  void measure_memory(const Flights& flights, const Of& series) {
    double samples = 0.0;
    double independent = 0.0;
    for (const FlightDiagnosis& flight : flights) {
      if (flight.samples == nullptr) continue;
      const Series& values = series(flight);
      if (values.size() != flight.samples->time.size()) continue;
      const double step = flight.samples->step;
      const NoiseFloor noise = noise_floor(values, stretches_of(values, flight.samples->time, step), step);
      const auto count = static_cast<double>(
          std::count_if(values.begin(), values.end(), [](double x) { return std::isfinite(x); }));
      samples += count;
      independent += count / noise.samples_per_independent;
    }
    if (independent > 0.0) memory_ = std::max(1.0, samples / independent);
  }

  void add_flight_facts() {
    for (const Used& used : used_) {
      report_.facts.emplace_back(
          "Flight", fmt::format("{}, {} to {} UTC", used.samples->name, utc_text(used.samples->time.front()),
                                utc_text(used.samples->time.back(), "%H:%M:%S")));
    }
  }

 private:
  /// A flight and the samples of it that the report shows.
  struct Used {
    std::size_t number;
    const FlightSamples* samples;
    std::vector<std::size_t> places;
  };

  const ReportColumn* column(const std::string& name) const {
    const auto found = std::find_if(report_.columns.begin(), report_.columns.end(),
                                    [&](const ReportColumn& one) { return one.name == name; });
    return found == report_.columns.end() ? nullptr : &*found;
  }

  void add_variables(const Flights& flights) {
    using F = FlightDiagnosis;
    add_variable(mach, "Mach number", "", flights, [](const F& f) { return f.mach; });
    add_variable(pressure, "static pressure", "hPa", flights, [](const F& f) { return f.static_pressure; });
    add_variable("attack", "angle of attack", "deg", flights, [](const F& f) { return f.attack; });
    add_variable("sideslip", "sideslip", "deg", flights, [](const F& f) { return f.sideslip; });
    const auto motion = [&](const char* name, const char* title, const char* unit, Series FlightMotion::*of) {
      add_variable(name, title, unit, flights, [of](const F& f) { return f.samples->motion.*of; });
    };
    motion("vertical_speed", "vertical speed", "m/s", &FlightMotion::vertical_speed);
    motion("true_airspeed", "true airspeed", "m/s", &FlightMotion::airspeed);
    motion("roll", "roll", "deg", &FlightMotion::roll);
    add_variable("time", "time since the first record", "h", flights, [](const F& f) {
      Series hours;
      for (const double time : f.samples->time) hours.push_back((time - f.samples->time.front()) / 3600.0);
      return hours;
    });
    for (std::size_t i = 0; i < role_count; ++i) {
      const auto quantity = static_cast<Quantity>(i);
      if (column_of(quantity) != facts_of(quantity).name) continue;
      const QuantityFacts& facts = facts_of(quantity);
      add_variable(std::string(facts.name), std::string(facts.description), std::string(facts.unit), flights,
                   [quantity](const F& f) {
                     const Series* values = f.samples->model.find(quantity);
                     return values == nullptr ? Series{} : *values;
                   });
    }
  }

  Report report_;
  std::vector<Used> used_;
  std::vector<std::string> variables_;
  double memory_ = 1.0;
};

std::string either(const Finding& finding) {
  std::string names = finding.effect.id;
  if (finding.aliases.size() > rivals_in_title) {
    names += fmt::format(" or one of {} others", finding.aliases.size());
  } else {
    for (const Alias& alias : finding.aliases) names += " or " + alias.effect;
  }
  return fmt::format("An effect is missing, {}: these flights cannot tell which", names);
}

std::string what_is_missing(const Diagnosis& diagnosis) {
  std::vector<std::string> ids;
  for (const Finding& finding : diagnosis.findings) ids.push_back(finding.effect.id);
  const std::string effects = ids.size() == 1 ? "An effect is missing: " + diagnosis.findings.front().title
                                              : "Effects are missing: " + list_text(ids);
  switch (diagnosis.verdict) {
    case Verdict::identified:
      return effects;
    case Verdict::ambiguous:
      return ids.size() == 1 ? either(diagnosis.findings.front())
                             : effects + "; these flights cannot tell all of them from others";
    case Verdict::partial:
      return effects + "; structure is left that no effect explains";
    case Verdict::unexplained:
      return "Structure is left that no effect explains";
    case Verdict::silent:
      break;
  }
  return "Nothing is missing that these flights could show";
}

std::string coefficient_limits(const UpperLimit& limit) {
  std::vector<std::string> all;
  for (std::size_t i = 0; i < std::min(limit.estimates.size(), limit.limits.size()); ++i) {
    const Estimate& e = limit.estimates[i];
    if (std::isfinite(limit.limits[i]))
      all.push_back(
          fmt::format("|{}| < {}", e.name, with_unit(fmt::format("{:.2g}", limit.limits[i]), e.unit)));
  }
  return list_text(all);
}

void summarise(Report& report, const Diagnosis& diagnosis) {
  report.summary.push_back(fmt::format(
      "With the model's own coefficients fitted again the residual is {} hPa rms; the noise is {} hPa.",
      hpa(diagnosis.residual_rms), hpa(diagnosis.noise_rms)));
  for (const Finding& finding : diagnosis.findings) report.summary.push_back(finding_summary(finding));
  if (diagnosis.findings.empty()) {
    report.summary.push_back(
        fmt::format("None of the {} effects that were tested exceeds the threshold.", diagnosis.candidates));
  }
  for (std::string& text : unexplained_text(diagnosis.unexplained)) report.summary.push_back(std::move(text));
  std::vector<std::string> limits;
  for (const UpperLimit& limit : diagnosis.limits) {
    if (limits.size() == limits_in_summary) break;
    if (std::string bound = coefficient_limits(limit); !bound.empty())
      limits.push_back(fmt::format("{} {} ({} hPa rms)", limit.effect, bound, hpa(limit.rms)));
  }
  if (!limits.empty()) {
    report.summary.push_back(
        fmt::format("Not found, and with 95 % confidence not above: {}.", list_text(limits)));
  }
  if (!diagnosis.absorbed.empty()) {
    std::vector<std::string> ids;
    for (const AbsorbedEffect& effect : diagnosis.absorbed) ids.push_back(effect.effect);
    report.summary.push_back(
        "These flights cannot show what the model's own coefficients imitate: " + list_text(ids) + ".");
  }
}

using Facts = std::vector<std::pair<std::string, std::string>>;

/// @param numbers what else is said after the model and the reference
void add_facts(Builder& builder, const Diagnosis& diagnosis, const ModelFile& model, const Facts& numbers) {
  Facts& facts = builder.report().facts;
  facts.emplace_back("Model", model.model.name);
  facts.emplace_back("Reference", diagnosis.reference);
  facts.insert(facts.end(), numbers.begin(), numbers.end());
  facts.emplace_back("Samples", std::to_string(diagnosis.samples));
  std::vector<std::string> left_out;
  for (std::size_t i = 1; i < mask_count; ++i) {
    if (diagnosis.masks[i] > 0)
      left_out.push_back(fmt::format("{} {}", diagnosis.masks[i], mask_facts[i].meaning));
  }
  if (!left_out.empty()) facts.emplace_back("Not used", fmt::format("{}", fmt::join(left_out, "; ")));
  builder.add_flight_facts();
  facts.emplace_back("Program", "pcor " PCOR_VERSION);
  for (const std::string& note : diagnosis.notes) facts.emplace_back("Note", note);
}

Facts numbers_of(const Diagnosis& diagnosis) {
  return {{"Noise", hpa(diagnosis.noise_rms) + " hPa rms"},
          {"Residual, coefficients as given", hpa(diagnosis.rms_given) + " hPa rms"},
          {"Residual, refitted", hpa(diagnosis.residual_rms) + " hPa rms"},
          {"Residual, parts not in the fit", hpa(diagnosis.residual_rms_held_out) + " hPa rms"},
          {"Effects tested", std::to_string(diagnosis.candidates)},
          {"Threshold", fmt::format("chi2 {:.1f}", diagnosis.threshold)}};
}

BarPanel ranking_bars(const Diagnosis& diagnosis) {
  BarPanel bars;
  bars.title = "Ranking";
  bars.caption =
      "By how much chi2 falls with each effect that was found, and with each rival (\"or\") in its place.";
  bars.axis = "fall of chi2";
  for (const Finding& finding : diagnosis.findings) {
    bars.bars.push_back({finding.effect.id, finding.chi2});
    for (const Alias& alias : finding.aliases)
      bars.bars.push_back({"or " + alias.effect, finding.chi2 - alias.chi2_less});
  }
  bars.bars.push_back({"threshold", diagnosis.threshold});
  return bars;
}

/// Empty for what is no number.
std::string cell(double value, int decimals) {
  return std::isfinite(value) ? fmt::format("{:.{}f}", value, decimals) : "";
}

/// Empty where the usual size is not known.
std::string ratio_cell(double ratio) { return ratio == 0.0 ? "" : ratio_text(ratio); }

ReportTable ranking_table(const Diagnosis& diagnosis) {
  ReportTable table;
  table.title = "Findings and their rivals";
  table.caption =
      "A rival (\"or\") explains the flights as well as the effect above it. The correlation is that of what "
      "the two leave after the model's own coefficients; the size is that of the coefficient over its usual "
      "size.";
  table.headers = {"",    "effect", "coefficients", "rms, hPa", "fall of chi2", "correlation", "size / usual",
                   "what"};
  for (std::size_t i = 0; i < diagnosis.findings.size(); ++i) {
    const Finding& finding = diagnosis.findings[i];
    table.rows.push_back({std::to_string(i + 1), finding.effect.id, estimates_text(finding.estimates),
                          cell(finding.rms, 3), cell(finding.chi2, 1), "",
                          ratio_cell(size_to_usual(finding.estimates)), finding.title});
    for (const Alias& alias : finding.aliases) {
      table.rows.push_back(
          {"or", alias.effect, estimates_text(alias.estimates), "", cell(finding.chi2 - alias.chi2_less, 1),
           fmt::format("{:+.3f}", alias.correlation), ratio_cell(alias.size_to_usual), alias.title});
    }
  }
  return table;
}

ReportTable evidence_table(const std::vector<Finding>& findings) {
  ReportTable table;
  table.title = "Where the evidence lies";
  table.caption = "The stretches that speak most for each effect.";
  table.headers = {"effect", "flight", "begin (UTC)", "end", "share", "regimes"};
  for (const Finding& finding : findings) {
    for (const Evidence& evidence : finding.evidence) {
      table.rows.push_back({finding.effect.id, evidence.flight, utc_text(evidence.begin),
                            utc_text(evidence.end, "%H:%M:%S"), percent(evidence.share), evidence.regimes});
    }
  }
  return table;
}

ReportTable variables_table(const Unexplained& unexplained) {
  ReportTable table;
  table.title = "Variables that the unexplained structure goes with";
  table.caption =
      "Share of the residual's variance that goes with the variable in any way and along a straight line; p "
      "is protected against chance over all variables.";
  table.headers = {"variable", "share", "on a line", "slope", "hPa per", "p", "formula", "what"};
  for (const TracedVariable& variable : unexplained.variables) {
    table.rows.push_back({variable.name, percent(variable.r2), percent(variable.linear_r2),
                          with_error(variable.slope, variable.slope_error), variable.unit,
                          probability(variable.p_value), variable.formula, variable.description});
  }
  return table;
}

void add_tables(Builder& builder, const Diagnosis& diagnosis) {
  ReportTable limits;
  limits.title = "How large what was not found may be";
  limits.caption =
      "Limits hold with 95 % confidence; the rms is what an effect at its limit would add beyond the model's "
      "coefficients.";
  limits.headers = {"effect", "estimate", "limit", "rms, hPa", "what"};
  for (const UpperLimit& limit : diagnosis.limits) {
    limits.rows.push_back({limit.effect, estimates_text(limit.estimates), coefficient_limits(limit),
                           cell(limit.rms, 3),
                           limit.note.empty() ? limit.title : limit.title + ": " + limit.note});
  }
  builder.add_table(std::move(limits));
  ReportTable absorbed;
  absorbed.title = "Effects that the model's own coefficients imitate";
  absorbed.caption = "What remains is the part of the effect's variance that the coefficients leave.";
  absorbed.headers = {"effect", "imitated by", "remains", "what"};
  for (const AbsorbedEffect& effect : diagnosis.absorbed) {
    absorbed.rows.push_back({effect.effect, list_text(effect.by), percent(effect.remaining), effect.title});
  }
  builder.add_table(std::move(absorbed));
  ReportTable not_testable;
  not_testable.title = "Effects that could not be tested";
  not_testable.headers = {"effect", "what", "why"};
  for (const NotTestable& effect : diagnosis.not_testable)
    not_testable.rows.push_back({effect.effect, effect.title, effect.reason});
  builder.add_table(std::move(not_testable));
}

/// The pictures of what a diagnosis found, and a page for each finding.
void add_findings(Builder& builder, const Diagnosis& diagnosis, const std::vector<std::string>& residuals) {
  using F = FlightDiagnosis;
  const std::vector<Finding>& findings = diagnosis.findings;
  std::vector<std::string> evidence;
  std::vector<std::string> added;
  for (std::size_t i = 0; i < findings.size(); ++i) {
    const std::string& id = findings[i].effect.id;
    if (std::string name = numbered("evidence", i);
        builder.add_column(name, "evidence for " + id, "1/min", diagnosis.flights,
                           [i](const F& f) { return one_of(f.evidence, i); }))
      evidence.push_back(std::move(name));
    if (std::string name = numbered("added", i); builder.add_column(
            name, "added by " + id, "hPa", diagnosis.flights, [i](const F& f) { return one_of(f.added, i); }))
      added.push_back(std::move(name));
  }
  builder.add_time("What the missing effects add", "To the residual, with the estimated coefficients.", added,
                   "added");
  builder.add_time("Evidence in time", "Fall of chi2 per minute around each sample.", evidence,
                   "fall of chi2");
  builder.add(ranking_bars(diagnosis));
  builder.add_plane("What is left, over Mach number and pressure",
                    "Residual with all findings: one colour over a region is a bias there.",
                    residuals.back());
  builder.add(ranking_table(diagnosis));
  builder.add_table(evidence_table(findings));
  for (std::size_t i = 0; i < findings.size(); ++i) {
    const std::string& id = findings[i].effect.id;
    builder.add(
        finding_page(findings[i], diagnosis.threshold,
                     findings.size() == 1 ? "The finding: " + id : fmt::format("Finding {}: {}", i + 1, id)));
    std::vector<std::string> inputs = inputs_of(findings[i].effect);
    inputs.push_back(numbered("added", i));
    builder.add_binned("Residual before and after, against what " + id + " depends on", effect_caption,
                       residuals, inputs);
    builder.add_plane("Evidence for " + id + ", over Mach number and pressure",
                      "Orange speaks for the effect, blue against it.", numbered("evidence", i));
  }
}

void add_unexplained(Builder& builder, const Diagnosis& diagnosis, const std::string& left) {
  const Unexplained& unexplained = diagnosis.unexplained;
  if (!unexplained.significant) return;
  builder.add(ReportText{"What no effect explains", unexplained_text(unexplained)});
  if (builder.add_column("drift", "slow drift", "hPa", diagnosis.flights,
                         [](const FlightDiagnosis& f) { return f.drift; }))
    builder.add_time("Residual that is left, and its slow drift",
                     "The drift is what wanders slowly, over many minutes.", {left, "drift"}, "residual");
  builder.add_table(variables_table(unexplained));
  if (unexplained.variables.empty()) return;
  const std::string& variable = unexplained.variables.front().name;
  if (builder.meet({variable_column(variable), left}))
    builder.add_binned("What is left, against " + variable, structure_caption, {left},
                       {variable_column(variable)});
}

/// The variable that most of the unexplained structure goes with, where there is one.
void add_traced(Builder& builder, const Diagnosis& diagnosis) {
  if (diagnosis.unexplained.variables.empty()) return;
  const TracedVariable& variable = diagnosis.unexplained.variables.front();
  builder.add_variable(variable_column(variable.name), variable.name, variable.unit, diagnosis.flights,
                       [](const FlightDiagnosis& f) { return f.traced; });
}

void add_residual_panels(Builder& builder, const std::vector<std::string>& residuals) {
  if (builder.report().time.empty()) return;
  builder.add_time("Residual in time",
                   "Static pressure of the reference less that of the model; regimes are shaded. Drag over a "
                   "time range, or choose a regime, and every picture shows its samples alone.",
                   residuals, "residual");
  builder.add(RegimeTable{"By regime", "Bias and rms of the residual in each regime of the selected samples.",
                          residuals});
}

std::string rung_name(const ImproveStep& step) {
  return step.added.empty() ? "as it was" : "+ " + step.added;
}

BarPanel ladder_bars(const Improvement& improvement) {
  BarPanel bars;
  bars.title = "The ladder";
  bars.caption =
      improvement.holdout_is_flights
          ? "Rms residual on what was held out, after each effect that was added."
          : "Rms residual on stretches that took no part in the fit, five parts in turn, after each "
            "effect that was added.";
  bars.axis = "rms";
  bars.unit = "hPa";
  for (const ImproveStep& step : improvement.steps) bars.bars.push_back({rung_name(step), step.rms_holdout});
  bars.bars.push_back({"noise", improvement.steps.back().noise_rms});
  return bars;
}

ReportTable ladder_table(const Improvement& improvement) {
  ReportTable table;
  table.title = "Rung by rung";
  table.headers = {"model",
                   "free coefficients",
                   "rms in the fit, hPa",
                   improvement.holdout_is_flights ? "rms held out, hPa" : "rms not in the fit, hPa",
                   "noise, hPa",
                   "not told from",
                   "what it taught"};
  for (const ImproveStep& step : improvement.steps) {
    table.rows.push_back({rung_name(step), std::to_string(step.terms), cell(step.rms_train, 3),
                          cell(step.rms_holdout, 3), cell(step.noise_rms, 3), list_text(step.aliases),
                          sentence(step.learnt)});
  }
  return table;
}

void summarise(Report& report, const Improvement& improvement) {
  const ImproveStep& first = improvement.steps.front();
  const ImproveStep& last = improvement.steps.back();
  report.summary.push_back(fmt::format(
      "On {} the rms residual goes from {} to {} hPa; the noise is {} hPa.",
      improvement.holdout_is_flights ? "what was held out" : "stretches that took no part in the fit",
      hpa(first.rms_holdout), hpa(last.rms_holdout), hpa(last.noise_rms)));
  for (const ImproveStep& step : improvement.steps) {
    if (step.added.empty()) continue;
    std::string text = fmt::format("Added: {}; the rms residual goes to {} hPa.",
                                   name_with_id(step.title, step.added), hpa(step.rms_holdout));
    if (!step.aliases.empty())
      text += fmt::format(" These flights cannot tell it from {}.", list_text(step.aliases));
    report.summary.push_back(std::move(text));
  }
  if (!improvement.why_stopped.empty()) report.summary.push_back(sentence(improvement.why_stopped));
  std::string verdict = what_is_missing(last.diagnosis);
  verdict.front() = static_cast<char>(std::tolower(static_cast<unsigned char>(verdict.front())));
  report.summary.push_back("At the top of the ladder: " + verdict + ".");
  for (const Finding& finding : last.diagnosis.findings) report.summary.push_back(finding_summary(finding));
  for (std::string& text : unexplained_text(last.diagnosis.unexplained))
    report.summary.push_back(std::move(text));
}

/// The coefficients of an effect after the fit.
std::vector<Estimate> fitted_of(const RefitResult& fit, const std::string& effect) {
  std::vector<Estimate> estimates;
  for (const FittedParameter& p : fit.parameters) {
    if (p.name.rfind(effect + ".", 0) == 0)
      estimates.push_back({p.name.substr(effect.size() + 1), p.unit, p.value, p.standard_error});
  }
  return estimates;
}

/// The page of the effect that a rung added, and its pictures.
void add_rung(Builder& builder, const Improvement& improvement, std::size_t rung) {
  using F = FlightDiagnosis;
  const ImproveStep& step = improvement.steps[rung];
  const Diagnosis& before = improvement.steps[rung - 1].diagnosis;
  const std::string heading = fmt::format("Rung {}: {}", rung, step.added);
  const std::string evidence = numbered("evidence", rung);
  const std::string added = numbered("added", rung);
  std::vector<std::string> inputs;
  for (const ModelEffect& effect : improvement.model.model.effects) {
    if (effect.id == step.added) inputs = inputs_of(effect);
  }
  inputs.push_back(added);
  const auto finding = std::find_if(before.findings.begin(), before.findings.end(),
                                    [&](const Finding& one) { return one.effect.id == step.added; });
  ReportText page{heading, unexplained_text(before.unexplained)};
  page.paragraphs.insert(page.paragraphs.begin(), "Added: " + name_with_id(step.title, step.added) + ".");
  if (finding != before.findings.end()) {
    page = finding_page(*finding, before.threshold, heading);
    const auto number = static_cast<std::size_t>(finding - before.findings.begin());
    builder.add_column(evidence, "evidence for " + step.added, "1/min", before.flights,
                       [number](const F& f) { return one_of(f.evidence, number); });
    builder.add_column(added, "added by " + step.added, "hPa", before.flights,
                       [number](const F& f) { return one_of(f.added, number); });
  }
  if (const std::vector<Estimate> fitted = fitted_of(improvement.fit, step.added); !fitted.empty())
    page.paragraphs.push_back(fmt::format("In the best model {}.", estimates_text(fitted)));
  builder.add(std::move(page));
  builder.add_binned("Residual without and with " + step.added + ", against what it depends on",
                     effect_caption, {numbered("rung", rung - 1), numbered("rung", rung)}, inputs);
  builder.add_plane("Evidence for " + step.added + ", over Mach number and pressure",
                    "Orange speaks for the effect, blue against it.", evidence);
}

}  // namespace

Report diagnosis_report(const Diagnosis& diagnosis, const ModelFile& model) {
  using F = FlightDiagnosis;
  Builder builder(diagnosis.flights);
  Report& report = builder.report();
  report.title = what_is_missing(diagnosis);
  report.subtitle = fmt::format("Diagnosis of {} against {}", model.model.name, diagnosis.reference);
  summarise(report, diagnosis);
  add_facts(builder, diagnosis, model, numbers_of(diagnosis));

  const bool found = !diagnosis.findings.empty();
  add_traced(builder, diagnosis);
  std::vector<std::string> residuals{"before"};
  builder.add_column("before", found ? "residual before" : "residual", "hPa", diagnosis.flights,
                     [](const F& f) { return f.before; });
  if (found && builder.add_column("after", "residual after, with all findings", "hPa", diagnosis.flights,
                                  [](const F& f) { return f.after; }))
    residuals.emplace_back("after");
  builder.measure_memory(diagnosis.flights,
                         [&](const F& f) -> const Series& { return found ? f.after : f.before; });
  add_residual_panels(builder, residuals);
  if (found) {
    add_findings(builder, diagnosis, residuals);
  } else {
    builder.add_binned("Residual against a variable", structure_caption, residuals, {});
    builder.add_plane("Residual over Mach number and pressure", "One colour over a region is a bias there.",
                      "before");
  }
  add_unexplained(builder, diagnosis, residuals.back());
  add_tables(builder, diagnosis);
  return std::move(report);
}

Report improvement_report(const Improvement& improvement, const ModelFile& start) {
  if (improvement.steps.empty()) throw Error("report: the ladder has no rung; improve a model first");
  const std::vector<ImproveStep>& steps = improvement.steps;
  const Diagnosis& top = steps.back().diagnosis;
  Builder builder(steps.front().diagnosis.flights);
  Report& report = builder.report();
  const std::size_t added = steps.size() - 1;
  report.title = added == 0   ? "No effect makes the model better"
                 : added == 1 ? "One effect makes the model better: " + steps.back().title
                              : fmt::format("{} effects make the model better", added);
  report.subtitle = fmt::format("Improvement of {} against {}", start.model.name, top.reference);
  summarise(report, improvement);
  add_facts(builder, top, start, {});

  std::vector<std::string> rungs;
  for (std::size_t i = 0; i < steps.size(); ++i) {
    add_traced(builder, steps[i].diagnosis);
    std::string name = numbered("rung", i);
    if (builder.add_column(name, "residual, " + rung_name(steps[i]), "hPa", steps[i].diagnosis.flights,
                           [](const FlightDiagnosis& f) { return f.before; }))
      rungs.push_back(std::move(name));
  }
  builder.measure_memory(top.flights, [](const FlightDiagnosis& f) -> const Series& { return f.before; });
  builder.add(ladder_bars(improvement));
  if (!rungs.empty())
    builder.add_plane("What is left, over Mach number and pressure",
                      "Residual at the top of the ladder: one colour over a region is a bias there.",
                      rungs.back());
  builder.add_table(ladder_table(improvement));
  add_residual_panels(builder, rungs.size() < 2 ? rungs : std::vector{rungs.front(), rungs.back()});
  for (std::size_t i = 1; i < steps.size(); ++i) add_rung(builder, improvement, i);
  if (!rungs.empty()) add_unexplained(builder, top, rungs.back());
  add_tables(builder, top);
  return std::move(report);
}

}  // namespace pcor

#include <pcor/inspect/inspect.hpp>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include <pcor/base/atomic_file.hpp>
#include <pcor/base/error.hpp>
#include <pcor/base/message.hpp>
#include <pcor/base/utc.hpp>
#include "command.hpp"
#include "comparison.hpp"
#include "model_name.hpp"
#include "report_origin.hpp"

namespace pcor::tool {
namespace {

struct InspectArguments {
  CommonOptions common;
  std::vector<std::string> flights;
  std::string model;
  std::string roles;
  TimestampAlignment timestamp_alignment = TimestampAlignment::begin;
};

/// Command of this program for the flight.
std::string command(const std::string& name, const Inspection& flight, const std::string& options) {
  return fmt::format("{} {} {}{}", program(), name, shell_path(flight.path), options);
}

/// Reference for a published law: the laser if the law names it, otherwise a second static system that has a
/// published law, otherwise the last of the flight's references; empty if the flight has no reference.
std::string reference_for(const Inspection& flight, const ModelCandidate& law) {
  std::vector<std::string> references = flight.references;
  const auto laser = std::find(references.begin(), references.end(), "lams");
  if (laser != references.end()) {
    if (law.model.variables.count(Quantity::lams_airspeed) > 0) return "lams";
    references.erase(laser);
  }
  const auto pressure_of = [](const ModelCandidate& each) {
    return each.model.variables.at(Quantity::static_pressure);
  };
  const auto other = std::find_if(flight.laws.begin(), flight.laws.end(), [&](const ModelCandidate& each) {
    return each.fits() && pressure_of(each) != pressure_of(law);
  });
  if (other != flight.laws.end()) return "static:" + other->path.stem().string();
  return references.empty() ? "" : references.back();
}

/// The published model for the flight, unless the user writes one; nullptr without such a model.
const ModelCandidate* law_of_next(const InspectArguments& options, const Inspection& flight) {
  const auto fits = std::find_if(flight.laws.begin(), flight.laws.end(),
                                 [](const ModelCandidate& law) { return law.fits(); });
  return options.model.empty() && fits != flight.laws.end() ? &*fits : nullptr;
}

/// Step by which the published model reads the laser of the flight; empty without a laser, or if it does
/// already.
std::string use_of_laser(const InspectArguments& options, const Inspection& flight) {
  const ModelCandidate* const law = law_of_next(options, flight);
  const bool has_laser =
      std::find(flight.references.begin(), flight.references.end(), "lams") != flight.references.end();
  if (law == nullptr || !has_laser || law->model.variables.count(Quantity::lams_airspeed) != 0) return "";
  const Model& model = law->model.model;
  std::vector<std::string> roles;
  const auto add = [&](Quantity role, bool is_computed) {
    if (!is_computed && law->model.variables.count(role) == 0 && flight.model->variables.count(role) != 0)
      roles.push_back(fmt::format("{} = \"{}\"", info_of(role).name, flight.model->variables.at(role)));
  };
  add(Quantity::lams_airspeed, false);
  add(Quantity::attack, model.attack_radome.is_calibrated());
  add(Quantity::sideslip, model.sideslip_radome.is_calibrated());
  return fmt::format(
      "To compare it with the laser (--reference lams), add to the [variables] of a copy of {}: {}",
      shell_path(law->path.string()), fmt::join(roles, ", "));
}

/// Up to three commands to paste, in order, that test a model and, if a published model or a reference gives
/// the level of delta-p, produce a corrected flight with a report.
std::vector<std::string> next_commands(const InspectArguments& options, const Inspection& flight) {
  const std::string stamp =
      options.timestamp_alignment == TimestampAlignment::begin ? "" : " --time-stamp middle";
  const auto process = [&](const ModelDefinition& model, const std::string& path) {
    return process_command({flight.path}, model, path, options.timestamp_alignment) +
           " --report corrected.html";
  };
  std::string reference;
  for (const std::string& each : flight.references) reference += " --reference " + shell_quote(each);
  if (!flight.model) return {};
  if (const ModelCandidate* const fits = law_of_next(options, flight)) {
    const std::string name = fits->path.stem().string();
    const std::string law = " -m " + shell_path(name);
    const std::string best = reference_for(flight, *fits);
    const std::string against = best.empty() ? "" : " --reference " + shell_quote(best);
    const bool is_system = best.rfind("static:", 0) == 0;
    std::vector<std::string> commands{
        command("check", flight, law + stamp + (is_system ? against : "") + " --report check.html"),
        process(fits->model, name)};
    if (!best.empty())
      commands.insert(commands.begin(),
                      command("compare", flight, law + stamp + against + " --report compare.html"));
    return commands;
  }
  std::vector<std::string> commands;
  const std::string file = options.model.empty() ? "model.toml" : options.model;
  const std::string model = " -m " + shell_path(file);
  if (options.model.empty()) {
    const std::string roles = options.roles.empty() ? "" : " --roles " + shell_quote(options.roles);
    commands.push_back(command("inspect", flight, roles + stamp + " --write-model model.toml"));
  }
  // Without a reference for the level, a model keeps its coefficients of zero, and a corrected pair its
  // error.
  const bool determines_level = flight.by_gps && flight.by_gps->determines_level();
  if (reference.empty() || (flight.is_corrected && !determines_level)) {
    commands.push_back(command("check", flight, model + stamp + " --report check.html"));
  } else {
    const std::string fitted = output_file("fitted.toml", {file});
    commands.push_back(
        command("refit", flight, model + stamp + reference + " -o " + fitted + " --report refit.html"));
    commands.push_back(process(*flight.model, fitted));
  }
  return commands;
}

/// JSON result of the command.
struct Inspections {
  std::vector<Inspection> flights{};
};

template <class Field>
void describe(const Inspections& self, Field& field) {
  field("flights", self.flights, "content of each flight");
}

void print_head(const Inspection& flight) {
  std::vector<std::string> who;
  for (const std::string& part : {flight.project, flight.flight, flight.aircraft, flight.institution}) {
    if (!part.empty()) who.push_back(part);
  }
  print_formatted(
      "{}: {}\n", flight.path,
      who.empty() ? "unknown aircraft: the file does not name it" : fmt::format("{}", fmt::join(who, ", ")));
  print_formatted("{} to {} UTC, {} records of {:g} s, {} gap{} in time\n", utc_text(flight.time.first),
                  utc_text(flight.time.last), flight.records, flight.time.step, flight.time.gap_count,
                  flight.time.gap_count == 1 ? "" : "s");
  std::vector<std::string> rates;
  for (const auto& [rate, count] : flight.rates)
    rates.push_back(fmt::format("{} of {} Hz", count, rate / flight.time.step));
  print_formatted("variables: {}\n", fmt::join(rates, ", "));
  if (flight.matching_namings.empty()) {
    print_formatted("naming convention: unknown; names of {} ({}) are tried\n", flight.naming,
                    flight.naming_title);
  } else if (flight.matching_namings.size() > 1) {
    print_formatted(
        "naming convention: files of {} match; names of {} are used; set the right one in the model by "
        "roles\n",
        fmt::join(flight.matching_namings, " and of "), flight.naming);
  } else {
    print_formatted("naming convention: {} ({})\n", flight.naming_title, flight.naming);
  }
}

void print_roles(const Inspection& flight) {
  print_formatted("\n{:<33} {:<12} {:<10} {:>4} {:>8}  {}\n", "role", "variable", "unit", "Hz", "present",
                  "alternatives");
  for (const InspectedRole& role : flight.roles) {
    print_formatted("{:<33} {:<12} {:<10} {:>4g} {:>7.1f}%  {}\n", role.role,
                    role.variable + (role.is_verified ? "" : " ?"), role.unit, role.rate / flight.time.step,
                    100.0 * role.present, fmt::join(role.others, " "));
  }
  const bool doubt = std::any_of(flight.roles.begin(), flight.roles.end(),
                                 [](const InspectedRole& role) { return !role.is_verified; });
  if (doubt)
    print_formatted("?: the meaning of the name on this aircraft is not documented publicly; verify it\n");
  for (const InspectedRole& role : flight.roles) {
    if (!role.caveat.empty()) print_formatted("{}: {}\n", role.variable, role.caveat);
  }
}

/// Variables that may serve a role, whether it has a variable or not.
void print_candidates(const Inspection& flight) {
  std::set<std::string> missing;  // a value that is computed, such as mach, is not missing
  for (const MissingRole& role : flight.missing) missing.insert(role.role);
  for (const InspectedRole& role : flight.roles) {
    if (!role.why.empty())
      print_formatted(
          "{} is {}: {}{}\n", role.variable, role.role, role.why,
          role.others.empty() ? "" : fmt::format("; alternatives: {}", fmt::join(role.others, ", ")));
  }
  bool any = false;
  for (const auto& [role, candidates] : flight.candidates) {
    for (const RoleCandidate& each : candidates) {
      if (missing.count(role) == 0) continue;
      if (!any)
        print_formatted("\n{:<33} {:<12} {:>5}  evidence\n", "candidates, not used", "variable", "score");
      any = true;
      print_formatted("{:<33} {:<12} {:>5.2f}  {}\n", role, each.variable, each.score, each.why);
    }
  }
  if (any) print_formatted("set the right one in the [variables] of the model\n");
  if (!flight.not_used.empty()) print_formatted("\nnot used: {}\n", fmt::join(flight.not_used, ", "));
}

void print(const Problem& problem) {
  const std::string unit = problem.unit == "1" ? "" : " " + problem.unit;
  print_formatted("  {}: {}, {:.4g}{}, {} UTC; {}\n", problem.variable, problem.kind, problem.number, unit,
                  problem.times, problem.action);
}

void print_missing(const Inspection& flight) {
  bool any = false;
  for (const MissingRole& role : flight.missing) {
    if (role.cost.empty() && role.effects.empty()) continue;
    if (!any) print_formatted("\n{:<33} consequence\n", "missing");
    any = true;
    print_formatted("{:<33} {}{}{}\n", role.role, role.cost,
                    role.cost.empty() || role.effects.empty() ? "" : "; ",
                    role.effects.empty() ? "" : fmt::format("no effects {}", fmt::join(role.effects, ", ")));
  }
}

void print_flown(const Inspection& flight) {
  std::map<Regime, std::pair<int, double>> flown;
  for (const Interval& interval : flight.intervals) {
    auto& [count, time] = flown[interval.regime];
    ++count;
    time += interval.end - interval.begin;
  }
  if (!flown.empty()) print_formatted("\n{:<18} {:>5} {:>8}\n", "flown", "times", "minutes");
  for (const auto& [regime, sum] : flown)
    print_formatted("{:<18} {:>5} {:>8.1f}\n", info_of(regime).name, sum.first, sum.second / 60.0);
  for (const FrozenSpan& span : flight.frozen) {
    const std::vector<double>& time = flight.samples->time;
    print_formatted("{} is frozen from {} to {}\n", info_of(span.quantity).name,
                    utc_text(time[span.first], "%H:%M:%S"),
                    utc_text(time[span.first + span.count - 1], "%H:%M:%S"));
  }
}

void print_by_gps(const GpsDesign& gps) {
  const auto text = [](double error, const char* manoeuvre) {
    return error < max_defect_error ? fmt::format("+-{:.2f} hPa", std::max(error, 0.01))
                                    : fmt::format("undetermined (requires {})", manoeuvre);
  };
  print_formatted(
      "delta-p by GPS ({}), standard errors expected in a usual atmosphere (refit states those of the "
      "flight): level {}, change with airspeed {}{}\n",
      gps.by_wind && gps.by_height ? "wind and height"
      : gps.by_wind                ? "wind"
                                   : "height",
      text(gps.level, gps.by_wind ? "circles or reverse headings"
                                  : "a recorded ground velocity, and circles or reverse headings"),
      text(gps.slope, "a speed run"),
      std::isnan(gps.attack) ? "" : ", change with attack " + text(gps.attack, "a pitch manoeuvre"));
}

/// Whether another assigned role excludes this one from a model.
bool is_replaced(Quantity role, const std::vector<InspectedRole>& assigned) {
  constexpr std::pair<Quantity, Quantity> alternatives[]{
      {Quantity::ambient_temperature, Quantity::recovery_temperature},
      {Quantity::vapor_pressure, Quantity::dew_point}};
  return std::any_of(std::begin(alternatives), std::end(alternatives), [&](const auto& pair) {
    if (role != pair.first && role != pair.second) return false;
    const std::string_view other = info_of(role == pair.first ? pair.second : pair.first).name;
    return std::any_of(assigned.begin(), assigned.end(),
                       [other](const InspectedRole& each) { return each.role == other; });
  });
}

/// Pressures, numbers of roles and models, problems and missing inputs.
void print_short(const Inspection& flight) {
  constexpr std::size_t max_rows = 3;
  std::vector<std::string> pressures;
  for (const InspectedRole& role : flight.roles) {
    if (role.role == "static_pressure" || role.role == "dynamic_pressure")
      pressures.push_back(role.others.empty() ? fmt::format("{} {}", role.role, role.variable)
                                              : fmt::format("{} {} (or {})", role.role, role.variable,
                                                            fmt::join(role.others, " ")));
  }
  if (!pressures.empty()) print_formatted("{}\n", fmt::join(pressures, ", "));
  std::vector<std::string> missing, series;
  for (const MissingRole& role : flight.missing) {
    const Quantity quantity = quantity_named(role.role);
    if (quantity == Quantity::count || !is_role(quantity))
      series.push_back(role.role);
    else if (!is_replaced(quantity, flight.roles))
      missing.push_back(role.role);
  }
  print_formatted(
      "{} roles assigned; missing: {}{}\n", flight.roles.size(),
      missing.empty() ? "no role" : fmt::format("{}", fmt::join(missing, ", ")),
      series.empty() ? "" : fmt::format("; missing series that no model reads: {}", fmt::join(series, ", ")));
  std::size_t shown = 0;
  for (std::size_t i = 0; i < flight.problems.size() && shown < max_rows; ++i) {
    const Problem& problem = flight.problems[i];
    const auto is_like = [&problem](const Problem& other) {
      return other.variable == problem.variable && other.kind == problem.kind;
    };
    const auto here = flight.problems.begin() + static_cast<std::ptrdiff_t>(i);
    if (std::any_of(flight.problems.begin(), here, is_like)) continue;
    print(problem);
    ++shown;
  }
  if (flight.problems.size() > shown)
    print_formatted("{} more problems: add --verbose\n", flight.problems.size() - shown);
  const std::string models = applicable_text(flight.laws);
  print_formatted("models for this flight: {}\n", models.empty() ? "no published one" : models);
  if (models.empty() && flight.by_gps && !flight.by_gps->determines_level()) print_by_gps(*flight.by_gps);
}

std::string validity_of(const LawInfo& law) {
  if (law.valid_from.empty() && law.valid_to.empty()) return "dates of validity not stated";
  if (law.valid_from.empty()) return fmt::format("valid until {}, beginning not stated", law.valid_to);
  if (law.valid_to.empty()) return fmt::format("valid from {}", law.valid_from);
  return fmt::format("valid from {} to {}", law.valid_from, law.valid_to);
}

void print_in_full(const Inspection& flight) {
  print_roles(flight);
  print_candidates(flight);
  print_missing(flight);
  if (!flight.problems.empty()) print_formatted("\nproblems\n");
  for (const Problem& problem : flight.problems) print(problem);
  print_flown(flight);
  if (flight.by_gps) print_by_gps(*flight.by_gps);
  if (!flight.laws.empty()) print_formatted("\nmodels for this aircraft\n");
  for (const ModelCandidate& law : flight.laws) {
    const LawInfo& info = law.model.law;
    const std::string note = doubt_of_dates(info).empty() || info.note.empty() ? "" : "; note: " + info.note;
    print_formatted("  {}: {}{}\n", law.path.stem().string(), law.model.model.name,
                    !law.lacks.empty()     ? fmt::format("; the flight lacks {}", fmt::join(law.lacks, ", "))
                    : !law.is_in_time      ? "; not for the date of the flight, " + validity_of(info)
                    : !law.why_not.empty() ? "; " + law.why_not
                                           : "; matches the flight's pressures, " + validity_of(info) + note);
  }
}

void print(const Inspection& flight) {
  print_head(flight);
  if (is_verbose())
    print_in_full(flight);
  else
    print_short(flight);
  print_notes(flight.notes);
}

/// Published models in the commands, if their dates are in doubt.
std::string doubts_of_next(const Inspection& flight) {
  std::string text;
  for (const ModelCandidate& law : flight.laws) {
    const std::string name = law.path.stem().string();
    const std::string doubt = doubt_of_dates(law.model.law);
    const auto uses = [&](const std::string& command) {
      return command.find(" -m " + name + " ") != std::string::npos ||
             command.find(":" + name + " ") != std::string::npos;
    };
    if (law.fits() && !doubt.empty() && std::any_of(flight.next.begin(), flight.next.end(), uses))
      text += fmt::format("{}: {}; ", name, doubt.substr(0, doubt.find(';')));
  }
  return text.empty()
             ? ""
             : fmt::format(" ({}check that it applies to {})", text, utc_text(flight.time.first, "%Y-%m-%d"));
}

void print_next(const InspectArguments& options, const Inspection& flight) {
  if (flight.next.empty()) {
    print_formatted("This file allows no correction: {}.\n", flight.why_no_model);
    return;
  }
  print_formatted("Next{}{}{}:\n", options.flights.size() == 1 ? "" : " for " + flight.path,
                  flight.next.size() == 1 ? "" : ", in this order", doubts_of_next(flight));
  for (const std::string& each : flight.next) print_formatted("  {}\n", each);
  if (const std::string laser = use_of_laser(options, flight); !laser.empty()) print_formatted("{}\n", laser);
}

bool is_readable(const Inspection& flight) { return flight.unreadable.empty(); }

/// Inspects the flights one after the other. With several flights, an unreadable one does not stop the
/// others.
std::vector<Inspection> look(const InspectArguments& options, bool text) {
  const std::vector<std::filesystem::path> laws = named_models();
  std::vector<Inspection> all;
  for (const std::string& flight : options.flights) {
    if (text && !all.empty()) print_formatted("\n");
    try {
      all.push_back(inspect_flight(flight, laws, options.timestamp_alignment, options.roles));
    } catch (const Error& error) {
      if (options.flights.size() == 1 || error.code() == Error::Code::model) throw;
      all.push_back({flight});
      all.back().unreadable = error.what();
      print_error(error.what());
      continue;
    }
    all.back().next = next_commands(options, all.back());
    if (text) print(all.back());
  }
  if (std::none_of(all.begin(), all.end(), is_readable))
    throw Error(Error::Code::file,
                fmt::format("all {} flights are unreadable; check the files", options.flights.size()));
  return all;
}

/// @throws Error if the file is a model whose coefficients or formulas would be lost
void keep_coefficients(const std::string& path) {
  std::error_code code;
  if (!std::filesystem::is_regular_file(path, code)) return;
  ModelDefinition model;
  try {
    model = read_model(path);
  } catch (const Error&) {
    return;  // another file
  }
  const std::vector<ModelEffect>& effects = model.model.effects;
  if (std::all_of(effects.begin(), effects.end(), is_neutral)) return;
  throw Error(Error::Code::usage,
              fmt::format("{}: the coefficients of this model would be lost; give another name to "
                          "--write-model",
                          path));
}

/// Writes the model, with candidate variables of open roles as comments.
void deliver_with_candidates(const Inspection& flight, const std::string& output) {
  std::string comments;
  for (const auto& [role, candidates] : flight.candidates) {
    const Quantity quantity = quantity_named(role);
    const bool is_open = quantity != Quantity::count && is_role(quantity);
    for (const RoleCandidate& each : candidates) {
      const auto& variables = flight.model->variables;
      const bool is_used = std::any_of(variables.begin(), variables.end(), [&](const auto& variable) {
        return variable.second == each.variable;
      });
      // A name that requires escapes in TOML is not suggested.
      const bool is_plain = each.variable.find_first_of("\"\\") == std::string::npos &&
                            sanitize_line(each.variable) == each.variable;
      if (is_open && !is_used && is_plain)
        comments += fmt::format("# {} = \"{}\"  # {:.2f}: {}\n", role, each.variable, each.score,
                                sanitize_line(each.why));
    }
  }
  std::string text = write_model(*flight.model);
  if (const std::size_t begin = text.find("[variables]\n"); begin != std::string::npos && !comments.empty()) {
    std::size_t end = text.find("\n\n", begin);
    end = end == std::string::npos ? text.size() : end + 1;
    text.insert(
        end,
        "# not read: other candidates, with the score of their evidence (1: certain) and the evidence:\n" +
            comments);
  }
  if (output == "-") {
    fmt::print("{}", text);
    return;
  }
  AtomicFile(output).write(text);
}

void run(const InspectArguments& options) {
  std::vector<std::filesystem::path> inputs(options.flights.begin(), options.flights.end());
  prepare_outputs(options.common, {options.model}, inputs);
  keep_coefficients(options.model);
  JsonResult json(options.common);
  const bool text = wants_text(options.common, {options.model});
  const Inspections result{look(options, text)};
  std::vector<Inspection> readable;
  std::copy_if(result.flights.begin(), result.flights.end(), std::back_inserter(readable), is_readable);
  const Inspection& first = readable.front();
  OutputTransaction together;
  if (!options.model.empty()) {
    if (first.path != options.flights.front())
      throw Error(
          Error::Code::file,
          fmt::format("{}: no model can be written, because the first flight cannot be read", options.model));
    if (!first.model)
      throw Error(Error::Code::variable,
                  fmt::format("{}: no model can be written: {}", first.path, first.why_no_model));
    deliver_with_candidates(first, options.model);
  }
  if (!options.common.report.empty()) {
    std::vector<NextStep> next;
    if (!first.next.empty()) next.push_back({"Next", first.next.front()});
    write_report_of_run(inspection_report(readable), {{}, options.flights, {}, next}, options.common);
  }
  json.write(result);
  together.appear();
  if (!text) return;
  print_written_files({options.model, options.common.report, options.common.json});
  print_next(options, first);
}

}  // namespace

std::function<void()> add_inspect(CLI::App& program) {
  auto options = std::make_shared<InspectArguments>();
  CLI::App* command = program.add_subcommand(
      "inspect",
      "Show the content of a flight: aircraft, rates, roles of its variables, missing inputs, manoeuvres");
  command->add_option("FLIGHT.nc", options->flights, "flights, netCDF or ICARTT files")
      ->required()
      ->type_name("");
  command
      ->add_option("--write-model", options->model,
                   "write a model of the first flight to FILE.toml, with its roles and terms for a refit")
      ->type_name("FILE.toml");
  command
      ->add_option("--roles", options->roles,
                   "naming convention to use: a name from data/aircraft or a .toml file (default: detected)")
      ->type_name("NAME");
  add_time_stamp_option(*command, options->timestamp_alignment);
  add_common_options<Inspections>(*command, options->common);
  add_examples(*command,
               {"inspect first.nc --report inspect.html", "inspect first.nc --write-model mine.toml"});
  return [options] { run(*options); };
}

}  // namespace pcor::tool

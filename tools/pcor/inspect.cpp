#include <pcor/inspect/inspect.hpp>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include <pcor/inspect/inspection_report.hpp>
#include <pcor/words/error.hpp>
#include <pcor/words/utc.hpp>
#include "command.hpp"
#include "model_name.hpp"
#include "report_origin.hpp"

namespace pcor::tool {
namespace {

struct Options {
  CommonOptions common;
  std::vector<std::string> flights;
  std::string model;
  std::string roles;
  std::string time_stamp = "begin";
};

double rate_of(const Inspection& flight) {
  return flight.rates.empty() ? 0.0 : flight.rates.rbegin()->first / flight.time.step;
}

nlohmann::ordered_json as_json(const Inspection& flight) {
  nlohmann::ordered_json result;
  result["path"] = flight.path;
  result["aircraft"] = flight.aircraft;
  result["project"] = flight.project;
  result["flight"] = flight.flight;
  result["institution"] = flight.institution;
  result["names_of"] = flight.family;
  result["alike"] = flight.alike;
  result["rate_hz"] = rate_of(flight);
  result["records"] = flight.records;
  result["begin"] = utc_text(flight.time.first, iso_time);
  result["end"] = utc_text(flight.time.last, iso_time);
  result["gaps"] = flight.time.gap_count;
  nlohmann::ordered_json roles = nlohmann::ordered_json::object();
  for (const InspectedRole& role : flight.roles) {
    roles[role.role] = {{"variable", role.variable},
                        {"unit", role.unit},
                        {"sign", role.is_turned ? "-" : "+"},
                        {"rate", role.rate},
                        {"present", role.present},
                        {"trap", role.trap},
                        {"verified", role.is_verified},
                        {"others", role.others}};
  }
  result["roles"] = roles;
  result["missing"] = nlohmann::ordered_json::array();
  for (const MissingRole& role : flight.missing) {
    result["missing"].push_back({{"role", role.role},
                                 {"looked_for", role.looked_for},
                                 {"cost", role.cost},
                                 {"effects", role.effects}});
  }
  result["frozen"] = nlohmann::ordered_json::array();
  for (const FrozenSpan& span : flight.frozen) {
    const std::vector<double>& time = flight.samples->time;
    result["frozen"].push_back({{"role", std::string(facts_of(span.quantity).name)},
                                {"begin", utc_text(time[span.first], iso_time)},
                                {"end", utc_text(time[span.first + span.count - 1], iso_time)}});
  }
  result["regimes"] = nlohmann::ordered_json::array();
  for (const Interval& interval : flight.intervals) {
    result["regimes"].push_back({{"name", std::string(facts_of(interval.regime).name)},
                                 {"begin", utc_text(interval.begin, iso_time)},
                                 {"end", utc_text(interval.end, iso_time)}});
  }
  result["laws"] = nlohmann::ordered_json::array();
  for (const LawOfFlight& law : flight.laws) {
    result["laws"].push_back({{"name", law.model.model.name},
                              {"model", law.path.string()},
                              {"lacks", law.lacks},
                              {"is_in_time", law.is_in_time},
                              {"why_not", law.why_not}});
  }
  result["notes"] = flight.notes;
  return result;
}

void print_head(const Inspection& flight) {
  std::vector<std::string> who;
  for (const std::string& part : {flight.project, flight.flight, flight.aircraft, flight.institution}) {
    if (!part.empty()) who.push_back(part);
  }
  say("{}: {}\n", flight.path,
      who.empty() ? "it does not say whose flight it is" : fmt::format("{}", fmt::join(who, ", ")));
  say("{} to {} UTC, {} records of {:g} s, {} gap{} in time\n", utc_text(flight.time.first),
      utc_text(flight.time.last), flight.records, flight.time.step, flight.time.gap_count,
      flight.time.gap_count == 1 ? "" : "s");
  std::vector<std::string> rates;
  for (const auto& [rate, count] : flight.rates)
    rates.push_back(fmt::format("{} of {} Hz", count, rate / flight.time.step));
  say("variables: {}\n", fmt::join(rates, ", "));
  if (flight.alike.empty()) {
    say("names are looked for as in files of {}, since the file is like none that is known\n",
        flight.family_title);
  } else if (flight.alike.size() > 1) {
    say("it is like the files of {}; names are looked for as in those of {}; say which in the model by "
        "roles\n",
        fmt::join(flight.alike, " and of "), flight.family);
  } else {
    say("names are those of {} ({})\n", flight.family_title, flight.family);
  }
}

void print_roles(const Inspection& flight) {
  say("\n{:<33} {:<12} {:<10} {:>4} {:>8}  {}\n", "role", "variable", "unit", "Hz", "present", "also there");
  for (const InspectedRole& role : flight.roles) {
    say("{:<33} {:<12} {:<10} {:>4g} {:>7.1f}%  {}\n", role.role,
        role.variable + (role.is_verified ? "" : " ?"), role.unit, role.rate / flight.time.step,
        100.0 * role.present, fmt::join(role.others, " "));
  }
  const bool doubt = std::any_of(flight.roles.begin(), flight.roles.end(),
                                 [](const InspectedRole& role) { return !role.is_verified; });
  if (doubt)
    say("?: no public document of this aircraft was found that has the name; make sure of what it is\n");
  for (const InspectedRole& role : flight.roles) {
    if (!role.trap.empty()) say("{}: {}\n", role.variable, role.trap);
  }
}

void print_missing(const Inspection& flight) {
  bool any = false;
  for (const MissingRole& role : flight.missing) {
    if (role.cost.empty() && role.effects.empty()) continue;
    if (!any) say("\n{:<33} what cannot be done without it\n", "missing");
    any = true;
    say("{:<33} {}{}{}\n", role.role, role.cost, role.cost.empty() || role.effects.empty() ? "" : "; ",
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
  if (!flown.empty()) say("\n{:<18} {:>5} {:>8}\n", "flown", "times", "minutes");
  for (const auto& [regime, sum] : flown)
    say("{:<18} {:>5} {:>8.1f}\n", facts_of(regime).name, sum.first, sum.second / 60.0);
  for (const FrozenSpan& span : flight.frozen) {
    const std::vector<double>& time = flight.samples->time;
    say("{} stands still from {} to {}\n", facts_of(span.quantity).name,
        utc_text(time[span.first], "%H:%M:%S"), utc_text(time[span.first + span.count - 1], "%H:%M:%S"));
  }
}

void print(const Inspection& flight) {
  print_head(flight);
  print_roles(flight);
  print_missing(flight);
  print_flown(flight);
  if (!flight.laws.empty()) say("\nlaws for this aircraft\n");
  for (const LawOfFlight& law : flight.laws) {
    say("  {}: {}{}\n", law.path.stem().string(), law.model.model.name,
        !law.lacks.empty()     ? fmt::format("; the flight lacks {}", fmt::join(law.lacks, ", "))
        : !law.is_in_time      ? "; stated for another time"
        : !law.why_not.empty() ? "; " + law.why_not
                               : "; fits the flight's pressures and its date");
  }
  for (const std::string& note : flight.notes) say("\nNote: {}.\n", note);
}

/// What to do next, as a command to paste.
std::string next_step(const Options& options, const Inspection& flight) {
  const std::string path = shell_path(flight.path);
  if (!flight.model)
    return "To go on: name the variables of its pressures in the [variables] of a model "
           "(data/models/FORMAT.md)";
  if (!options.model.empty()) {
    std::string reference;
    if (flight.model->variables.count(Quantity::lams_airspeed) == 0) {
      if (flight.corrected_pressure.empty())
        return fmt::format("To see what else can be said of its pressures: {} check {}", program(), path);
      reference = " --reference " + shell_word("pressure:" + flight.corrected_pressure);
    }
    return fmt::format("To fit a law: {} refit {} -m {} -o fitted.toml{}", program(), path,
                       shell_path(options.model), reference);
  }
  const auto fits =
      std::find_if(flight.laws.begin(), flight.laws.end(), [](const LawOfFlight& law) { return law.fits(); });
  if (fits != flight.laws.end())
    return fmt::format("To correct it by one of these laws: {} process {} -m {} -o corrected.nc", program(),
                       path, shell_word(fits->path.stem().string()));
  const std::string roles = options.roles.empty() ? "" : " --roles " + shell_word(options.roles);
  return fmt::format("To have a model to start from: {} inspect {}{} --write-model model.toml", program(),
                     path, roles);
}

/// Looks at the flights one after the other. Where there are several, one that cannot be read ends nothing.
std::vector<Inspection> look(const Options& options, bool text, nlohmann::ordered_json& result) {
  const std::vector<std::filesystem::path> laws = named_models();
  const TimeStamp time_stamp = options.time_stamp == "middle" ? TimeStamp::middle : TimeStamp::begin;
  std::vector<Inspection> all;
  for (const std::string& flight : options.flights) {
    if (text && !result.empty()) say("\n");
    try {
      all.push_back(inspect_flight(flight, laws, time_stamp, options.roles));
    } catch (const Error& error) {
      if (options.flights.size() == 1 || error.code() == Error::Code::model) throw;
      result.push_back({{"path", flight}, {"unreadable", error.what()}});
      tell(error.what());
      continue;
    }
    result.push_back(as_json(all.back()));
    if (text) print(all.back());
  }
  if (all.empty()) throw Error(fmt::format("none of the {} flights can be read", options.flights.size()));
  return all;
}

void run(const Options& options) {
  std::vector<std::filesystem::path> inputs(options.flights.begin(), options.flights.end());
  refuse_overwriting({options.model, options.common.json, options.common.report, options.common.figures},
                     inputs);
  for (const std::string& output : {options.model, options.common.report}) require_writable(output);
  require_figures(options.common);
  JsonResult json(options.common);
  const bool text = wants_text(options.common, {options.model});
  nlohmann::ordered_json result;
  result["flights"] = nlohmann::ordered_json::array();
  const std::vector<Inspection> all = look(options, text, result["flights"]);
  const Inspection& first = all.front();
  OutputsTogether together;
  if (!options.model.empty()) {
    if (first.path != options.flights.front())
      throw Error(
          fmt::format("{}: no model can be written, for the first flight cannot be read", options.model));
    if (!first.model)
      throw Error(fmt::format("{}: no model can be written: {}", first.path, first.notes.front()));
    deliver(*first.model, options.model, inputs);
  }
  if (wants_report(options.common)) {
    write_report_of_run(inspection_report(all), {{}, options.flights, {}}, options.common);
  }
  json.write(result);
  together.appear();
  if (!text) return;
  say("\n");
  say_written({options.model, options.common.report, options.common.figures, options.common.json});
  say("{}\n", next_step(options, first));
}

}  // namespace

std::function<void()> add_inspect(CLI::App& program) {
  auto options = std::make_shared<Options>();
  CLI::App* command = program.add_subcommand(
      "inspect",
      "See what a flight holds: aircraft, rates, roles of its variables, what is missing, what was flown");
  command->add_option("flights", options->flights, "flights, netCDF files")->required()->type_name("IN.nc");
  command
      ->add_option(
          "--write-model", options->model,
          "write a model of the first flight to FILE.toml, with its roles and terms that a refit finds")
      ->type_name("FILE.toml");
  command
      ->add_option(
          "--roles", options->roles,
          "look for the names of this aircraft, one of data/aircraft or a file of your own that ends in "
          ".toml; without it, of the one that the flight tells")
      ->type_name("NAME");
  command
      ->add_option("--time-stamp", options->time_stamp,
                   "whether the time of a record is the beginning or the middle of its second")
      ->check(CLI::IsMember({"begin", "middle"}))
      ->capture_default_str();
  add_common_options(*command, options->common);
  add_examples(*command,
               {"inspect first.nc --report inspect.html", "inspect first.nc --write-model mine.toml"});
  return [options] { run(*options); };
}

}  // namespace pcor::tool

#include <pcor/inspect/inspect.hpp>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <numeric>
#include <utility>

#include <pcor/base/utc.hpp>
#include "base/phrasing.hpp"
#include "report/columns.hpp"
#include "report/residual_pictures.hpp"
#include "residuals/flight_report.hpp"

namespace pcor {

using namespace internal;

namespace {

ReportTable roles_of(const Inspection& flight) {
  ReportTable table{"Roles of " + std::filesystem::path(flight.path).filename().string(),
                    "Check that these variables are the right ones: names of " + flight.naming_title + ".",
                    {"role", "variable", "unit", "sign", "samples in a record", "present", "remarks"}};
  for (const InspectedRole& role : flight.roles) {
    std::string remarks = role.caveat;
    if (!role.is_verified)
      remarks += std::string(remarks.empty() ? "" : "; ") + "name not documented publicly";
    table.rows.push_back({role.role, role.variable, role.unit,
                          role.is_sign_inverted ? "reversed" : "unchanged", std::to_string(role.rate),
                          fmt::format("{:.1f} %", 100.0 * role.present), remarks});
  }
  return table;
}

ReportTable missing_of(const Inspection& flight) {
  ReportTable table{"Missing from " + std::filesystem::path(flight.path).filename().string(),
                    "Roles without a variable, and the consequences.",
                    {"role", "description", "names searched", "consequence", "effects that need it"}};
  for (const MissingRole& role : flight.missing) {
    table.rows.push_back({role.role, role.description,
                          fmt::format("{}", fmt::join(role.searched_names, ", ")), role.cost,
                          fmt::format("{}", fmt::join(role.effects, ", "))});
  }
  return table;
}

std::string title_of(const Inspection& flight) {
  const auto models = std::count_if(flight.laws.begin(), flight.laws.end(),
                                    [](const ModelCandidate& law) { return law.fits(); });
  return fmt::format("{} roles found, {} missing; {} published model{} for this flight", flight.roles.size(),
                     flight.missing.size(), models, models == 1 ? "" : "s");
}

}  // namespace

Report inspection_report(const std::vector<Inspection>& flights) {
  FlightReport samples;
  Report& report = samples.report();
  report.title = flights.size() == 1 ? title_of(flights.front())
                                     : fmt::format("Roles and manoeuvres of {} flights", flights.size());
  for (const Inspection& flight : flights) {
    report.info.emplace_back("Flight", fmt::format("{}, {} to {} UTC, {} records, {} gaps", flight.path,
                                                   utc_text(flight.time.first), utc_text(flight.time.last),
                                                   flight.records, flight.time.gap_count));
    report.info.emplace_back("Aircraft", flight.aircraft.empty() ? "not stated" : flight.aircraft);
    report.info.emplace_back("Names of", flight.naming_title);
    if (const std::string models = applicable_text(flight.laws); !models.empty())
      report.info.emplace_back("Models for this flight", models);
    for (const Note& note : flight.notes) {
      if (note.severity == Severity::warning)
        report.summary.push_back(sentence(note.text));
      else
        report.info.emplace_back(label_of(note), note.text);
    }
    if (!flight.samples) continue;
    std::vector<std::size_t> all(flight.samples->time.size());
    std::iota(all.begin(), all.end(), std::size_t{0});
    samples.add_flight(flight.samples, std::move(all));
  }
  for (const char* const name : {"altitude", "true_airspeed", "ground_speed", "pitch", "roll"})
    samples.add_motion(name);
  samples.add_position();
  add_strip(report);
  for (const Inspection& flight : flights) {
    if (!flight.roles.empty()) report.items.emplace_back(roles_of(flight));
    if (!flight.missing.empty()) report.items.emplace_back(missing_of(flight));
  }
  add_if_present(report, TimePanel{"Height", "Altitude in time; regimes are shaded.", {"altitude"}});
  add_if_present(
      report,
      TimePanel{"Speed", "True airspeed and speed over the ground.", {"true_airspeed", "ground_speed"}});
  add_if_present(report, TimePanel{"Attitude", "Pitch and roll.", {"pitch", "roll"}});
  add_track(report, "Track", "Ground track, coloured by altitude.", "altitude", false);
  return std::move(report);
}

}  // namespace pcor

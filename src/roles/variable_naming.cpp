#include "roles/variable_naming.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>
#include <deque>
#include <mutex>

#include <pcor/base/error.hpp>
#include <pcor/base/suggest.hpp>
#include "base/text_file.hpp"
#include "base/toml_reader.hpp"
#include "model_io/model_names.hpp"
#include "roles/usual_variables.hpp"

namespace pcor::internal {

// The files of data/aircraft; the build embeds them (embed.cmake).
namespace aircraft {
extern const std::string_view ncar;
extern const std::string_view faam_core;
extern const std::string_view halo_bahamas;
extern const std::string_view noaa_wp_3d;
extern const std::string_view wyoming_king_air;
}  // namespace aircraft

namespace {

constexpr std::string_view format = "pcor-aircraft/1";

class Reader final : TomlReader {
 public:
  explicit Reader(std::string_view name) : TomlReader(name) {}

  VariableNaming read(std::string_view text_of_file) {
    const toml::table root = parse(text_of_file);
    require_format(root, "a naming convention", format);
    each(root, "",
         {{"format", [](const Entry&) {}},
          {"name", [&](const Entry& entry) { naming_.name = text(entry); }},
          {"title", [&](const Entry& entry) { naming_.title = text(entry); }},
          {"source", [&](const Entry& entry) { naming_.source = text(entry); }},
          {"unverified", [&](const Entry& entry) { naming_.unverified = texts(entry); }},
          {"recognised", [&](const Entry& entry) { read_recognised(entry); }},
          {"pressures", [&](const Entry& entry) { read_pressures(entry); }},
          {"series", [&](const Entry& entry) { read_series(entry); }},
          {"thermometer", [&](const Entry& entry) { read_thermometers(entry); }},
          {"units", [&](const Entry& entry) { naming_.units = texts_by_name(entry); }},
          {"traps", [&](const Entry& entry) { naming_.caveats = texts_by_name(entry); }}},
         {{"name", "the aircraft has no name; add name = \"...\""},
          {"title", "the aircraft has no title; add title = \"...\""}});
    return std::move(naming_);
  }

 private:
  std::vector<std::string> texts(const Entry& entry) const { return texts(array(entry, "a list of texts")); }

  std::vector<std::string> texts(const toml::array& list) const {
    std::vector<std::string> all;
    for (const toml::node& node : list)
      all.push_back(as<std::string>(node, "a text in quotes is required here"));
    return all;
  }

  std::map<std::string, std::string> texts_by_name(const Entry& section) const {
    std::map<std::string, std::string> all;
    for (const Entry& entry : entries_of(table(section), "[" + section.key + "]"))
      all[entry.key] = text(entry);
    return all;
  }

  // Lists of two texts.
  std::vector<std::pair<std::string, std::string>> pairs(const Entry& entry) const {
    std::vector<std::pair<std::string, std::string>> all;
    for (const toml::node& node : array(entry, R"(a list of pairs, [["A", "B"]])")) {
      const std::vector<std::string> two =
          texts(as<toml::array>(node, R"(a pair ["A", "B"] is required here)"));
      if (two.size() != 2) fail(node, R"(a pair has two texts; give it as ["A", "B"])");
      all.emplace_back(two[0], two[1]);
    }
    return all;
  }

  void read_recognised(const Entry& section) {
    each(table(section), "[recognised]",
         {{"attributes", [&](const Entry& entry) { naming_.attributes = pairs(entry); }},
          {"variables", [&](const Entry& entry) { naming_.variables = texts(entry); }}});
  }

  void read_pressures(const Entry& section) {
    const auto read = [&](const Entry& entry, std::vector<PressurePair>& to) {
      for (auto& [pressure, dynamic] : pairs(entry)) to.push_back({std::move(pressure), std::move(dynamic)});
    };
    each(table(section), "[pressures]",
         {{"measured", [&](const Entry& entry) { read(entry, naming_.measured); }},
          {"processed", [&](const Entry& entry) { read(entry, naming_.processed); }}});
  }

  void read_series(const Entry& section) {
    for (const Entry& entry : entries_of(table(section), "[series]")) {
      if (series_named(entry.key) == nullptr) refuse(entry, names_of_series());
      naming_.series[entry.key] = texts(entry);
    }
  }

  void read_thermometers(const Entry& section) {
    for (const toml::node& node : array(section, "tables [[thermometer]]")) {
      Thermometer& thermometer = naming_.thermometers.emplace_back();
      each(as<toml::table>(node, "a table [[thermometer]] is required here"), "[[thermometer]]",
           {{"variable", [&](const Entry& entry) { thermometer.variable = text(entry); }},
            {"recovery_factor", [&](const Entry& entry) {
               const PublishedRecoveryFactor* const known = published_recovery_factor(text(entry));
               if (known == nullptr)
                 fail(entry, "this recovery factor is not in the table of published values");
               thermometer.recovery = known->name;
             }}});
      if (thermometer.variable.empty() || thermometer.recovery.empty())
        fail(node, "a thermometer has a variable and a recovery_factor; give both");
    }
  }

  VariableNaming naming_;
};

bool contains_word(const std::string& text, const std::string& word) {
  const auto equal_ignoring_case = [](unsigned char a, unsigned char b) {
    return std::tolower(a) == std::tolower(b);
  };
  return std::search(text.begin(), text.end(), word.begin(), word.end(), equal_ignoring_case) != text.end();
}

/// Similarity of a flight to a convention: 2 if an attribute matches, 1 if the variables match.
int likeness(const VariableNaming& naming, const Flight& flight) {
  const bool by_attribute =
      std::any_of(naming.attributes.begin(), naming.attributes.end(), [&](const auto& attribute) {
        return contains_word(flight.attribute(attribute.first), attribute.second);
      });
  const bool by_variables = !naming.variables.empty() &&
                            std::all_of(naming.variables.begin(), naming.variables.end(),
                                        [&](const std::string& variable) { return flight.has(variable); });
  return (by_attribute ? 2 : 0) + (by_variables ? 1 : 0);
}

}  // namespace

std::vector<std::string> VariableNaming::names_of(std::string_view of) const {
  const auto found = series.find(of);
  return found == series.end() ? std::vector<std::string>() : found->second;
}

std::string VariableNaming::unit_of(const std::string& variable) const {
  const auto found = units.find(variable);
  return found == units.end() ? std::string() : found->second;
}

const std::vector<VariableNaming>& known_namings() {
  static const std::vector<VariableNaming> all{
      parse_naming(aircraft::ncar, "ncar.toml"),
      parse_naming(aircraft::faam_core, "faam-core.toml"),
      parse_naming(aircraft::halo_bahamas, "halo-bahamas.toml"),
      parse_naming(aircraft::noaa_wp_3d, "noaa-wp-3d.toml"),
      parse_naming(aircraft::wyoming_king_air, "wyoming-king-air.toml"),
  };
  return all;
}

std::vector<const VariableNaming*> matching_namings(const Flight& flight) {
  std::vector<const VariableNaming*> best;
  int maximum = 1;
  for (const VariableNaming& naming : known_namings()) {
    const int here = likeness(naming, flight);
    if (here < maximum) continue;
    if (here > maximum) best.clear();
    maximum = here;
    best.push_back(&naming);
  }
  return best;
}

const VariableNaming& naming_of(const Flight& flight) {
  const std::vector<const VariableNaming*> like = matching_namings(flight);
  return like.empty() ? known_namings().front() : *like.front();
}

const VariableNaming& naming_by_name(const std::string& name) {
  std::vector<std::string> known;
  for (const VariableNaming& naming : known_namings()) {
    if (naming.name == name) return naming;
    known.push_back(naming.name);
  }
  constexpr std::string_view ending = ".toml";
  if (name.size() <= ending.size() || name.substr(name.size() - ending.size()) != ending) {
    const std::string meant = did_you_mean(name, known);
    throw Error(Error::Code::model,
                fmt::format("roles '{}': there is no such aircraft; {}", name,
                            meant.empty() ? fmt::format("known are {}, and files that end in .toml",
                                                        fmt::join(known, ", "))
                                          : meant));
  }
  // Families from files of the user are kept until the program ends, since flights refer to them.
  static std::mutex reading;
  static std::deque<std::pair<std::string, VariableNaming>> read;
  const std::lock_guard lock(reading);
  for (const auto& [path, naming] : read) {
    if (path == name) return naming;
  }
  return read.emplace_back(name, parse_naming(text_of_file(name, "an aircraft file"), name)).second;
}

VariableNaming parse_naming(std::string_view text, std::string_view name) { return Reader(name).read(text); }

}  // namespace pcor::internal

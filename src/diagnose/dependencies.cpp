#include "diagnose/dependencies.hpp"

#include <algorithm>
#include <map>
#include <utility>
#include <vector>

#include "base/phrasing.hpp"

namespace pcor::internal {
namespace {

using Inputs = std::map<std::string, std::vector<std::string>>;  // keyed by computed variable

/// Adds all inputs of the names recursively. Some files contain circular dependencies.
void add_inputs(const Inputs& inputs, std::set<std::string>& names) {
  std::vector<std::string> open(names.begin(), names.end());
  while (!open.empty()) {
    const auto found = inputs.find(open.back());
    open.pop_back();
    if (found == inputs.end()) continue;
    for (const std::string& input : found->second) {
      if (names.insert(input).second) open.push_back(input);
    }
  }
}

}  // namespace

std::set<std::string> computed_from(const Flight& flight, const std::set<std::string>& sensors) {
  Inputs inputs;
  for (const std::string& name : flight.variables()) {
    std::vector<std::string> words = split_words(flight.variable(name).attribute("Dependencies"));
    if (!words.empty()) words.erase(words.begin());  // number of inputs
    inputs[name] = std::move(words);
  }
  std::set<std::string> measured = sensors;
  add_inputs(inputs, measured);
  std::set<std::string> computed;
  for (const std::string& name : flight.variables()) {
    if (measured.count(name) > 0) continue;
    std::set<std::string> all{name};
    add_inputs(inputs, all);
    if (std::any_of(all.begin(), all.end(),
                    [&](const std::string& input) { return measured.count(input) > 0; }))
      computed.insert(name);
  }
  return computed;
}

}  // namespace pcor::internal

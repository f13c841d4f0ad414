#include "fit/lineage.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

namespace pcor::internal {
namespace {

constexpr const char* before_key = "before";

const ProvenanceValue* entry(const Provenance& all, const std::string& key) {
  const auto found =
      std::find_if(all.begin(), all.end(), [&key](const auto& each) { return each.first == key; });
  return found == all.end() ? nullptr : &found->second;
}

/// A model as an entry of the list.
Provenance entry_of(const ModelDefinition& model) {
  Provenance all;
  all.emplace_back("name", ProvenanceValue{model.model.name});
  if (const ProvenanceValue* const date = entry(model.provenance, "date")) all.emplace_back("date", *date);
  if (!model.law.source.empty()) all.emplace_back("source", ProvenanceValue{model.law.source});
  return all;
}

}  // namespace

std::string unfitted_name(const ModelDefinition& model) {
  const std::string& name = model.model.name;
  if (entry(model.provenance, "program") == nullptr) return name;  // name given by its author
  return name.substr(0, std::min(name.find(", fitted to "), name.find(", improved on ")));
}

void descend(ModelDefinition& made, const ModelDefinition& from, const std::string& how,
             const std::string& flights) {
  ProvenanceList before;
  if (const ProvenanceValue* const earlier = entry(from.provenance, before_key)) {
    if (const auto* const list = std::get_if<ProvenanceList>(earlier)) before = *list;
  }
  before.emplace_back(entry_of(from));
  Provenance& all = made.provenance;
  all.erase(std::remove_if(all.begin(), all.end(), [](const auto& each) { return each.first == before_key; }),
            all.end());
  all.emplace_back(before_key, ProvenanceValue{std::move(before)});
  made.law.in_processing = false;
  made.model.name = fmt::format("{}, {} {}", unfitted_name(from), how, flights);
}

}  // namespace pcor::internal

#include "refusal.hpp"

#include <fmt/format.h>

#include <algorithm>

#include <pcor/base/error.hpp>

namespace pcor::tool {

void add_force_option(CLI::App& command, bool& force) {
  command.add_flag("--force", force,
                   "write the result even where its own numbers call it worse than what it started from; the "
                   "file then says so");
}

void refuse_worse(const std::string& worse, bool force, ModelDefinition& model) {
  // What was said of an earlier step does not hold for this one.
  Provenance& all = model.provenance;
  all.erase(std::remove_if(all.begin(), all.end(), [](const auto& entry) { return entry.first == "forced"; }),
            all.end());
  if (worse.empty()) return;
  if (!force) throw Error(fmt::format("no model was written: {}; --force writes it all the same", worse));
  all.emplace_back("forced", ProvenanceValue{worse});
}

}  // namespace pcor::tool

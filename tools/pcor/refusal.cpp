#include "refusal.hpp"

#include <fmt/format.h>

#include <algorithm>

#include <pcor/base/error.hpp>

namespace pcor::tool {

void add_force_option(CLI::App& command, bool& force) {
  command.add_flag("--force", force,
                   "write the result even if the fit is worse than the input model; the file then states it");
}

void refuse_worse(const std::string& worse, bool force, ModelDefinition& model) {
  // The verdict on an earlier step does not apply to this one.
  Provenance& all = model.provenance;
  all.erase(std::remove_if(all.begin(), all.end(), [](const auto& entry) { return entry.first == "forced"; }),
            all.end());
  if (worse.empty()) return;
  if (!force)
    throw Error(Error::Code::fit, fmt::format("no model was written: {}; use --force to write it", worse));
  all.emplace_back("forced", ProvenanceValue{worse});
}

}  // namespace pcor::tool

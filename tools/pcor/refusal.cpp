#include "refusal.hpp"

#include <fmt/format.h>

#include <pcor/words/error.hpp>

namespace pcor::tool {

void add_force_option(CLI::App& command, bool& force) {
  command.add_flag("--force", force,
                   "write the result even where its own numbers call it worse than what it started from; the "
                   "file then says so");
}

void refuse_worse(const std::string& worse, bool force, ModelFile& model) {
  if (worse.empty()) return;
  if (!force) throw Error(fmt::format("nothing was written: {}; --force writes it all the same", worse));
  model.provenance.emplace_back("forced", ProvenanceValue{worse});
}

}  // namespace pcor::tool

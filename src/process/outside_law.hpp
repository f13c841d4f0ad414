#pragma once

#include <vector>

#include <pcor/process/process.hpp>

namespace pcor::internal {

/// Records with extended flaps unless an effect of the model describes them: laws are usually fitted with
/// flaps retracted. Adds their spans and a note to `summary`; empty without such records.
std::vector<bool> find_extended_flaps(const Flight& flight, const ModelDefinition& model,
                                      const ProcessOptions& options, ProcessSummary& summary);

/// Adds the spans of the records in flight outside the domain of the law, and a note, to `summary`. Records
/// with extended flaps have their own spans. Either list may be empty.
void note_outside_domain(const Flight& flight, std::vector<bool> outside, const std::vector<bool>& flaps,
                         ProcessSummary& summary);

}  // namespace pcor::internal

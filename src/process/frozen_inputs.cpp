#include "process/frozen_inputs.hpp"

#include "roles/find_frozen.hpp"
#include "roles/recorded_series.hpp"
#include "roles/resolution.hpp"

namespace pcor::internal {

FrozenInputs find_frozen_inputs(const Flight& flight, const std::vector<bool>& flying, bool keep,
                                std::vector<LoopInput>& inputs, Notes& notes) {
  FrozenInputs found;
  std::vector<double> time;
  for (LoopInput& input : inputs) {
    const std::vector<double> values = read_values(flight, input.variable, input.conversion).values;
    note_coarse(input.quantity, input.variable, values, notes);
    const std::vector<Segment> frozen = find_frozen(flight, input.variable, input.quantity, values, flying);
    if (frozen.empty()) continue;
    if (time.empty()) time = record_times(flight);
    found.texts.push_back(frozen_text(input.variable, input.quantity, values, time, frozen));
    notes.push_back(warning_note(found.texts.back()));
    input.frozen.resize(values.size());
    found.records.resize(values.size());
    for (const Segment& span : frozen) {
      for (std::size_t i = span.first; i < span.first + span.count; ++i)
        input.frozen[i] = found.records[i] = true;
    }
  }
  if (!found.records.empty()) {
    notes.emplace_back(keep ? "readings of frozen sensors are corrected, too; PCORFLAG marks them"
                            : "readings of frozen sensors are treated as missing; --keep-frozen uses them");
  }
  return found;
}

}  // namespace pcor::internal

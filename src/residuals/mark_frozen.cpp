#include "residuals/mark_frozen.hpp"

#include <pcor/base/note.hpp>

#include "roles/find_frozen.hpp"

namespace pcor::internal {

void mark_frozen(FlightSamples& samples, ModelSamples FlightSamples::*part, double min_airspeed) {
  std::vector<bool> flying;
  for (const double airspeed : samples.motion.airspeed) flying.push_back(airspeed >= min_airspeed);
  ModelSamples& read = samples.*part;
  for (const auto& [quantity, variable] : read.variables) {
    const std::vector<double>& values = *read.find(quantity);
    const std::vector<Segment> frozen = find_frozen(values, flying, always_varies(quantity));
    for (const Segment& span : frozen) read.frozen.push_back({quantity, span.first, span.count});
    if (!frozen.empty())
      samples.notes.push_back(warning_note(frozen_text(variable, quantity, values, samples.time, frozen)));
  }
}

}  // namespace pcor::internal

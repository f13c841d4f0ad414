#pragma once

#include <vector>

#include <pcor/flight/flight.hpp>
#include "base/quoting.hpp"
#include "roles/model_inputs.hpp"

namespace pcor::internal {

/// A variable of the flight that the loop reads.
struct LoopInput : ModelInput {
  std::vector<double> values{};  // values of one block
  RejectedCounts excluded{};     // total of all inputs
  std::vector<bool> frozen{};    // records in which the sensor is frozen; empty: none
};

/// Records of a flight in which any input is frozen.
struct FrozenInputs {
  std::vector<bool> records{};  // empty: none
  Names texts{};                // one for each frozen sensor

  bool has(std::size_t record) const { return !records.empty() && records[record]; }
};

/// Marks the records of each input in which it is constant in flight for much longer than its noise permits,
/// and adds notes on them. @param keep whether these readings are corrected, too
FrozenInputs find_frozen_inputs(const Flight& flight, const std::vector<bool>& flying, bool keep,
                                std::vector<LoopInput>& inputs, Notes& notes);

}  // namespace pcor::internal

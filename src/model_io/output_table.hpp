#pragma once

#include <string>
#include <string_view>
#include <vector>

#include <pcor/realtime/stages.hpp>

namespace pcor::internal {

/// Result as written by `process_flight`: quantity of the loop, in the unit of the library, or degC for a
/// temperature.
struct OutputRow {
  std::string name;  ///< default name, which the [output] table of a model may change
  Quantity quantity = Quantity::count;
  std::string long_name;
  std::string standard_name;                  ///< CF standard name; empty if it has no entry in the CF table
  std::string category;                       ///< category of the NCAR conventions
  Quantities (*from)(const Correction&);      ///< quantities from which it is computed, recorded or other
                                              ///< results
  bool is_filtered = false;                   ///< delayed by the filter
  Quantity uncertainty_of = Quantity::count;  ///< quantity of which it is the standard uncertainty
};

/// All results except the quality bits, each after the results from which it is computed.
const std::vector<OutputRow>& output_table();

/// The standard name of the quality bits.
inline constexpr std::string_view quality_output = "PCORFLAG";

/// Ending of the default name of an uncertainty, after the name of its result.
inline constexpr std::string_view uncertainty_ending = "_uncertainty";

/// The standard names of all results.
std::vector<std::string> output_names();

}  // namespace pcor::internal

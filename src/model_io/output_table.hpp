#pragma once

#include <string>
#include <string_view>
#include <vector>

#include <pcor/realtime/stages.hpp>

namespace pcor::internal {

/// A result as `process_flight` writes it: wherever the loop finds its quantity, in the unit of the library,
/// or degC for a temperature.
struct OutputRow {
  std::string name;  ///< the standard name, which the [output] table of a model may change
  Quantity quantity = Quantity::count;
  std::string long_name;
  std::string standard_name;                  ///< of the CF table; empty if it has none
  std::string category;                       ///< of the NCAR conventions
  Quantities (*from)(const Correction&);      ///< what it is found from, recorded or another result
  bool is_filtered = false;                   ///< it leaves the loop as late as the filter is
  Quantity uncertainty_of = Quantity::count;  ///< the result that it is the standard uncertainty of
};

/// All results but the quality bits, each after those that it is found from.
const std::vector<OutputRow>& output_table();

/// The standard name of the quality bits.
inline constexpr std::string_view quality_output = "PCORFLAG";

/// Of "PSXC_uncertainty" the "PSXC"; empty where the name is not one of an uncertainty.
std::string_view result_of_uncertainty(std::string_view standard_name);

/// The standard names of all results.
std::vector<std::string> output_names();

}  // namespace pcor::internal

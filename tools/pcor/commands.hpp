#pragma once

#include <array>

#include "command.hpp"

namespace pcor::tool {

/// Sub-commands, each in a separate file, in the order of the work.
AddCommand add_inspect, add_compare, add_refit, add_diagnose, add_effects, add_add, add_improve, add_check,
    add_process, add_temperature, add_simulate, add_completion, add_man;

inline constexpr std::array commands{
    &add_inspect, &add_compare, &add_refit,       &add_diagnose, &add_effects,    &add_add, &add_improve,
    &add_check,   &add_process, &add_temperature, &add_simulate, &add_completion, &add_man};

/// Sub-commands whose flights are distributed over several processes. The others run in one process.
inline constexpr std::array<const char*, 6> parallel_commands{"compare", "refit", "diagnose",
                                                              "improve", "check", "temperature"};

}  // namespace pcor::tool

#pragma once

#include <array>

#include "command.hpp"

namespace pcor::tool {

/// The sub-commands, each in a file of its own, in the order of the work.
AddCommand add_inspect, add_compare, add_refit, add_diagnose, add_effects, add_add, add_improve, add_check,
    add_process, add_temperature, add_simulate, add_completion, add_man;

inline constexpr std::array commands{
    &add_inspect, &add_compare, &add_refit,       &add_diagnose, &add_effects,    &add_add, &add_improve,
    &add_check,   &add_process, &add_temperature, &add_simulate, &add_completion, &add_man};

/// Those whose flights a team of several processes shares. The others are work of one process.
inline constexpr std::array<const char*, 6> parallel_commands{"compare", "refit", "diagnose",
                                                              "improve", "check", "temperature"};

}  // namespace pcor::tool

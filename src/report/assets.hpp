#pragma once

#include <string_view>

namespace pcor::internal::report {

// Style and scripts of a report, from the files in this folder; the build embeds them (embed.cmake).
extern const std::string_view style;
extern const std::string_view script;

}  // namespace pcor::internal::report

#pragma once

#include <string_view>

namespace pcor::internal::report {

// The browser's side of a report, from the files beside this one; the build embeds them (embed.cmake).
extern const std::string_view style;
extern const std::string_view script;

}  // namespace pcor::internal::report

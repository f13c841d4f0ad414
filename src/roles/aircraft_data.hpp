#pragma once

#include <string_view>

namespace pcor::internal::aircraft {

// The files of data/aircraft; the build embeds them (embed.cmake).
extern const std::string_view ncar;
extern const std::string_view faam_core;
extern const std::string_view halo_bahamas;
extern const std::string_view noaa_wp_3d;
extern const std::string_view wyoming_king_air;

}  // namespace pcor::internal::aircraft

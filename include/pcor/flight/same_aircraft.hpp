#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

namespace pcor {

/// Refuses flights of different aircraft. @throws Error that names two that differ.
void require_one_aircraft(const std::vector<std::pair<std::string, std::string>>& flight_and_aircraft);

/// Refuses a flight that is given twice: its samples would count as if they were new. @throws Error
void require_each_once(const std::vector<std::filesystem::path>& paths);

}  // namespace pcor

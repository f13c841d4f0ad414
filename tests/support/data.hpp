#pragma once

#include <filesystem>

namespace pcor::test {

inline const std::filesystem::path data_directory = std::filesystem::path(PCOR_SOURCE_DIR) / "data";
inline const std::filesystem::path scenarios = data_directory / "scenarios";

}  // namespace pcor::test

#pragma once

#include <filesystem>

#include <pcor/flight/current_input.hpp>

namespace pcor::internal {

/// Makes a file the one that is being read, from now and as long as this lives. The path must outlive it.
class CurrentInput {
 public:
  explicit CurrentInput(const std::filesystem::path& path) noexcept;
  CurrentInput(const CurrentInput&) = delete;
  CurrentInput& operator=(const CurrentInput&) = delete;
  ~CurrentInput();

 private:
  const char* before_;
};

}  // namespace pcor::internal

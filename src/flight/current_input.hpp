#pragma once

#include <filesystem>

#include <pcor/flight/current_input.hpp>

namespace pcor::internal {

/// Makes a file the one that is being read, from now and as long as this lives. The path must outlive it.
class FileInHand {
 public:
  explicit FileInHand(const std::filesystem::path& path) noexcept;
  FileInHand(const FileInHand&) = delete;
  FileInHand& operator=(const FileInHand&) = delete;
  ~FileInHand();

 private:
  const char* before_;
};

}  // namespace pcor::internal

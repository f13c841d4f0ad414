#pragma once

#include <gmock/gmock.h>

#include <string>

#include <pcor/base/note.hpp>

namespace pcor::test {

/// Matches a note whose text contains `part`.
inline auto Says(const std::string& part) {
  return testing::Field("text", &Note::text, testing::HasSubstr(part));
}

}  // namespace pcor::test

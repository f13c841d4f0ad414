#pragma once

#include <pcor/model/effect.hpp>

#include <cctype>
#include <ostream>
#include <string>
#include <string_view>

namespace pcor {

/// Lets GoogleTest print the name of an effect instead of its bytes.
inline void PrintTo(const EffectInfo& info, std::ostream* stream) { *stream << info.id; }

}  // namespace pcor

namespace pcor::test {

/// Name of a test, which may contain only letters and digits: "static-lag" becomes StaticLag.
inline std::string test_name(std::string_view text) {
  std::string name;
  bool begins_word = true;
  for (const char character : text) {
    const auto c = static_cast<unsigned char>(character);
    if (std::isalnum(c)) name += static_cast<char>(begins_word ? std::toupper(c) : c);
    begins_word = !std::isalnum(c);
  }
  return name;
}

}  // namespace pcor::test

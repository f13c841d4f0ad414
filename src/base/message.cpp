#include <pcor/base/message.hpp>

#include "base/quoting.hpp"

namespace pcor {

std::string sanitize_line(std::string_view message) {
  constexpr std::size_t max_letters = 2000;
  return internal::shortened(internal::one_line(message), max_letters);
}

void put_sanitized(std::string_view message, void (*put)(std::string_view)) {
  internal::put_one_line(message, put);
}

std::string shown_text(std::string_view text) {
  std::string shown;
  for (std::size_t end = text.find('\n'); end != std::string_view::npos; end = text.find('\n')) {
    shown += internal::one_line(text.substr(0, end)) + "\n";
    text.remove_prefix(end + 1);
  }
  return shown + internal::one_line(text);
}

}  // namespace pcor

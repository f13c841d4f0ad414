#include "base/quoting.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <array>

#include <pcor/base/message.hpp>
#include <pcor/base/suggest.hpp>

namespace pcor::internal {

namespace {

unsigned code_of(char byte) { return static_cast<unsigned char>(byte); }

// Number of bytes of the UTF-8 character at the beginning of `text`; 0 if the bytes are not valid UTF-8.
std::size_t bytes_of_letter(std::string_view text) {
  const unsigned first = code_of(text.front());
  const std::size_t bytes = first < 0x80 ? 1 : first < 0xc2 ? 0 : first < 0xe0 ? 2 : first < 0xf0 ? 3 : 4;
  if (first > 0xf4 || bytes > text.size()) return 0;
  for (std::size_t i = 1; i < bytes; ++i) {
    if ((code_of(text[i]) & 0xc0U) != 0x80U) return 0;
  }
  return bytes;
}

// True if the character begins a new line (U+2028, U+2029), changes the order in which characters are shown
// (U+061C, U+200E, U+200F, U+202A to U+202E, U+2066 to U+2069), or is invisible (U+FEFF).
bool is_layout(std::string_view letter) {
  if (letter == "\xd8\x9c" || letter == "\xef\xbb\xbf") return true;
  if (letter.size() != 3) return false;
  const unsigned last = code_of(letter[2]);
  const std::string_view block = letter.substr(0, 2);
  return (block == "\xe2\x80" && (last == 0x8e || last == 0x8f || (last >= 0xa8 && last <= 0xae))) ||
         (block == "\xe2\x81" && last >= 0xa6 && last <= 0xa9);
}

bool is_control(std::string_view letter) {
  const unsigned first = code_of(letter.front());
  return first < 0x20 || first == 0x7f || (first == 0xc2 && code_of(letter[1]) < 0xa0) || is_layout(letter);
}

// Calls `visit` with every character, and whether it can be shown; an invalid byte is visited alone.
template <class Visit>
void each_letter(std::string_view text, Visit visit) {
  while (!text.empty()) {
    const std::size_t bytes = bytes_of_letter(text);
    const std::string_view letter = text.substr(0, bytes == 0 ? 1 : bytes);
    visit(letter, bytes != 0 && !is_control(letter));
    text.remove_prefix(letter.size());
  }
}

// Calls `put` with the pieces of the text on one line, without allocation.
template <class Put>
void each_piece(std::string_view text, Put put) {
  each_letter(text, [&](std::string_view letter, bool is_shown) {
    if (is_shown) {
      put(letter);
      return;
    }
    constexpr std::string_view digits = "0123456789abcdef";
    for (const char byte : letter) {
      const std::array code{'\\', 'x', digits[code_of(byte) >> 4U], digits[code_of(byte) & 0xfU]};
      put(std::string_view(code.data(), code.size()));
    }
  });
}

}  // namespace

std::string one_line(std::string_view text) {
  std::string line;
  each_piece(text, [&line](std::string_view piece) { line += piece; });
  return line;
}

std::string shortened(std::string_view text, std::size_t maximum) {
  std::size_t letters = 0;
  std::string first;
  each_letter(text, [&](std::string_view letter, bool) {
    if (++letters <= maximum) first += letter;
  });
  return letters <= maximum ? std::string(text) : fmt::format("{}... ({} characters)", first, letters);
}

std::string quote(std::string_view text) { return "'" + one_line(shortened(text)) + "'"; }

std::string suggestion_text(std::string_view wrong, const Names& known) {
  const std::string meant = did_you_mean(wrong, known);
  return meant.empty() ? fmt::format("use one of {}", fmt::join(known, ", ")) : meant;
}

}  // namespace pcor::internal

namespace pcor {

using namespace internal;

std::string sanitize_line(std::string_view message) {
  constexpr std::size_t max_letters = 2000;
  return shortened(one_line(message), max_letters);
}

void put_sanitized(std::string_view message, void (*put)(std::string_view)) { each_piece(message, put); }

std::string sanitize_text(std::string_view text) {
  std::string shown;
  for (std::size_t end = text.find('\n'); end != std::string_view::npos; end = text.find('\n')) {
    shown += one_line(text.substr(0, end)) + "\n";
    text.remove_prefix(end + 1);
  }
  return shown + one_line(text);
}

}  // namespace pcor

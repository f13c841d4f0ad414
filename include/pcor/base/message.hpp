#pragma once

#include <string>
#include <string_view>

namespace pcor {

/// Message for display: one line of at most 2000 characters; longer messages end in an ellipsis and their
/// length. Control characters and invalid UTF-8 bytes become `\x1b` and the like.
std::string sanitize_line(std::string_view message);

/// Puts the message in pieces and at full length, without allocation: for signal handlers.
void put_sanitized(std::string_view message, void (*put)(std::string_view));

/// Text for display: as `sanitize_line`, but lines and length are kept.
std::string sanitize_text(std::string_view text);

}  // namespace pcor

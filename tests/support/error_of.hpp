#pragma once

#include <gmock/gmock.h>
#include <pcor/base/error.hpp>

#include <cctype>
#include <optional>
#include <string>

namespace pcor::test {

/// Error that `work` throws; nullopt if it throws no pcor::Error.
template <class Work>
std::optional<Error> error_of(const Work& work) {
  try {
    work();
  } catch (const Error& error) {
    return error;
  }
  return std::nullopt;
}

/// Matches a text that contains `name` (a name or number), but not only as a part of a longer name or number.
MATCHER_P(HasName, name, "has the name " + testing::PrintToString(name)) {
  const std::string text(arg);
  const auto continues = [&text](std::size_t i) {
    return i < text.size() && (std::isalnum(static_cast<unsigned char>(text[i])) != 0 || text[i] == '_');
  };
  for (std::size_t at = text.find(name); at != std::string::npos; at = text.find(name, at + 1)) {
    const std::size_t end = at + name.size();
    const bool begins = at == 0 || !continues(at) || !continues(at - 1);
    if (begins && !(continues(end - 1) && continues(end))) return true;
  }
  return false;
}

/// Matches an error with this code whose message is one line and contains all names and numbers.
template <class... Names>
auto IsError(Error::Code code, const Names&... names) {
  using testing::AllOf;
  using testing::Property;
  return testing::Optional(AllOf(Property("code", &Error::code, code),
                                 Property("what", &Error::what, testing::Not(testing::HasSubstr("\n"))),
                                 Property("what", &Error::what, HasName(std::string(names)))...));
}

}  // namespace pcor::test

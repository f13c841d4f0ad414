#include <pcor/base/shell_quote.hpp>

namespace pcor {

std::string shell_quote(const std::string& word) {
  constexpr const char* plain = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789_-+./:,=@%";
  if (!word.empty() && word.find_first_not_of(plain) == std::string::npos) return word;
  std::string text = "'";
  for (const char letter : word) text += letter == '\'' ? "'\\''" : std::string(1, letter);
  return text + "'";
}

std::string shell_path(const std::string& path) {
  return shell_quote(path.rfind('-', 0) == 0 && path != "-" ? "./" + path : path);
}

std::string shell_option(const std::string& name, const std::string& value) {
  return name + (value.rfind('-', 0) == 0 ? "=" : " ") + shell_quote(value);
}

}  // namespace pcor

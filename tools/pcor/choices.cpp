#include "choices.hpp"

#include "text.hpp"

namespace pcor::tool {
namespace {

std::vector<std::string> chosen;

}  // namespace

void tell_choices(const Notes& choices, bool quiet) {
  for (const Note& choice : choices) {
    if (!quiet) tell(format_note(choice));
    chosen.push_back(format_note(choice));
  }
}

const std::vector<std::string>& choices_of_this_run() { return chosen; }

}  // namespace pcor::tool

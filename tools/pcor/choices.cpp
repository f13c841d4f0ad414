#include "choices.hpp"

#include "text.hpp"

namespace pcor::tool {
namespace {

std::vector<std::string> chosen;

}  // namespace

void tell_choices(const std::vector<std::string>& choices, bool quiet) {
  for (const std::string& choice : choices) {
    if (!quiet) tell(choice);
    chosen.push_back(choice);
  }
}

const std::vector<std::string>& choices_of_this_run() { return chosen; }

}  // namespace pcor::tool

#include <pcor/model/formula.hpp>

#include <optional>
#include <vector>

#include "reading.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  return fuzz::reading(bytes, size, [](const std::string& text) {
    const std::optional<pcor::Formula> formula = pcor::Formula::parse(text, {"k", "k2"});
    if (!formula) return;
    const std::vector<double> variables(formula->variables().size(), 0.7);
    const std::vector<double> parameters(formula->parameters().size(), -1.5);
    formula->value(variables.data(), parameters.data());
  });
}

#pragma once

#include <string>

namespace pcor::test {

/// The smallest valid model. Additions of a test begin at line 5.
inline const std::string minimum_model = R"(format = "pcor-model/1"
[variables]
static_pressure = "PSFD"
dynamic_pressure = "QCF"
)";

}  // namespace pcor::test

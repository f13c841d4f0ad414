#pragma once

#include <optional>
#include <string>
#include <vector>

#include <pcor/improve/improve.hpp>
#include <pcor/report/report.hpp>

namespace pcor::internal::report {

/// Description of the held-out samples: "rf03.nc", "the last part of rf01.nc".
std::vector<std::string> held_out_names(const Improvement& improvement);

/// Sentence on the samples that are not in the fit; empty with held-out flights or parts of them.
std::string held_out_text(const Improvement& improvement);

/// Label of a step: "refitted", "+ static-lag".
std::string step_name(const ImproveStep& step);

/// Whether the written model replaces or lacks an effect that a step added.
bool delivers_rivals(const Improvement& improvement);

/// Rms residual of every step, fitted and held out, with the noise as a line.
DotPanel steps_picture(const Improvement& improvement);

/// Coefficients of the best and the initial model; empty if nothing was fitted.
std::optional<DotPanel> coefficients_picture(const Improvement& improvement, const ModelDefinition& start);

/// Marks each completely held-out flight in its name.
void name_held_out(Report& report, const Improvement& improvement);

}  // namespace pcor::internal::report

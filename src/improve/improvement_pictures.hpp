#pragma once

#include <optional>
#include <string>
#include <vector>

#include <pcor/improve/improve.hpp>
#include <pcor/report/report.hpp>

namespace pcor::internal::report {

/// What took no part in the fit: "rf03.nc", "the last part of rf01.nc".
std::vector<std::string> held_out_names(const Improvement& improvement);

/// What a rung is called: "refitted", "+ static-lag".
std::string rung_name(const ImproveStep& step);

/// Whether the written model has another effect than a step of the ladder added, or none in its place.
bool delivers_rivals(const Improvement& improvement);

/// The rms residual of every rung, in the fit and on what was held out, with the noise as a line.
DotPanel ladder_picture(const Improvement& improvement);

/// The coefficients of the best model beside those of the one to begin with; none where nothing was fitted.
std::optional<DotPanel> coefficients_picture(const Improvement& improvement, const ModelDefinition& start);

/// Says at the name of each flight that is held out as a whole that it is.
void name_held_out(Report& report, const Improvement& improvement);

}  // namespace pcor::internal::report

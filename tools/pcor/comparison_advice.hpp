#pragma once

#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include <pcor/compare/compare.hpp>
#include <pcor/fit/refit.hpp>
#include <pcor/report/report.hpp>
#include "comparison.hpp"

namespace pcor::tool {

struct CompareArguments {
  CommonOptions common;
  ComparisonOptions comparison;
  std::vector<std::string> models;
  std::string residuals;
  std::string table;
};

/// Mean error of delta-p by GPS, with the name of the model.
using Levels = std::vector<std::pair<std::string, LevelByGps>>;

/// JSON result of the command.
struct ComparisonWithGps {
  Comparison comparison{};
  Levels levels{};
};

/// "+0.12 +- 0.03 hPa"
std::string correction_text(const LevelByGps& level);

/// Whether the rms is close to the noise; the largest ratio by all references decides.
bool is_close_to_noise(const ModelComparison& worst);

template <class Field>
void describe(const ComparisonWithGps& self, Field& field) {
  describe(self.comparison, field);
  field.list("worst_references", self.comparison.models, "reference with the largest ratio, for each model",
             [&self](const ModelComparison& model, Field& of_one) {
               const ModelComparison& worst = worst_by_noise(self.comparison, model);
               of_one("name", model.name, "name of the model");
               of_one("reference", worst.reference, "reference; wind and height only if there are no others");
               if (!of_one.has(!std::isnan(worst.noise_ratio()))) return;
               of_one("rms_over_noise", worst.noise_ratio(),
                      "rms residual divided by the rms noise; absent by GPS");
               of_one("close_to_noise", is_close_to_noise(worst), "whether the ratio is less than 1.15");
             });
  if (!field.has(!self.levels.empty())) return;
  field.list("by_gps", self.levels, "error of delta-p by GPS; absent if not requested",
             [](const auto& each, Field& level) {
               level("model", each.first, "name of the model");
               level("missing_hpa", each.second.missing, "mean correction of delta-p");
               level("stderr_hpa", each.second.standard_error, "standard error of the correction");
             });
}

/// Next step: a model is applied or refitted, that with the smallest rms. An rms by GPS contains gusts: there
/// it is the first model with the best support.
std::vector<NextStep> next_steps(const ComparisonWithGps& result, const std::vector<ComparedModel>& models,
                                 const CompareArguments& options);

}  // namespace pcor::tool

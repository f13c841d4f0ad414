#include <pcor/batch/batch.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <string>

#include <pcor/words/error.hpp>
#include "batch/batch_kernel.hpp"

namespace pcor {

using namespace internal;

namespace {

Chain built(const Model& model, const std::vector<Quantity>& recorded, CorrectWith with) {
  BindingError why;
  std::optional<Chain> chain = Chain::build(model, recorded, &why);
  if (!chain) throw Error(Error::Code::model, fmt::format("model '{}': {}", model.name, why.message()));
  const auto require = [&](Quantity quantity) {
    if (!chain->derives(quantity)) return;
    throw Error(fmt::format("model '{}': over whole arrays it needs '{}' among them", model.name,
                            facts_of(quantity).name));
  };
  require(Quantity::time);
  for (const Rate& each : rates) require(each.rate);
  if (with == CorrectWith::lams && !chain->has_lams()) {
    throw Error(fmt::format("model '{}': correction with LAMS needs the role 'lams_airspeed'", model.name));
  }
  return std::move(*chain);
}

bool comes_after_correction(Quantity quantity) {
  const auto after = {
      Quantity::humidity,           Quantity::corrected_mach,   Quantity::ambient_temperature,
      Quantity::corrected_airspeed, Quantity::lams_temperature, Quantity::lams_dynamic_pressure};
  return std::find(after.begin(), after.end(), quantity) != after.end();
}

bool has_avx2() {
#if defined(__x86_64__)
  return __builtin_cpu_supports("avx2") != 0 && __builtin_cpu_supports("fma") != 0;
#else
  return false;
#endif
}

BatchKernel kernel() {
  static const BatchKernel best = run_batch_avx2 != nullptr && has_avx2() ? run_batch_avx2 : &run_batch;
  return best;
}

}  // namespace

Batch::Batch(const Model& model, const std::vector<Quantity>& recorded, CorrectWith with)
    : chain_(built(model, recorded, with)), with_(with) {}

void Batch::run(const std::vector<Input>& inputs, const std::vector<Output>& outputs, std::size_t samples,
                const double* parameters) const {
  for (const Quantity needed : chain_.inputs()) {
    const bool given = std::any_of(inputs.begin(), inputs.end(),
                                   [needed](const Input& input) { return input.quantity == needed; });
    if (given) continue;
    const std::size_t place = index(needed);
    throw Error(fmt::format(
        "the values of '{}' are missing",
        place < quantity_count ? facts_of(needed).name : chain_.extra_names()[place - quantity_count]));
  }
  BatchJob job;
  job.chain = &chain_;
  job.parameters = parameters != nullptr ? parameters : chain_.parameters().data();
  job.corrects_with_lams = with_ == CorrectWith::lams;
  job.finds_lams = job.corrects_with_lams;
  for (const Output& output : outputs) {
    job.finds_lams |= chain_.has_lams() && output.quantity == Quantity::lams_static_defect;
    job.finds_air |= comes_after_correction(output.quantity);
  }
  job.inputs = inputs.data();
  job.input_count = inputs.size();
  job.outputs = outputs.data();
  job.output_count = outputs.size();
  job.samples = samples;
  kernel()(job);
}

}  // namespace pcor

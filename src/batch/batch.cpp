#include <pcor/batch/batch.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <bitset>
#include <cstddef>
#include <optional>
#include <string>

#include <pcor/base/error.hpp>
#include "batch/batch_kernel.hpp"

namespace pcor {

using namespace internal;

namespace {

Chain built(const Model& model, const std::vector<Quantity>& recorded, CorrectWith with) {
  const auto fail = [&model](const std::string& what) {
    throw Error(Error::Code::model, fmt::format("model '{}': {}", model.name, what));
  };
  BindingError why;
  std::optional<Chain> chain = Chain::build(model, recorded, &why);
  if (!chain) fail(why.message());
  const auto require = [&](Quantity quantity) {
    if (chain->derives(quantity))
      fail(fmt::format("batch processing requires '{}' among the arrays", info_of(quantity).name));
  };
  require(Quantity::time);
  for (const Rate& each : rates) require(each.rate);
  if (with == CorrectWith::lams && !chain->has_lams())
    fail("correction with LAMS needs the role 'lams_airspeed', which" + std::string(not_recorded));
  return std::move(*chain);
}

std::bitset<state_capacity> set_of(const Quantities& quantities) {
  std::bitset<state_capacity> set;
  for (const Quantity quantity : quantities) set.set(index(quantity));
  return set;
}

}  // namespace

std::vector<BatchKernel> internal::batch_kernels() {
  std::vector<BatchKernel> kernels;
#if defined(__x86_64__)
  const bool has_avx2 = __builtin_cpu_supports("avx2") != 0 && __builtin_cpu_supports("fma") != 0;
  const bool has_avx512 = has_avx2 && __builtin_cpu_supports("avx512f") != 0 &&
                          __builtin_cpu_supports("avx512cd") != 0 &&
                          __builtin_cpu_supports("avx512dq") != 0 && __builtin_cpu_supports("avx512bw") != 0;
  if (has_avx512 && run_batch_avx512 != nullptr) kernels.push_back(run_batch_avx512);
  if (has_avx2 && run_batch_avx2 != nullptr) kernels.push_back(run_batch_avx2);
#endif
  kernels.push_back(&run_batch);
  return kernels;
}

Batch::Batch(const Model& model, const std::vector<Quantity>& recorded, CorrectWith with)
    : chain_(built(model, recorded, with)), with_(with), recorded_(set_of(chain_.inputs())) {
  std::size_t number = 0;
  Stages::each([&](auto stage) {
    const Correction correction{chain_, with_};
    stages_[number++] = {set_of(stage.reads(correction)), set_of(stage.writes(correction))};
  });
}

std::string Batch::to_string(Quantity quantity) const {
  const std::vector<std::string>& extras = chain_.extra_names();
  if (index(quantity) < quantity_count) return std::string(info_of(quantity).name);
  return extra_number(quantity) < extras.size() ? extras[extra_number(quantity)] : "no quantity";
}

bool Batch::finds(Quantity quantity) const {
  return recorded_[index(quantity)] ||
         std::any_of(stages_.begin(), stages_.end(),
                     [quantity](const StageInfo& stage) { return stage.writes[index(quantity)]; });
}

void Batch::compute(const std::vector<Input>& inputs, const std::vector<Output>& outputs,
                    const std::vector<Derivative>& derivatives, std::size_t samples,
                    const double* parameters) const {
  for (const Quantity needed : chain_.inputs()) {
    const bool given = std::any_of(inputs.begin(), inputs.end(),
                                   [needed](const Input& input) { return input.quantity == needed; });
    if (!given)
      throw Error(Error::Code::variable, fmt::format("the values of '{}' are missing", to_string(needed)));
  }
  std::bitset<state_capacity> requested;
  for (const Output& output : outputs) {
    if (!finds(output.quantity)) {
      throw Error(
          Error::Code::variable,
          fmt::format("'{}' is not available in batch mode: an input is not recorded or depends on earlier "
                      "samples; pass it as an input",
                      to_string(output.quantity)));
    }
    requested.set(index(output.quantity));
  }
  if (!derivatives.empty()) requested.set(index(Quantity::static_defect));
  BatchJob job;
  job.chain = &chain_;
  job.with = with_;
  job.parameters = parameters != nullptr ? parameters : chain_.parameters().data();
  for (std::size_t i = stages_.size(); i-- > 0;) {
    job.runs[i] = (stages_[i].writes & requested).any();
    if (job.runs[i]) requested |= stages_[i].reads;
  }
  job.inputs = inputs.data();
  job.input_count = inputs.size();
  job.outputs = outputs.data();
  job.output_count = outputs.size();
  job.samples = samples;
  std::vector<std::vector<double>> coefficients;
  std::vector<BatchDerivative> columns;
  for (const Derivative& each : derivatives) {
    const bool is_known =
        each.effect < chain_.effect_count() && each.parameter < chain_.parameter_count_of(each.effect);
    if (!is_known || !chain_.is_static_sum_linear(each.effect, each.parameter)) {
      throw Error(
          Error::Code::usage,
          fmt::format(
              "the static defect is not linear in coefficient {} of effect {}: give a coefficient of an "
              "effect at the static ports that is neither a shape nor of a formula",
              each.parameter, each.effect));
    }
    BatchDerivative& column = columns.emplace_back(BatchDerivative{each});
    if (chain_.surface_of(each.effect) != nullptr) continue;
    coefficients.push_back(chain_.unit_coefficients(each.effect, each.parameter, job.parameters));
    column.coefficients = coefficients.back().data();
  }
  job.derivatives = columns.data();
  job.derivative_count = columns.size();
  static const BatchKernel fastest = batch_kernels().front();
  fastest(job);
}

}  // namespace pcor

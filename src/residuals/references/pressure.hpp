#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include <pcor/base/error.hpp>
#include <pcor/base/suggest.hpp>
#include <pcor/residuals/reference.hpp>
#include "residuals/reference_on_samples.hpp"
#include "roles/computed_from.hpp"
#include "roles/recorded_series.hpp"
#include "roles/role_evidence.hpp"

namespace pcor::internal {

class PressureOnSamples final : public ReferenceOnSamples {
 public:
  PressureOnSamples(const FlightSamples& samples, const ModelOnSamples& model)
      : pressure_(*samples.reference.find(Quantity::corrected_static_pressure)), model_(model) {}

  void residuals(const Block& block, const double* parameters, double* out) const override {
    model_.port_pressure_plus(Quantity::static_defect, block.model, block.samples.size(), parameters, out);
    const double* const pressure = block.reference.front().values;
    for (std::size_t i = 0; i < block.samples.size(); ++i) out[i] = pressure[i] - out[i];
  }

  void residuals(const std::vector<std::size_t>& samples, const Jet* parameters, Jet* out) const override {
    for (const std::size_t sample : samples) {
      State<Jet> state;
      *out++ = Jet(pressure_[sample]) - model_.corrected_static_pressure(sample, parameters, state);
    }
  }

  std::vector<Batch::Input> columns() const override {
    return {{Quantity::corrected_static_pressure, pressure_.data()}};
  }

  Mask why_missing(std::size_t sample) const override {
    if (model_.is_missing_needed(sample)) return Mask::missing;
    return std::isnan(pressure_[sample]) ? Mask::reference : Mask::impossible;
  }

 private:
  const std::vector<double>& pressure_;
  const ModelOnSamples& model_;
};

class PressureReference final : public Reference {
 public:
  /// @param of_model variable of the model's static pressure; if empty, `variable` is trusted
  PressureReference(std::string variable, std::string of_model)
      : variable_(std::move(variable)), of_model_(std::move(of_model)) {}

  std::string description() const override { return fmt::format("static pressure {}", variable_); }
  std::string name() const override { return "pressure:" + variable_; }
  std::vector<std::string> variables() const override { return {variable_}; }

  ModelSamples read(const Flight& flight, const std::vector<double>&, Notes& notes) const override {
    if (!flight.has(variable_)) {
      const std::string meant = did_you_mean(variable_, flight.variables());
      throw Error(Error::Code::variable,
                  fmt::format("{}: {}, the reference, is not in this file{}; give another with --reference",
                              flight.path().string(), variable_, meant.empty() ? "" : "; " + meant));
    }
    const UnitConversion conversion =
        within_plausible_range(flight.conversion(variable_, "hPa"), info_of(Quantity::static_pressure));
    flight.require_values(variable_);
    if (!of_model_.empty() && variable_ != of_model_) require_static(flight, notes);
    if (!of_model_.empty() && is_computed_from(flight, variable_, of_model_)) {
      const std::string what = variable_ == of_model_ ? "is" : "is computed from " + of_model_ + ",";
      notes.emplace_back(Severity::warning, fmt::format("use an independent reference: {} {} the static "
                                                        "pressure of the model; the comparison is circular",
                                                        variable_, what));
    }
    ModelSamples samples;
    samples.columns = {
        {Quantity::corrected_static_pressure, read_values(flight, variable_, conversion).values}};
    samples.variables = {{Quantity::corrected_static_pressure, variable_}};
    return samples;
  }

  std::unique_ptr<ReferenceOnSamples> on(const FlightSamples& samples,
                                         const ModelOnSamples& model) const override {
    return std::make_unique<PressureOnSamples>(samples, model);
  }

 private:
  /// Warns about the raw pressure of another system. @throws Error if the file describes the variable as
  /// another pressure, and not as a static pressure
  void require_static(const Flight& flight, Notes& notes) const {
    const auto candidate = [&](Quantity role) -> std::optional<RoleCandidate> {
      for (RoleCandidate& each : role_candidates(flight, info_of(role).name)) {
        if (each.variable == variable_) return std::move(each);
      }
      return std::nullopt;
    };
    using Q = Quantity;
    const std::optional<RoleCandidate> as_static = candidate(Q::static_pressure);
    const double required = as_static ? std::max(sure_score, as_static->score + clear_lead) : sure_score;
    for (const Quantity role :
         {Q::dynamic_pressure, Q::radome_dynamic_pressure, Q::attack_differential_pressure,
          Q::sideslip_differential_pressure, Q::cabin_pressure}) {
      const std::optional<RoleCandidate> other = candidate(role);
      if (!other || other->score < required) continue;
      throw Error(
          Error::Code::variable,
          fmt::format("{}: {}, the reference, has the role {}, not static_pressure: {}; give another with "
                      "--reference",
                      flight.path().string(), variable_, info_of(role).name, other->why));
    }
    const std::string& long_name = flight.variable(variable_).long_name;
    const std::vector<std::string> words = plain_words(long_name);
    if (std::find(words.begin(), words.end(), "raw") == words.end()) return;
    notes.push_back(warning_note(
        fmt::format("use --reference static:MODEL with a model of {0} ('pcor inspect' lists published "
                    "models): the file describes {0} as '{1}', so the residual contains its error",
                    variable_, long_name)));
  }

  std::string variable_;
  std::string of_model_;
};

}  // namespace pcor::internal

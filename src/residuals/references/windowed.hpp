#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <pcor/base/error.hpp>
#include <pcor/residuals/reference.hpp>
#include <pcor/residuals/residuals.hpp>
#include "regimes/series.hpp"
#include "residuals/model_on_samples.hpp"
#include "residuals/reference_on_samples.hpp"
#include "residuals/samples.hpp"

namespace pcor::internal {

/// Reference whose residual at a sample depends on the neighbouring samples, in two steps: for each sample
/// `part_count` numbers from the model at the sample alone, then the residuals from the numbers of all
/// samples. `Derived` defines
///
///     template <class S>
///     std::array<S, part_count> parts_of(std::size_t sample, const S* parameters) const
///
/// and, with the parts of all samples of `span`, in which `samples` lie with their neighbours,
///
///     template <class S>
///     void find(IndexRange span, const std::vector<std::array<S, part_count>>& parts,
///               const std::vector<std::size_t>& samples, S* out) const
template <class Derived, std::size_t part_count>
class WindowedResidual : public ReferenceOnSamples {
 public:
  /// @param window of the samples on which a residual depends, s
  WindowedResidual(const ModelOnSamples& model, const FlightSamples& samples, double window)
      : model_(model),
        size_(samples.time.size()),
        half_width_(static_cast<std::size_t>(std::lround(0.5 * window / samples.step))) {}

  std::size_t half_width() const final { return half_width_; }

  void residuals(const Block& block, const double* parameters, double* out) const override {
    find(block.samples, parameters, out);
  }

  void residuals(const std::vector<std::size_t>& samples, const Jet* parameters, Jet* out) const override {
    find(samples, parameters, out);
  }

  void differentiate_along(const std::vector<std::size_t>& samples, const double* parameters,
                           const std::vector<Direction>& directions, double* derivatives) const override {
    if (samples.empty()) return;
    const IndexRange span = span_of(samples);
    std::vector<std::size_t> requested;
    for (const Direction& direction : directions) requested.push_back(direction.parameter);
    std::sort(requested.begin(), requested.end());
    requested.erase(std::unique(requested.begin(), requested.end()), requested.end());
    const std::vector<Parts<double>> values = parts(span, parameters);
    const std::vector<std::vector<Parts<double>>> slopes = slopes_of_parts(span, parameters, requested);
    std::vector<Jet> out(samples.size());
    for (std::size_t first = 0; first < directions.size(); first += jet_width) {
      const std::size_t width = std::min<std::size_t>(jet_width, directions.size() - first);
      std::vector<Parts<Jet>> moved(span.length());
      for (std::size_t k = 0; k < span.length(); ++k)
        std::transform(values[k].begin(), values[k].end(), moved[k].begin(),
                       [](double value) { return Jet(value); });
      for (std::size_t d = 0; d < width; ++d) {
        const Direction& direction = directions[first + d];
        const auto position = std::lower_bound(requested.begin(), requested.end(), direction.parameter);
        const std::vector<Parts<double>>& slope =
            slopes[static_cast<std::size_t>(position - requested.begin())];
        for (std::size_t k = 0; k < span.length(); ++k) {
          const double rate = direction.rate[span.first + k];
          if (rate == 0.0) continue;  // the slope may be missing there
          for (std::size_t part = 0; part < part_count; ++part)
            moved[k][part].v[static_cast<Eigen::Index>(d)] = rate * slope[k][part];
        }
      }
      derived().find(span, moved, samples, out.data());
      for (std::size_t d = 0; d < width; ++d) {
        for (const Jet& each : out) *derivatives++ = each.v[static_cast<Eigen::Index>(d)];
      }
    }
  }

  Mask why_missing(std::size_t sample) const override {
    return model_.is_missing_needed(sample) ? Mask::missing : Mask::reference;
  }

 protected:
  template <class S>
  using Parts = std::array<S, part_count>;

  const ModelOnSamples& law() const { return model_; }

 private:
  const Derived& derived() const { return static_cast<const Derived&>(*this); }

  IndexRange span_of(const std::vector<std::size_t>& samples) const {
    const auto [minimum, maximum] = std::minmax_element(samples.begin(), samples.end());
    return {*minimum - std::min(*minimum, half_width()), std::min(*maximum + half_width() + 1, size_)};
  }

  template <class S>
  std::vector<Parts<S>> parts(const IndexRange span, const S* parameters) const {
    std::vector<Parts<S>> result;
    result.reserve(span.length());
    for (std::size_t k = span.first; k < span.end; ++k) result.push_back(derived().parts_of(k, parameters));
    return result;
  }

  /// Derivatives of the parts with respect to each of the requested parameters.
  std::vector<std::vector<Parts<double>>> slopes_of_parts(const IndexRange span, const double* parameters,
                                                          const std::vector<std::size_t>& requested) const {
    std::vector<std::vector<Parts<double>>> slopes(requested.size(),
                                                   std::vector<Parts<double>>(span.length()));
    std::vector<ColumnOfParameter> columns;
    for (std::size_t k = 0; k < requested.size(); ++k)
      columns.push_back({requested[k], slopes[k].front().data()});
    differentiate(span.length() * part_count, {parameters, parameters + model_.parameters().size()}, columns,
                  [&](const Jet* dual, Jet* out) {
                    for (const Parts<Jet>& each : parts(span, dual))
                      out = std::copy(each.begin(), each.end(), out);
                  });
    return slopes;
  }

  template <class S>
  void find(const std::vector<std::size_t>& samples, const S* parameters, S* out) const {
    if (samples.empty()) return;
    const IndexRange span = span_of(samples);
    derived().find(span, parts(span, parameters), samples, out);
  }

  const ModelOnSamples& model_;
  std::size_t size_;
  std::size_t half_width_;
};

/// Reference by `OnSamples`, which is `WindowedResidual` and requires the temperature, with variables that
/// the compared model names.
template <class OnSamples>
class WindowedReference : public Reference {
 public:
  explicit WindowedReference(ModelDefinition file) : file_(std::move(file)) {}

  bool is_static_pressure() const override { return false; }
  bool is_of_one_sample() const override { return false; }
  std::string inputs() const override { return name() + inputs_of(file_, false); }

  std::unique_ptr<ReferenceOnSamples> on(const FlightSamples& samples,
                                         const ModelOnSamples& model) const override {
    if (!model.chain().has_temperature()) {
      throw Error(Error::Code::model,
                  fmt::format("the model has no temperature, which the reference {} requires; set "
                              "recovery_temperature or ambient_temperature in the table [variables]",
                              name()));
    }
    return std::make_unique<OnSamples>(samples, model);
  }

 protected:
  const ModelDefinition& file() const { return file_; }

 private:
  ModelDefinition file_;
};

}  // namespace pcor::internal

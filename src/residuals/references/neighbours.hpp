#pragma once

#include <algorithm>
#include <cstddef>

#include "residuals/model_on_samples.hpp"
#include "residuals/reference_on_samples.hpp"

namespace pcor::internal {

/// A part of a flight without a break.
struct Span {
  std::size_t first = 0;
  std::size_t end = 0;  ///< after the last
  std::size_t size() const { return end - first; }
};

/// A reference whose residual at a sample is made of the samples around it. `Derived` gives `reach`, how many
/// they are on either side, and
///
///     template <class S>
///     void find(Span span, const std::size_t* samples, std::size_t count, const S* parameters, S* out) const
///
/// with the residuals of `samples`, which lie with their neighbours in `span`.
template <class Derived>
class OfNeighbours : public ReferenceOnSamples {
 public:
  OfNeighbours(const ModelOnSamples& model, std::size_t size) : model_(model), size_(size) {}

  void residuals(const Block& block, const double* parameters, double* out) const override {
    find(block.samples, block.count, parameters, out);
  }

  void residuals(const std::size_t* samples, std::size_t count, const Jet* parameters,
                 Jet* out) const override {
    find(samples, count, parameters, out);
  }

  Mask why_missing(std::size_t sample) const override {
    return model_.is_missing_needed(sample) ? Mask::missing : Mask::reference;
  }

 protected:
  const ModelOnSamples& law() const { return model_; }

 private:
  template <class S>
  void find(const std::size_t* samples, std::size_t count, const S* parameters, S* out) const {
    if (count == 0) return;
    const auto& derived = static_cast<const Derived&>(*this);
    const auto [least, greatest] = std::minmax_element(samples, samples + count);
    const Span span{*least - std::min(*least, derived.reach()),
                    std::min(*greatest + derived.reach() + 1, size_)};
    derived.find(span, samples, count, parameters, out);
  }

  const ModelOnSamples& model_;
  std::size_t size_;
};

}  // namespace pcor::internal

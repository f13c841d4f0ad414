#pragma once

#include <algorithm>
#include <cstddef>
#include <deque>
#include <utility>
#include <vector>

#include <pcor/flight/flight.hpp>

namespace pcor::internal {

/// The most recently read blocks of a file's slow variables, up to 4 MB: commands read each of these
/// variables several times, and the netCDF library needs longer for a request than for its values.
class BlockCache {
 public:
  /// Copies the numbers of a block to `out`, read by `read(out)` unless they are kept. @param count of
  /// numbers
  template <class Read>
  void read(int variable, RecordBlock block, std::size_t count, double* out, const Read& read) {
    const auto known = std::find_if(kept_.begin(), kept_.end(), [&](const Kept& each) {
      return each.variable == variable && each.first == block.first && each.numbers.size() == count;
    });
    if (known != kept_.end()) {
      std::copy(known->numbers.begin(), known->numbers.end(), out);
      return;
    }
    read(out);
    if (count > records_per_block) return;
    if (kept_.size() == max_blocks) kept_.pop_front();
    kept_.push_back({variable, block.first, {out, out + count}});
  }

 private:
  static constexpr std::size_t max_blocks = (std::size_t{4} << 20) / (records_per_block * sizeof(double));

  struct Kept {
    int variable;
    std::size_t first;
    std::vector<double> numbers;
  };

  std::deque<Kept> kept_{};
};

}  // namespace pcor::internal

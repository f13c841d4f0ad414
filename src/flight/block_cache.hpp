#pragma once

#include <algorithm>
#include <cstddef>
#include <list>
#include <vector>

#include <pcor/flight/flight.hpp>

namespace pcor::internal {

/// Recently read blocks of a file, of at most 4096 numbers each and 4 MB together. Commands read most
/// variables several times, and a request to the netCDF library takes longer than its values.
class BlockCache {
 public:
  static constexpr std::size_t capacity = std::size_t{1} << 19;  ///< numbers, 4 MB

  /// Copies the numbers of a block to `out`; `read(out)` reads a block that is not in the cache.
  /// @param count of numbers in the block
  template <class Read>
  void read(int variable, RecordBlock block, std::size_t count, double* out, const Read& read) {
    const auto known = std::find_if(blocks_.begin(), blocks_.end(), [&](const Block& each) {
      return each.variable == variable && each.first == block.first && each.numbers.size() == count;
    });
    if (known != blocks_.end()) {
      blocks_.splice(blocks_.end(), blocks_, known);
      std::copy(known->numbers.begin(), known->numbers.end(), out);
      return;
    }
    read(out);
    if (count > records_per_block) return;
    for (size_ += count; size_ > capacity; blocks_.pop_front()) size_ -= blocks_.front().numbers.size();
    blocks_.push_back({variable, block.first, {out, out + count}});
  }

 private:
  struct Block {
    int variable;
    std::size_t first;
    std::vector<double> numbers;
  };

  std::list<Block> blocks_{};  // least recently used first
  std::size_t size_ = 0;       // numbers in all blocks
};

}  // namespace pcor::internal

#include "flight/block_cache.hpp"

#include <gtest/gtest.h>

#include <stdexcept>
#include <vector>

namespace {

using pcor::RecordBlock;
using pcor::records_per_block;
using pcor::internal::BlockCache;

constexpr RecordBlock whole_block{0, records_per_block};
constexpr int max_blocks = BlockCache::capacity / records_per_block;

/// A file whose numbers state their variable and record; it counts the requests.
struct CountedFile {
  BlockCache cache{};
  int requests = 0;

  std::vector<double> read(int variable, RecordBlock block, std::size_t rate = 1) {
    std::vector<double> numbers(block.count * rate);
    cache.read(variable, block, numbers.size(), numbers.data(), [&](double* out) {
      ++requests;
      for (std::size_t i = 0; i < numbers.size(); ++i)
        out[i] = 1e6 * variable + static_cast<double>(block.first) + static_cast<double>(i / rate);
    });
    return numbers;
  }
};

TEST(BlockCache, ABlockIsRequestedOnce) {
  CountedFile file;
  const std::vector<double> first = file.read(3, {100, 50});
  EXPECT_EQ(file.read(3, {100, 50}), first);
  EXPECT_EQ(file.requests, 1);
}

TEST(BlockCache, OtherBlocksAreRequested) {
  CountedFile file;
  file.read(3, {0, 50});
  EXPECT_DOUBLE_EQ(file.read(3, {0, 40}).back(), 3e6 + 39);
  EXPECT_DOUBLE_EQ(file.read(3, {50, 50}).front(), 3e6 + 50);
  EXPECT_DOUBLE_EQ(file.read(4, {0, 50}).front(), 4e6);
  EXPECT_EQ(file.requests, 4);
}

TEST(BlockCache, LongBlocksAreNotKept) {
  CountedFile file;
  file.read(3, whole_block, 25);
  file.read(3, whole_block, 25);
  EXPECT_EQ(file.requests, 2);
}

TEST(BlockCache, KeepsBlocksUpToItsCapacity) {
  CountedFile file;
  for (int variable = 0; variable < max_blocks; ++variable) file.read(variable, whole_block);
  for (int variable = 0; variable < max_blocks; ++variable) file.read(variable, whole_block);
  EXPECT_EQ(file.requests, max_blocks);
}

TEST(BlockCache, ReplacesTheLeastRecentlyUsedBlock) {
  CountedFile file;
  for (int variable = 0; variable < max_blocks; ++variable) file.read(variable, whole_block);
  file.read(0, whole_block);
  file.read(max_blocks, whole_block);  // replaces variable 1
  file.read(0, whole_block);
  EXPECT_EQ(file.requests, max_blocks + 1);
  EXPECT_DOUBLE_EQ(file.read(1, whole_block).front(), 1e6);
  EXPECT_EQ(file.requests, max_blocks + 2);
}

TEST(BlockCache, AFailedReadIsNotKept) {
  CountedFile file;
  double number = 0.0;
  EXPECT_THROW(file.cache.read(3, {0, 1}, 1, &number, [](double*) { throw std::runtime_error("damaged"); }),
               std::runtime_error);
  file.read(3, {0, 1});
  EXPECT_EQ(file.requests, 1);
}

}  // namespace

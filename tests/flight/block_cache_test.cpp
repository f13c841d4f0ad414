#include "flight/block_cache.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

namespace {

using pcor::RecordBlock;
using pcor::internal::BlockCache;

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
  EXPECT_EQ(file.read(3, {0, 40}).size(), 40U);
  EXPECT_DOUBLE_EQ(file.read(3, {50, 50}).front(), 3e6 + 50);
  EXPECT_DOUBLE_EQ(file.read(4, {0, 50}).front(), 4e6);
  EXPECT_EQ(file.requests, 4);
}

TEST(BlockCache, BlocksOfFastSeriesAreNotKept) {
  CountedFile file;
  file.read(3, {0, pcor::records_per_block}, 25);
  file.read(3, {0, pcor::records_per_block}, 25);
  EXPECT_EQ(file.requests, 2);
}

TEST(BlockCache, TheOldestBlocksAreReplaced) {
  CountedFile file;
  constexpr int many = 1000;  // 1000 blocks of 32 kB are 32 MB, and the cache keeps 4 MB
  for (int variable = 0; variable < many; ++variable) file.read(variable, {0, pcor::records_per_block});
  file.read(many - 1, {0, pcor::records_per_block});
  EXPECT_EQ(file.requests, many);
  EXPECT_DOUBLE_EQ(file.read(0, {0, pcor::records_per_block}).back(), pcor::records_per_block - 1.0);
  EXPECT_EQ(file.requests, many + 1);
}

}  // namespace

#include "numerics/parallel_for.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <stdexcept>
#include <vector>

namespace pcor::internal {
namespace {

TEST(InParallel, EachIndexIsCalledOnceForAnyNumberOfThreads) {
  for (const std::size_t threads : {std::size_t{0}, std::size_t{1}, std::size_t{3}, std::size_t{200}}) {
    std::vector<int> calls(100, 0);
    parallel_for(calls.size(), threads, [&](std::size_t i) { ++calls[i]; });
    EXPECT_EQ(calls, std::vector<int>(100, 1)) << threads << " threads";
  }
  parallel_for(0, 4, [](std::size_t) { FAIL() << "no function is called"; });
}

TEST(InParallel, ExceptionIsRethrownAfterAllThreadsEnd) {
  std::atomic<int> running = 0;
  const auto work = [&](std::size_t i) {
    ++running;
    if (i == 5) {
      --running;
      throw std::runtime_error("the sixth");
    }
    --running;
  };
  for (const std::size_t threads : {std::size_t{1}, std::size_t{4}}) {
    EXPECT_THROW(parallel_for(1000, threads, work), std::runtime_error);
    EXPECT_EQ(running, 0);
  }
}

TEST(InParallel, FailurePreventsFurtherCalls) {
  std::atomic<int> begun = 0;
  EXPECT_THROW(parallel_for(1000, 1,
                            [&](std::size_t) {
                              ++begun;
                              throw std::runtime_error("the first");
                            }),
               std::runtime_error);
  EXPECT_EQ(begun, 1);
}

}  // namespace
}  // namespace pcor::internal

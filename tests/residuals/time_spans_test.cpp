#include "residuals/time_spans.hpp"

#include <gtest/gtest.h>

#include <vector>

using pcor::internal::marked_runs;
using pcor::internal::times_of;

TEST(TimeSpans, ListsTheFirstAndTheLastSampleOfEachRun) {
  std::vector<double> time;
  for (int i = 0; i < 10; ++i) time.push_back(i);
  EXPECT_EQ(times_of(marked_runs({false, true, true, false, true}), time), "00:00:01-00:00:02, 00:00:04 UTC");
  EXPECT_TRUE(marked_runs({false, false}).empty());
}

TEST(TimeSpans, CountsTheRunsBeyondSix) {
  std::vector<bool> marked;
  std::vector<double> time;
  for (int i = 0; i < 16; ++i) {
    marked.push_back(i % 2 == 0);
    time.push_back(i);
  }
  EXPECT_EQ(times_of(marked_runs(marked), time),
            "00:00:00, 00:00:02, 00:00:04, 00:00:06, 00:00:08, 00:00:10 and 2 more spans UTC");
}

#include "numerics/binned_residual.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <functional>
#include <numeric>
#include <random>
#include <utility>
#include <vector>

#include "support/constants.hpp"

namespace pcor::internal {
namespace {

constexpr double whole = 1000.0;  // bins for the sum over a flight

std::vector<double> each_second(std::size_t count) {
  std::vector<double> time(count);
  std::iota(time.begin(), time.end(), 0.0);
  return time;
}

/// Autoregression of first order, sampled each second. @param level rms of the innovations at each time
std::vector<double> noise(std::size_t count, double memory, const std::function<double(double)>& level,
                          unsigned seed = 1) {
  std::mt19937_64 engine(seed);
  std::normal_distribution<double> normal;
  std::vector<double> values;
  double last = 0.0;
  for (std::size_t i = 0; i < count; ++i) {
    last = memory * last + level(static_cast<double>(i)) * normal(engine);
    values.push_back(last);
  }
  return values;
}

double error_of_mean(const std::vector<double>& values, double max_bins) {
  const BinnedResidual binned(values, each_second(values.size()), 1.0, max_bins);
  std::vector<std::size_t> used;
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (!std::isnan(values[i])) used.push_back(i);
  }
  return std::sqrt(binned.variance_of_sum(used, binned.noise_about_mean())) /
         static_cast<double>(used.size());
}

}  // namespace

// Without a level for each five minutes the error of the last series was twice as large.
TEST(BinnedResidual, WideBinsGiveTheErrorOfTheMean) {
  constexpr std::size_t count = 21600;  // six hours of 1 s
  const auto steady = [](double) { return 0.1; };
  const auto turbulent = [](double time) { return std::fmod(time, 7200.0) < 1800.0 ? 1.0 : 0.1; };
  for (const auto& [memory, level] :
       {std::pair<double, std::function<double(double)>>{0.0, steady}, {0.9, steady}, {0.7, turbulent}}) {
    double wide = 0.0;
    double usual = 0.0;
    for (unsigned seed = 1; seed <= 20; ++seed) {
      const std::vector<double> values = noise(count, memory, level, seed);
      wide += std::pow(error_of_mean(values, whole), 2);
      usual += std::pow(error_of_mean(values, test::infinity), 2);
    }
    // The possible sizes of drift are relative to the rms of the bins, so errors differ by up to 22 % in 20
    // seeds.
    EXPECT_NEAR(std::sqrt(wide / usual), 1.0, 0.35) << memory;
  }
}

TEST(BinnedResidual, WideBinsAreFewer) {
  const std::vector<double> values = noise(36000, 0.5, [](double) { return 0.1; });
  EXPECT_EQ(BinnedResidual(values, each_second(values.size()), 1.0).bins().size(), 9000U);
  const BinnedResidual wide(values, each_second(values.size()), 1.0, whole);
  EXPECT_EQ(wide.bins().width(), Binning::max_width);
  EXPECT_EQ(wide.bins().size(), 2400U);
}

// Wide bins, which need half of their records, would have left out all of these.
TEST(BinnedResidual, SparseRecordsStayInBins) {
  std::vector<double> values = noise(36000, 0.5, [](double) { return 0.1; });
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (i % 5 > 1) values[i] = test::missing;
  }
  EXPECT_EQ(error_of_mean(values, whole), error_of_mean(values, test::infinity));
}

}  // namespace pcor::internal

#include <gtest/gtest.h>
#include <pcor/model/scaling.hpp>

#include <cmath>
#include <limits>

using pcor::factor;
using pcor::Scaling;

TEST(Scaling, IsOneAtReferencePressures) {
  // To rounding: 700 times the quotient 1/700 is not quite 1.
  for (const Scaling& scaling : {Scaling{}, Scaling{1, 0}, Scaling{0, -2}, Scaling{-3, 3}})
    EXPECT_NEAR(factor(scaling, 700.0, 70.0), 1.0, 1e-15);
}

TEST(Scaling, IsOneWithoutExponents) {
  EXPECT_TRUE(Scaling{}.is_none());
  EXPECT_EQ(factor(Scaling{}, 250.0, 121.0), 1.0);
}

TEST(Scaling, IsAProductOfPressurePowers) {
  // 350 hPa is half of 700, 140 hPa twice 70.
  EXPECT_NEAR(factor(Scaling{1, 0}, 350.0, 70.0), 0.5, 1e-15);
  EXPECT_NEAR(factor(Scaling{-1, 0}, 350.0, 70.0), 2.0, 1e-15);
  EXPECT_NEAR(factor(Scaling{0, 3}, 700.0, 140.0), 8.0, 1e-14);
  EXPECT_NEAR(factor(Scaling{-1, 1}, 350.0, 140.0), 4.0, 1e-14);
}

TEST(Scaling, RequiresItsPressure) {
  const double missing = std::numeric_limits<double>::quiet_NaN();
  EXPECT_TRUE(std::isnan(factor(Scaling{1, 0}, missing, 70.0)));
  EXPECT_TRUE(std::isnan(factor(Scaling{0, -1}, 700.0, missing)));
}

TEST(Scaling, EqualityComparesExponents) {
  EXPECT_TRUE((Scaling{-1, 1} == Scaling{-1, 1}));
  EXPECT_FALSE((Scaling{-1, 1} == Scaling{1, -1}));
  EXPECT_FALSE((Scaling{0, 1} == Scaling{}));
}

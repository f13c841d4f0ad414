#include <gtest/gtest.h>
#include <pcor/physics/flow_angles.hpp>

#include <cmath>
#include <limits>

using pcor::RadomeCalibration;

// The angles of attack of tables worked from the memo, to their digit of 0.1 deg.

TEST(RadomeCalibration, ReproducesTheC130Angles) {
  const RadomeCalibration radome{5.776, 15.031, 0.0};
  EXPECT_TRUE(radome.is_calibrated());
  EXPECT_FALSE(radome.needs_mach());
  for (const auto& [ratio, attack] :
       {std::pair{0.024, 6.1}, {-0.124, 3.9}, {-0.289, 1.4}, {-0.318, 1.0}, {-0.435, -0.8}})
    EXPECT_NEAR(radome(ratio), attack, 0.06) << ratio;
}

TEST(RadomeCalibration, ReproducesTheGvAnglesWithMachNumber) {
  const RadomeCalibration radome{5.5156, 19.07, 2.08};
  EXPECT_TRUE(radome.needs_mach());
  // ADIFR and q of the tables at (p, M): (850, 0.45), (500, 0.60), (250, 0.78).
  EXPECT_NEAR(radome(-15.9 / 126.7, 0.45), 3.0, 0.06);
  EXPECT_NEAR(radome(-20.4 / 137.8, 0.60), 2.5, 0.06);
  EXPECT_NEAR(radome(-18.0 / 123.7, 0.78), 2.5, 0.06);
}

TEST(RadomeCalibration, RequiresASlope) {
  EXPECT_FALSE(RadomeCalibration{}.is_calibrated());
  EXPECT_FALSE((RadomeCalibration{2.0, 0.0, 0.0}.is_calibrated()));
  EXPECT_TRUE((RadomeCalibration{0.0, 0.0, 2.0}.is_calibrated()));
}

TEST(RadomeCalibration, BothFormsAgreeWithoutMachNumber) {
  const RadomeCalibration radome{5.776, 15.031, 0.0};
  EXPECT_EQ(radome(-0.2, 0.7), radome(-0.2));
}

TEST(RadomeCalibration, MissingRatioGivesNan) {
  EXPECT_TRUE(std::isnan(RadomeCalibration{5.776, 15.031, 0.0}(std::numeric_limits<double>::quiet_NaN())));
}

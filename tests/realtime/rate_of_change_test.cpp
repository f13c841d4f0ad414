#include <pcor/realtime/rate_of_change.hpp>

#include <gmock/gmock.h>

#include <cmath>
#include <limits>

namespace {

using pcor::Quality;
using pcor::QualityFlags;
using pcor::Quantity;
using pcor::RateOfChange;
using pcor::State;
using testing::ElementsAre;
using testing::IsNan;

constexpr double missing = std::numeric_limits<double>::quiet_NaN();
constexpr double infinity = std::numeric_limits<double>::infinity();

class RateOfChangeTest : public testing::Test {
 protected:
  double rate(double time, double value) {
    State<double> state;
    state[Quantity::time] = time;
    state[Quantity::static_pressure] = value;
    flags.clear();
    functor.compute(state, flags);
    return state[Quantity::static_pressure_rate];
  }

  RateOfChange functor{Quantity::static_pressure, Quantity::static_pressure_rate};
  QualityFlags flags;
};

TEST_F(RateOfChangeTest, DeclaresWhatItReadsAndWrites) {
  EXPECT_THAT(functor.inputs(), ElementsAre(Quantity::time, Quantity::static_pressure));
  EXPECT_THAT(functor.outputs(), ElementsAre(Quantity::static_pressure_rate));
}

TEST_F(RateOfChangeTest, IsTheDifferenceOverTheStep) {
  rate(10.0, 700.0);
  EXPECT_DOUBLE_EQ(rate(10.5, 699.0), -2.0);
  EXPECT_FALSE(flags.has(Quality::after_gap));
  EXPECT_DOUBLE_EQ(rate(14.5, 701.0), 0.5);
  EXPECT_DOUBLE_EQ(rate(15.5, 701.0), 0.0);
}

TEST_F(RateOfChangeTest, IsThatOfTheMiddleOfTheStep) {
  const auto pressure = [](double t) { return 700.0 - 0.9 * t + 0.05 * t * t; };
  rate(3.0, pressure(3.0));
  EXPECT_NEAR(rate(4.0, pressure(4.0)), -0.9 + 0.1 * 3.5, 1e-12);
}

TEST_F(RateOfChangeTest, IsUnknownAtTheStartAndAfterAReset) {
  EXPECT_THAT(rate(0.0, 700.0), IsNan());
  EXPECT_TRUE(flags.has(Quality::after_gap));
  EXPECT_DOUBLE_EQ(rate(1.0, 699.0), -1.0);
  functor.reset();
  EXPECT_THAT(rate(2.0, 698.0), IsNan());
  EXPECT_TRUE(flags.has(Quality::after_gap));
}

TEST_F(RateOfChangeTest, StartsAnewAfterAValueThatIsNone) {
  for (const double garbage : {missing, infinity, -infinity}) {
    rate(0.0, 700.0);
    EXPECT_THAT(rate(1.0, garbage), IsNan());
    EXPECT_FALSE(flags.has(Quality::after_gap)) << "the value itself is missing";
    EXPECT_THAT(rate(2.0, 698.0), IsNan());
    EXPECT_TRUE(flags.has(Quality::after_gap));
    EXPECT_DOUBLE_EQ(rate(3.0, 697.0), -1.0);
    EXPECT_EQ(flags.bits(), 0U);
    functor.reset();
  }
}

}  // namespace

#include <gmock/gmock.h>
#include <pcor/fit/refit_report.hpp>

#include <cmath>

namespace pcor {
namespace {

using testing::AllOf;
using testing::Contains;
using testing::HasSubstr;
using testing::Not;

/// A fit to one flight with another one held out. @param rms_before of each, hPa
RefitResult fit_with_holdout(double rms_before) {
  RefitResult result;
  result.rms_before = rms_before;
  result.rms = 0.375;
  result.noise_rms = 0.25;
  FlightFit held_out;
  held_out.flight = "later.nc";
  held_out.holdout = true;
  held_out.before.rms = rms_before;
  held_out.after.samples = 1000;
  held_out.after.rms = 0.5;
  result.flights = {held_out};
  return result;
}

/// The report of a fit, with a comparison that has no samples.
Report report_of(const RefitResult& result) {
  Comparison comparison;
  comparison.models.resize(1);
  return refit_report(result, comparison);
}

TEST(RefitReport, TitleAndSummaryStateRmsBeforeAndAfter) {
  const Report report = report_of(fit_with_holdout(1.25));
  EXPECT_THAT(report.title, AllOf(HasSubstr("1.250"), HasSubstr("0.375"), HasSubstr("0.250")));
  EXPECT_THAT(report.summary, Contains(AllOf(HasSubstr("later.nc"), HasSubstr("1.250"), HasSubstr("0.500"))));
}

TEST(RefitReport, TitleStatesAnUnchangedRmsOnceAndTheErrorByGps) {
  RefitResult result = fit_with_holdout(0.3751);
  result.defect_error = 4.4;
  EXPECT_THAT(report_of(result).title,
              AllOf(HasSubstr("does not change"), HasSubstr("residual of 0.375 hPa"), HasSubstr("4.40 hPa")));
}

TEST(RefitReport, UnknownRmsBeforeIsOmitted) {
  const Report report = report_of(fit_with_holdout(std::nan("")));
  EXPECT_THAT(report.title, AllOf(HasSubstr("0.375"), HasSubstr("0.250"), Not(HasSubstr("nan"))));
  EXPECT_THAT(report.summary,
              Contains(AllOf(HasSubstr("later.nc"), HasSubstr("0.500"), Not(HasSubstr("nan")))));
}

}  // namespace
}  // namespace pcor

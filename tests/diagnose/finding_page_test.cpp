// Text shared by reports of a diagnosis.
#include "diagnose/finding_page.hpp"

#include <gmock/gmock.h>

#include <string>

namespace pcor::internal::report {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

TEST(UnexplainedText, StatesTheLocationsOfTheResult) {
  Unexplained unexplained;
  unexplained.significant = true;
  EmpiricalPredictor& predictor = unexplained.variables.emplace_back();
  predictor.name = "ENGTRQ";
  predictor.formula = "k * (ENGTRQ - 60)";
  EXPECT_THAT(unexplained_text(unexplained).at(1), AllOf(HasSubstr("location of the error is unknown"),
                                                         HasSubstr("added to the static pressure")));
  predictor.components = {"pitot", "q-transducer"};
  predictor.location = EffectLocation::pitot;
  EXPECT_THAT(unexplained_text(unexplained).at(1),
              AllOf(HasSubstr("one of: pitot, q-transducer"), HasSubstr("added to the total pressure"),
                    Not(HasSubstr("is unknown")), Not(HasSubstr("static pressure"))));
}

}  // namespace
}  // namespace pcor::internal::report

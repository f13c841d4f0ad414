#include <pcor/residuals/reference.hpp>

#include <gmock/gmock.h>

#include <filesystem>
#include <string>

#include <pcor/base/error.hpp>

#include "support/error_of.hpp"

namespace pcor {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

const std::filesystem::path data = std::filesystem::path(PCOR_SOURCE_DIR) / "data";

ModelDefinition with_laser() { return read_model(data / "scenarios" / "models" / "c130-psfd-eq18.toml"); }
ModelDefinition without_laser() { return read_model(data / "models" / "c130-psfd-eq18.toml"); }

std::optional<Error> refusal(const std::string& text, const ModelDefinition& model) {
  return test::error_of([&] { read_reference(text, model); });
}

TEST(Reference, IsReadFromItsName) {
  EXPECT_EQ(read_reference("lams", with_laser())->description(), "LAMS");
  EXPECT_THAT(read_reference("pressure:PS_A", without_laser())->variables(), ElementsAre("PS_A"));
  const std::string file = (data / "models" / "c130-psfrd-eq18.toml").string();
  EXPECT_EQ(read_reference("static:" + file, without_laser())->model()->model.name,
            read_model(file).model.name);
}

TEST(Reference, UnknownTextIsRefusedWithTheValidForms) {
  for (const char* form : {"lams (", ", static:OTHER.toml (", ", pressure:VARIABLE (", ", total:OTHER.toml (",
                           ", height (", " or wind ("})
    EXPECT_THAT(reference_forms(), HasSubstr(form));
  for (const char* text :
       {"static:", "pressure:", "lams:", "lams:V", "wind:", "total", "PS_A", ":", "static", "LAMS"})
    EXPECT_THAT(refusal(text, with_laser()), test::IsError(Error::Code::usage, reference_forms())) << text;
  EXPECT_THAT(refusal("static:absent.toml", with_laser()), test::IsError(Error::Code::file, "absent.toml"));
}

TEST(Reference, LaserMissingFromTheModelIsRefused) {
  EXPECT_THAT(refusal("lams", without_laser()),
              test::IsError(Error::Code::model, "lams_airspeed", "static:OTHER.toml"));
}

TEST(Reference, ListsItsVariables) {
  EXPECT_TRUE(lams_reference()->reads_laser());
  EXPECT_TRUE(lams_reference()->variables().empty());
  EXPECT_EQ(lams_reference()->model(), nullptr);
  const auto system = static_system_reference(with_laser());
  EXPECT_FALSE(system->reads_laser()) << "the laser belongs to the model that is compared with it";
  EXPECT_THAT(system->variables(), testing::IsSupersetOf({"PSFD", "QCF", "ADIFR", "QCR"}));
}

}  // namespace
}  // namespace pcor

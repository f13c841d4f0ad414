#include <pcor/roles/model_candidates.hpp>

#include <gmock/gmock.h>

#include <filesystem>
#include <fstream>
#include <string>

#include "support/netcdf_file.hpp"
#include "support/temporary_directory.hpp"

namespace pcor {
namespace {

LawInfo law(const std::string& from, const std::string& to, bool operational = false) {
  LawInfo info;
  info.valid_from = from;
  info.valid_to = to;
  info.operational = operational;
  info.note = "rms 0.3 hPa";
  return info;
}

TEST(ModelCandidates, DoubtIsAboutDatesThatTheLawOmits) {
  EXPECT_EQ(doubt_of_dates(law("2003-10-01", "2012-01-06")), "");
  EXPECT_EQ(doubt_of_dates(law("", "2012-01-06")), "beginning not stated; note: rms 0.3 hPa");
  EXPECT_EQ(doubt_of_dates(law("2011-11-17", "")), "end not stated");
  EXPECT_EQ(doubt_of_dates(law("", "")), "dates not stated; note: rms 0.3 hPa");
  EXPECT_EQ(doubt_of_dates(law("", "2012-01-06", true)), "") << "the operator states that it applies";
}

TEST(ModelCandidates, LawWithBothDatesIsFirst) {
  const test::TemporaryDirectory folder;
  const std::filesystem::path path = folder / "flight.nc";
  {
    test::NetcdfMaker maker(path);
    maker.text(NC_GLOBAL, "Platform", "N130AR");
    maker.time(test::sequence(0, 60));
    maker.series("PSFD", "hPa", test::sequence(700.0, 60));
    maker.series("QCF", "hPa", test::sequence(60.0, 60));
  }
  std::vector<std::filesystem::path> models;
  for (const auto& [name, begin] :
       {std::pair("a-open", ""), std::pair("b-dated", "valid_from = \"1970-01-01\"")}) {
    models.push_back(folder / (std::string(name) + ".toml"));
    std::ofstream(models.back()) << "format = \"pcor-model/1\"\nname = \"" << name
                                 << "\"\naircraft = \"N130AR\"\n[variables]\nstatic_pressure = \"PSFD\"\n"
                                    "dynamic_pressure = \"QCF\"\n[law]\nvalid_to = \"2100-01-01\"\n"
                                 << begin << "\n";
  }
  Notes notes;
  EXPECT_EQ(applicable_text(model_candidates(Flight(path), models, notes)),
            "b-dated, a-open (beginning not stated)");
  EXPECT_THAT(notes, testing::IsEmpty());
}

}  // namespace
}  // namespace pcor

// Tests of the cloud fields of radiative transfer programs. They check the values, heights and
// radii of each documented layout, and what is assumed. Each malformed line must give one error
// that names the line.
#include "storm_files/cloud_text.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <fstream>
#include <random>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_replace.h"
#include "storm_files/at3d_format.h"
#include "storm_files/mystic_format.h"
#include "storm_files/number_text.h"
#include "storm_files/shdom_format.h"
#include "storm_files/storm_format.h"
#include "tests/support/temporary_folder.h"

namespace thunderhead::storm_files {
namespace {

using physics::Hydrometeor;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;
using testing::TemporaryFolder;
using volume::HydrometeorFields;

// A file as AT3D writes it, with levels 100 m apart. The first and the last level are clear.
constexpr char kParticlesText[] =
    "2 parameter LWC file\n"
    " 2 3 4\n"
    "0.05 0.02\n"
    "0.5 0.6 0.7 0.8\n"
    "290.00 289.00 288.00 287.00\n"
    "1 1 2 0.5000 10.00\n"
    "2 3 3 0.2500 5.00\n"
    "1 1 1 0.0 0.0\n";

constexpr char kMysticText[] =
    "# a cloud\n"
    "2 1 2 3   % cells and flag\n"
    "0.1 0.2 0.0 0.3 0.4\n"
    "1 1 1 0.5 10\n"
    "2 1 2 0.25 20\n";

constexpr char kTableText[] =
    "# An isolated cloud\n"
    "2,3,4      # nx,ny,nz\n"
    "0.020,0.040   # dx,dy [km, km]\n"
    "0.5,0.6,0.7,0.8  # altitude levels [km]\n"
    "x,y,z,lwc,reff\n"
    "0,0,1,0.5,10\n"
    "1,2,2,0.25,5\n";

constexpr char kPlainText[] =
    "# Cloud of a distribution\n"
    "2 3 4\n"
    "0.02 0.04 0.5 0.6 0.7 0.8\n"
    "0 0 1 0.5 10\n"
    "1 2 2 0.25 5\n";

constexpr char kComponentsText[] =
    "3\n"
    "1 1 4\n"
    "1.0 1.0\n"
    "1.0 2.0 9.0 10.0\n"
    "285 280 230 225\n"
    "1 1 2  1  7 0.5 10\n"
    "1 1 3  2  7 0.0 10  4 0.02 40\n"
    "1 1 4  0\n";

constexpr char kStandardText[] =
    "2 1 2\n"
    "0.1 0.1 0.0 0.2\n"
    "1 1 1 280.0 3.0 0.99 2 2.5\n"
    "1.0\n"
    "2 1 2 270.0 5.0 0.99 0\n";

constexpr char kTabulatedText[] =
    "T   tabulated phase function\n"
    "1 2 2\n"
    "0.1 0.1 0.0 0.2\n"
    "2\n"
    "1 2.5\n"
    "3 2.5 1.0\n"
    "0.5\n"
    "1 2 1 280.0 4.0 0.99 1\n";

constexpr char kPolarizedText[] =
    "P\n"
    "1 2 2\n"
    "0.1 0.1 0.0 0.2\n"
    "1\n"
    "1 1 1.0 2.5\n2 1 1.0 2.5\n3 1 1.0 2.5\n4 1 1.0 2.5\n5 1 0 0\n6 1 0 0\n"
    "1 2 1 280.0 4.0 0.99 1\n";

constexpr char kExtinctionOnlyText[] =
    "E\n"
    "2 1 2\n"
    "0.1 0.1 0.0 0.2\n"
    "280 270\n"
    "0.99 2 2.5 1.0\n"
    "1 2 7.0\n";

class CloudText : public ::testing::Test {
 protected:
  absl::StatusOr<StormFile> Describe(const std::string& text) {
    std::ofstream(path_, std::ios::binary) << text;
    return StormFormats::BuiltIn().Describe(path_);
  }

  HydrometeorFields Read(const std::string& text) {
    auto file = Describe(text);
    EXPECT_TRUE(file.ok()) << file.status();
    if (!file.ok()) return {};
    file_ = *std::move(file);
    auto fields = file_.reader->Read(0, std::nullopt, {});
    EXPECT_TRUE(fields.ok()) << fields.status();
    return fields.ok() ? *std::move(fields) : HydrometeorFields();
  }

  // Returns the amount in a cell, in kg m-3 or m-1.
  static float At(const HydrometeorFields& fields, int x, int y, int z, std::size_t field = 0) {
    return fields.fields.at(field).concentration_kg_per_m3.at(fields.grid.Offset(x, y, z));
  }

  static float Radius_m(const HydrometeorFields& fields, int x, int y, int z,
                        std::size_t field = 0) {
    return 1.0F /
           volume::InverseRadius_per_m(fields.fields.at(field).sizes, fields.grid.Offset(x, y, z));
  }

  void ExpectError(const std::string& text, const std::string& what) {
    const absl::Status status = Describe(text).status();
    EXPECT_TRUE(absl::IsInvalidArgument(status)) << status << "\n" << text;
    EXPECT_THAT(std::string(status.message()), HasSubstr(path_ + ": " + what));
  }

  TemporaryFolder folder_;
  std::string path_ = folder_.File("cloud.txt");
  StormFile file_;
};

TEST_F(CloudText, ReadsGridPointsOfShdom) {
  const HydrometeorFields fields = Read(kParticlesText);
  EXPECT_EQ(fields.grid.cells, glm::ivec3(2, 3, 4));
  EXPECT_EQ(fields.grid.spacing_m.x, 50.0);
  EXPECT_EQ(fields.grid.spacing_m.y, 20.0);
  EXPECT_NEAR(fields.grid.spacing_m.z, 100.0, 1e-4);
  EXPECT_NEAR(fields.grid.low_corner_m.z, 450.0, 1e-4);
  EXPECT_FLOAT_EQ(At(fields, 0, 0, 1), 0.5e-3F);
  EXPECT_FLOAT_EQ(At(fields, 1, 2, 2), 0.25e-3F);
  EXPECT_EQ(At(fields, 1, 1, 1), 0.0F);
  EXPECT_NEAR(Radius_m(fields, 0, 0, 1), 10e-6F, 1e-8F);
  EXPECT_NEAR(Radius_m(fields, 1, 2, 2), 5e-6F, 1e-8F);
  EXPECT_THAT(file_.fields, ElementsAre(Hydrometeor::kCloud));
  EXPECT_EQ(file_.about, "SHDOM particle file of type 2");
  EXPECT_THAT(file_.times, SizeIs(1));
  EXPECT_FALSE(file_.latitude_deg.has_value());
}

TEST_F(CloudText, SaysWhatItAssumes) {
  Read(kParticlesText);
  EXPECT_THAT(file_.assumptions,
              ElementsAre("Distances are in km, masses in g m-3 and radii in um.",
                          "Its 4 heights are those of grid points, half-way between which layers "
                          "end.",
                          "The x axis is taken as east, and the y axis as north.",
                          "Indices count from 1, because one is as large as the grid."));
  Read("2 parameter LWC file\n9 9 4\n0.1 0.1\n0 1 2 3\n4*280\n1 1 2 0.1 10\n");
  EXPECT_THAT(file_.assumptions, Contains("Indices count from 1, as in SHDOM, because none is 0 or "
                                          "as large as the grid."));
}

// The medium ends at the first and the last grid point, between which it varies linearly.
TEST_F(CloudText, KeepsTheMassOfCloudThatReachesTheEnds) {
  const HydrometeorFields fields = Read(
      "2\n1 1 3\n1 1\n0 0.1 0.3\n3*280\n"
      "1 1 1 0.2 10\n1 1 2 0.4 10\n1 1 3 0.6 10\n");
  EXPECT_EQ(fields.grid.low_corner_m.z, 0.0);
  const double trapezoids = 1e-3 * (0.3 * 100.0 + 0.5 * 200.0);
  EXPECT_NEAR(fields.fields[0].statistics.mean_water_path_kg_per_m2, trapezoids, 1e-6);
}

TEST_F(CloudText, ReadsFacesOfTheI3rcModel) {
  const HydrometeorFields fields = Read(
      "1   [format type]\n1 1 2   [number of cells]\n0.5 0.5\n0.2 0.4 0.6\n290 289 288\n"
      "1 1 2 0.3\n");
  EXPECT_EQ(fields.grid.cells, glm::ivec3(1, 1, 2));
  EXPECT_NEAR(fields.grid.low_corner_m.z, 200.0, 1e-4);
  EXPECT_NEAR(fields.grid.spacing_m.z, 200.0, 1e-4);
  EXPECT_FLOAT_EQ(At(fields, 0, 0, 1), 0.3e-3F);
  EXPECT_EQ(fields.fields[0].sizes.origin, volume::SizeOrigin::kObserved);
  EXPECT_THAT(file_.assumptions, Contains("Its 3 heights are the faces of layers."));
  EXPECT_THAT(file_.assumptions, Contains(HasSubstr("The file has no radii")));
}

TEST_F(CloudText, ReadsNumbersAsFortranDoes) {
  const HydrometeorFields fields = Read(
      "2, a cloud\r\n2,3,4\r\n\r\n5.0D-2\n2e-2\n0.5\t0.6\n0.7 0.8\n2*290.0 289.0\n+288.0\n"
      "1,1,2,5.0d-1,1.0E+01\r\n2 3 3 .25 5. end");
  EXPECT_EQ(fields.grid.spacing_m.x, 50.0);
  EXPECT_EQ(fields.grid.spacing_m.y, 20.0);
  EXPECT_FLOAT_EQ(At(fields, 0, 0, 1), 0.5e-3F);
  EXPECT_FLOAT_EQ(At(fields, 1, 2, 2), 0.25e-3F);
}

TEST_F(CloudText, TheLastLineForAPointCounts) {
  const HydrometeorFields fields = Read(absl::StrCat(kParticlesText, "1 1 2 0.75 8\n"));
  EXPECT_FLOAT_EQ(At(fields, 0, 0, 1), 0.75e-3F);
  EXPECT_NEAR(Radius_m(fields, 0, 0, 1), 8e-6F, 1e-8F);
}

TEST_F(CloudText, AMissingValueIsNoCloud) {
  const HydrometeorFields fields = Read(absl::StrCat(kParticlesText, "2 1 2 nan nan\n"));
  EXPECT_EQ(At(fields, 1, 0, 1), 0.0F);
  EXPECT_FLOAT_EQ(At(fields, 0, 0, 1), 0.5e-3F);
}

TEST_F(CloudText, TellsTypesOfParticlesApartByTemperature) {
  const HydrometeorFields fields = Read(kComponentsText);
  EXPECT_THAT(file_.fields, ElementsAre(Hydrometeor::kCloud, Hydrometeor::kIce));
  ASSERT_THAT(fields.fields, SizeIs(2));
  EXPECT_NEAR(fields.fields[0].statistics.maximum, 0.5e-3, 1e-9);
  EXPECT_NEAR(fields.fields[1].statistics.maximum, 0.02e-3, 1e-9);
  EXPECT_NEAR(fields.fields[0].sizes.mean_radius_m, 10e-6F, 1e-8F);
  EXPECT_NEAR(fields.fields[1].sizes.mean_radius_m, 40e-6F, 1e-8F);
  EXPECT_THAT(file_.assumptions, Contains("Distances are in km, masses in g m-3 and radii in um."));
  EXPECT_THAT(
      file_.assumptions,
      Contains("Particles of type 4 are taken as cloud ice, because some are colder than -40 C."));
  EXPECT_THAT(
      file_.assumptions,
      Contains("Particles of type 7 are taken as cloud water, because some are warmer than 0 C."));
}

TEST_F(CloudText, RefusesTypesThatCannotBeToldApart) {
  const std::string header = "3\n1 1 2\n1 1\n0 1\n";
  const std::string points = "1 1 1 1 1 0.1 10\n1 1 2 1 2 0.1 10\n";
  ExpectError(header + "290 280\n" + points, "its types of particles have only numbers, and by");
  ExpectError(header + "290 260\n" + points,
              "its types of particles have only numbers, and the temperatures at which type 2");
  ExpectError(header + "2*220\n" + points, "its types of particles have only numbers, and by");
  Read(header + "260 260\n1 1 1 1 1 0.1 10\n");
  EXPECT_THAT(
      file_.assumptions,
      Contains("Particles of type 1 are taken as cloud water, because there is no other type."));
}

TEST_F(CloudText, ReadsExtinctionOfPropertyFiles) {
  const std::pair<const char*, float> files[] = {{kTabulatedText, 4e-3F},
                                                 {kPolarizedText, 4e-3F},
                                                 {kExtinctionOnlyText, 7e-3F},
                                                 {kStandardText, 5e-3F}};
  for (const auto& [text, maximum] : files) {
    SCOPED_TRACE(text);
    const HydrometeorFields fields = Read(text);
    ASSERT_THAT(fields.fields, SizeIs(1));
    EXPECT_EQ(fields.fields[0].quantity, volume::Quantity::kExtinction);
    EXPECT_FLOAT_EQ(fields.fields[0].statistics.maximum, maximum);
    EXPECT_EQ(file_.about, "SHDOM property file");
    EXPECT_THAT(file_.assumptions, Contains("Distances are in km and extinction in km-1."));
    EXPECT_THAT(file_.assumptions,
                Contains("The layout names no unit of length. It is taken as km."));
  }
  EXPECT_FLOAT_EQ(Read(kTabulatedText).fields[0].statistics.maximum_water_path_kg_per_m2,
                  4e-3 * 100);
}

TEST_F(CloudText, AnExtinctionFileWithRowsHasAnIndexAlongY) {
  const HydrometeorFields fields = Read("E\n1 2 3\n0.1 0.1 0.0 0.2 0.4\n3*280\n1.0 0\n1 2 2 7.0\n");
  EXPECT_FLOAT_EQ(At(fields, 0, 1, 1), 7e-3F);
}

TEST_F(CloudText, ReadsTheFlagsOfMystic) {
  const HydrometeorFields water = Read(kMysticText);
  EXPECT_EQ(file_.about, "MYSTIC cloud file");
  EXPECT_EQ(water.grid.spacing_m.y, 200.0);
  EXPECT_EQ(water.fields[0].quantity, volume::Quantity::kMassConcentration);
  EXPECT_NEAR(water.fields[0].statistics.maximum_water_path_kg_per_m2, 0.5e-3 * 300.0, 1e-6);
  EXPECT_FLOAT_EQ(water.fields[0].statistics.maximum, 0.5e-3F);
  const std::string grid = "0.1 0.2 0.0 0.2 0.4\n";
  for (const std::string& text :
       {"2 1 2 1\n" + grid + "2 1 2 30 0.85 0.99\n", "2 1 2 2\n" + grid + "2 1 2 30 10\n"}) {
    const HydrometeorFields fields = Read(text);
    EXPECT_EQ(fields.fields[0].quantity, volume::Quantity::kExtinction);
    EXPECT_FLOAT_EQ(At(fields, 1, 0, 1), 30e-3F);
    EXPECT_EQ(fields.fields[0].sizes.origin, volume::SizeOrigin::kObserved);
  }
}

TEST_F(CloudText, ReadsAt3dFields) {
  for (const char* text : {kTableText, kPlainText}) {
    SCOPED_TRACE(text);
    const HydrometeorFields fields = Read(text);
    EXPECT_EQ(file_.about, "AT3D cloud field");
    EXPECT_EQ(fields.grid.cells, glm::ivec3(2, 3, 4));
    EXPECT_EQ(fields.grid.spacing_m.y, 40.0);
    EXPECT_NEAR(fields.grid.low_corner_m.z, 450.0, 1e-4);
    EXPECT_FLOAT_EQ(At(fields, 0, 0, 1), 0.5e-3F);
    EXPECT_FLOAT_EQ(At(fields, 1, 2, 2), 0.25e-3F);
    EXPECT_NEAR(Radius_m(fields, 1, 2, 2), 5e-6F, 1e-8F);
    EXPECT_THAT(file_.assumptions, Contains("Indices count from 0, because the index 0 occurs."));
  }
}

TEST_F(CloudText, FindsTheColumnsOfATableByName) {
  const std::string grid = "2,3,4\n0.02,0.04\n0.5,0.6,0.7,0.8\n";
  const HydrometeorFields water = Read(grid + "i,j,k,cv,reff,lwc,veff\n1,1,2,9,10,0.5,0.1\n");
  EXPECT_FLOAT_EQ(At(water, 1, 1, 2), 0.5e-3F);
  EXPECT_NEAR(Radius_m(water, 1, 1, 2), 10e-6F, 1e-8F);
  EXPECT_THAT(file_.assumptions, Contains("Indices count from 0, as in AT3D, because none is 0 or "
                                          "as large as the grid."));
  const HydrometeorFields extinction = Read(grid + "x,y,z,extinction\n1,1,2,30\n");
  EXPECT_EQ(extinction.fields[0].quantity, volume::Quantity::kExtinction);
  EXPECT_FLOAT_EQ(At(extinction, 1, 1, 2), 30e-3F);
  ExpectError(grid + "x,y,z,temperature\n1,1,2,30\n", "line 4: names no column lwc");
}

TEST_F(CloudText, CountsIndicesFromZeroOrOneInAnyProgram) {
  const std::string header = "2\n2 2 4\n0.1 0.1\n0.5 0.6 0.7 0.8\n4*280\n";
  EXPECT_FLOAT_EQ(At(Read(header + "0 1 1 0.5 10\n"), 0, 1, 1), 0.5e-3F);
  EXPECT_FLOAT_EQ(At(Read(header + "1 2 2 0.5 10\n"), 0, 1, 1), 0.5e-3F);
  ExpectError(header + "1 2 2 0.5 10\n0 1 1 0.5 10\n",
              "line 7: the indices of the lines before count from 0 to the size of the grid (line "
              "7 has an index 0, and line 6 an index as large as the grid)");
}

TEST_F(CloudText, EachMalformedLineHasOneError) {
  const std::pair<std::string, std::string> changes[] = {
      {"2 3 3 0.2500", "line 7: ends before a value"},
      {"2 3 3 0.2500 5.00 7", "line 7: has more numbers than the layout of this file"},
      {"2 4 3 0.2500 5.00", "line 7: has 4 for the index along y, which is an integer from 0 to 3"},
      {"2 -1 3 0.2500 5.00", "line 7: has -1 for the index along y"},
      {"2 1.5 3 0.2500 5.00", "line 7: has 1.5 for the index along y"},
      {"2 nan 3 0.2500 5.00", "line 7: has nan for the index along y"},
      {"2 3 3 0.25oo 5.00", "line 7: has '0.25oo' for a value, which is not a number"},
      {"2 3 3 ****** 5.00", "line 7: has '******' for a value, which is not a number"},
      {"2 3 3 inf 5.00", "line 7: has the value inf"},
      {"2 3 3 1e300 5.00", "line 7: has the value 1e+300"}};
  for (const auto& [line, error] : changes) {
    ExpectError(absl::StrReplaceAll(kParticlesText, {{"2 3 3 0.2500 5.00", line}}), error);
  }
}

TEST_F(CloudText, EachMalformedHeaderHasOneError) {
  const std::tuple<std::string, std::string, std::string> changes[] = {
      {"0.05 0.02", "0.05 0", "line 3: has 0 km between columns"},
      {"0.05 0.02", "0.05 2000", "line 3: has 2000 km between columns"},
      {"0.7 0.8", "0.7 0.7", "line 4: has the height 0.7 km after a higher or equal one"},
      {"0.7 0.8", "700 800", "line 4: has the height 700 km; give heights in km"},
      {"0.7 0.8", "0.7 0.8 0.9 1.0", "line 4: has more heights than the 4 levels or their faces"},
      {"0.7 0.8", "0.7 x", "line 4: has 'x' for a height, which is not a number"},
      {" 2 3 4", " 2 3 1", "line 4: has more heights than the 1 levels"},
      {"parameter LWC file", "parameter extinction file for SHDOM",
       "line 1: begins an extinction file, whose values are in another file"}};
  for (const auto& [before, after, error] : changes) {
    ExpectError(absl::StrReplaceAll(kParticlesText, {{before, after}}), error);
  }
  ExpectError("2\n1 1 1\n1 1\n0.5\n280\n1 1 1 0.5 10\n", "line 4: has one height only");
  ExpectError("2\n1 1 2\n1 1\n0.5 0.6\n",
              "line 4: is the last, but the temperatures should follow");
  ExpectError("2\n1 1 2\n1 1\n0.5 0.6\n280 280\n", "lists no grid point");
  ExpectError("E\n2 1 2\n0.1 0.1 0.0 0.2\n280 270\n0.99 5 2.5\n",
              "line 5: is the last, but a term of a phase function should follow");
}

TEST_F(CloudText, RefusesOldFilesOfMysticAndThoseWithoutFaces) {
  ExpectError("2 1 2 0 3\n0.1 0.1 0 1 2\n1 1 1 0.1 10\n", "line 1: has 0 for the flag");
  ExpectError("2 1 2 1 3\n0.1 0.1 0 1 2\n1 1 1 0.1 10\n", "line 1: has a fifth number");
  const std::string cut = "2 1 2 3\n0.1 0.1 0 1";
  ExpectError(cut, "line 2: has as many heights as layers");
}

TEST_F(CloudText, ALineOfTextThatNeverEndsIsRefused) {
  const std::string header = "2\n1 1 2\n1 1\n0.5 0.6\n280 280\n";
  ExpectError(header + std::string(3 << 20, ' ') + "1 1 1 0.5 10\n",
              "line 6: is longer than 1 MiB");
  EXPECT_FLOAT_EQ(
      Read(header + std::string(1 << 20, '\n') + "1 1 1 0.5 10\n").fields[0].statistics.maximum,
      0.5e-3F);
}

// Fortran's repeat counts let a file of few bytes have any number of terms.
TEST_F(CloudText, ASeriesIsLimitedAndItsRepeatedTermsTakeNoTime) {
  const std::string header = "2 1 2\n0.1 0.1 0.0 0.2\n";
  ExpectError(header + "1 1 1 280.0 3.0 0.99 20001 20001*1\n",
              "line 3: has 20001 for the length of a series, which is an integer from 0 to 20000");
  const std::string longest = "1 1 1 280.0 3.0 0.99 20000 19999*1\n7.0\n2 1 2 280.0 5.0 0.99 0\n";
  EXPECT_FLOAT_EQ(Read(header + longest).fields[0].statistics.maximum, 5e-3F);
  ExpectError(header + "1 1 1 280.0 3.0 0.99 3 4*1\n", "line 3: has more numbers than the layout");

  std::ofstream(path_, std::ios::binary) << "2000000000*1 2\n";
  auto bytes = base::OpenBytes(path_);
  ASSERT_TRUE(bytes.ok()) << bytes.status();
  NumberText text(*std::move(bytes), "");
  const auto began = std::chrono::steady_clock::now();
  ASSERT_TRUE(text.SkipNumbers(2'000'000'000, "a term").ok());
  EXPECT_EQ(*text.Number("the next"), 2.0);
  EXPECT_LT(std::chrono::steady_clock::now() - began, std::chrono::seconds(1));
}

TEST_F(CloudText, AGridThatDoesNotFitInMemoryIsRefused) {
  const auto file = Describe("2\n900000 900000 2\n1 1\n0.5 0.6\n280 280\n1 1 1 0.5 10\n");
  EXPECT_TRUE(absl::IsResourceExhausted(file.status())) << file.status();
}

TEST_F(CloudText, AFileThatChangedAfterItWasListedIsRefused) {
  const auto file = Describe(kParticlesText);
  ASSERT_TRUE(file.ok()) << file.status();
  for (const std::string& text : {absl::StrReplaceAll(kParticlesText, {{" 2 3 4", " 3 3 4"}}),
                                  absl::StrCat(kParticlesText, "0 1 1 0.5 10\n")}) {
    std::ofstream(path_, std::ios::binary) << text;
    const absl::Status status = file->reader->Read(0, std::nullopt, {}).status();
    EXPECT_THAT(std::string(status.message()), HasSubstr("was changed"));
  }
}

std::vector<std::shared_ptr<const StormFormat>> TextFormats() {
  return {MakeShdomFormat(), MakeMysticFormat(), MakeAt3dFormat()};
}

TEST_F(CloudText, EachLayoutIsThatOfOneFormat) {
  const std::vector<std::pair<std::string, std::size_t>> samples = {
      {kParticlesText, 0}, {kComponentsText, 0}, {kStandardText, 0},
      {kTabulatedText, 0}, {kPolarizedText, 0},  {kExtinctionOnlyText, 0},
      {kMysticText, 1},    {kTableText, 2},      {kPlainText, 2}};
  const auto formats = TextFormats();
  for (const auto& [text, format] : samples) {
    for (std::size_t i = 0; i < formats.size(); ++i) {
      EXPECT_EQ(formats[i]->MayBegin(text), i == format) << text;
    }
  }
  // The lines with heights may be longer than the start of the file that is examined.
  std::string heights;
  for (int i = 0; i < 1000; ++i) absl::StrAppend(&heights, " ", 0.01 * i);
  const std::string start = absl::StrCat("2 2 1000 3\n0.1 0.1", heights).substr(0, 4096);
  EXPECT_TRUE(formats[1]->MayBegin(start));
}

TEST_F(CloudText, OtherTextsAreNotTaken) {
  for (const std::string text :
       {"", "\n\n", "hello\nworld\n", "1 2 3\n", "1\n2\n3\n4\n", "1,2,3\n4,5,6\n7,8,9\n",
        "Time,Temperature\n1,280\n2,281\n", "&time_control\n run_days = 0,\n/\n", "E\nnothing\n",
        "2 parameter LWC file\nsee below\n", "3 3\n1 2 3\n1 2 3\n1 2 3\n"}) {
    for (const auto& format : TextFormats()) EXPECT_FALSE(format->MayBegin(text)) << text;
  }
  std::string binary = kParticlesText;
  binary[3] = '\0';
  for (const auto& format : TextFormats()) EXPECT_FALSE(format->MayBegin(binary));
}

// Changes bytes of files at random. Each is read, or gives an error with its path.
TEST_F(CloudText, ChangedFilesAreReadOrRefused) {
  std::mt19937 random(20'261'130);
  const auto below = [&](std::size_t count) { return static_cast<std::size_t>(random()) % count; };
  const std::string samples[] = {kParticlesText, kComponentsText, kStandardText,
                                 kTabulatedText, kPolarizedText,  kExtinctionOnlyText,
                                 kMysticText,    kTableText,      kPlainText};
  constexpr std::string_view kBytes = "0123456789.-+eDn,* \t\n\r#%ETP\0\xff";
  int read = 0;
  int refused = 0;
  for (int i = 0; i < 900; ++i) {
    std::string text = samples[static_cast<std::size_t>(i) % std::size(samples)];
    for (std::size_t change = 0; change <= below(3); ++change) {
      const std::size_t at = below(text.size());
      if (below(4) == 0) {
        text.erase(at, 1 + below(8));
      } else {
        text[at] = kBytes[below(kBytes.size())];
      }
      if (text.empty()) text = "0";
    }
    const auto file = Describe(text);
    if (!file.ok()) {
      ++refused;
      EXPECT_THAT(std::string(file.status().message()), HasSubstr(path_)) << text;
      continue;
    }
    constexpr std::int64_t kMostCells = 10'000;
    if (std::int64_t{file->cells.x} * file->cells.y * file->cells.z > kMostCells) continue;
    const auto fields = file->reader->Read(0, std::nullopt, {});
    if (fields.ok()) {
      ++read;
      EXPECT_EQ(fields->fields.size(), file->fields.size()) << text;
    } else {
      EXPECT_THAT(std::string(fields.status().message()), HasSubstr(path_)) << text;
    }
  }
  EXPECT_GT(read, 100);
  EXPECT_GT(refused, 100);
}

TEST(ParseNumber, AcceptsWhatFortranWrites) {
  EXPECT_EQ(ParseNumber("1.5D-3"), 1.5e-3);
  EXPECT_EQ(ParseNumber("+2"), 2.0);
  EXPECT_EQ(ParseNumber("-.5"), -0.5);
  for (const std::string_view text : {"", "+", "--1", "+-1", "1.5x", "0x10", "1 2"}) {
    EXPECT_EQ(ParseNumber(text), std::nullopt) << text;
  }
  EXPECT_EQ(ParseNumber(std::string(1000, '1')), std::nullopt);
  EXPECT_THAT(LeadingNumbers(" 1, 2.5\t3 rest 4"), ElementsAre(1.0, 2.5, 3.0));
  EXPECT_THAT(LeadingNumbers("rest"), IsEmpty());
}

}  // namespace
}  // namespace thunderhead::storm_files

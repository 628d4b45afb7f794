// Tests of where a WRF domain is on Earth: coordinates with and without time, moving nests, and
// idealised runs.
#include "storm_files/wrf_place.h"

#include "storm_store/storm_catalogue.h"
#include "storm_store/storm_store.h"
#include "tests/unit/storm_files/wrf_kind_test.h"

namespace thunderhead::storm_files {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;
using testing::SyntheticWrf;

class WrfPlaceTest : public WrfKindTest {};

TEST_F(WrfPlaceTest, IsTheMiddleOfTheDomain) {
  auto described = Describe(Cloud());
  ASSERT_TRUE(described.ok()) << described.status();
  EXPECT_NEAR(described->latitude_deg.value_or(0), 35.01799, 1e-4);
  EXPECT_NEAR(described->longitude_deg.value_or(0), -96.98352, 1e-4);
  EXPECT_THAT(described->about, ::testing::Not(HasSubstr("idealised")));

  SyntheticWrf at_date_line = Cloud();
  at_date_line.longitude_deg = 179.98;  // the middle columns: 179.991 and, in the file, -179.998
  for (int y = 0; y < 3; ++y) {
    at_date_line.stored_values.push_back({"XLONG", {2, y, 0, 0}, -179.99803});
    at_date_line.stored_values.push_back({"XLONG", {3, y, 0, 0}, -179.98705});
  }
  described = Describe(at_date_line);
  ASSERT_TRUE(described.ok()) << described.status();
  EXPECT_NEAR(described->longitude_deg.value_or(0), 179.99648, 1e-4);
}

TEST_F(WrfPlaceTest, AnIdealisedRunHasNone) {
  SyntheticWrf without_projection = Cloud();
  without_projection.map_projection = 0;
  SyntheticWrf at_zero = Cloud();
  at_zero.nx = at_zero.ny = 1;
  at_zero.latitude_deg = at_zero.longitude_deg = 0.0;
  for (const SyntheticWrf& file : {without_projection, at_zero}) {
    const auto described = Describe(file);
    ASSERT_TRUE(described.ok()) << described.status();
    EXPECT_THAT(described->about, HasSubstr("idealised"));
    EXPECT_FALSE(described->latitude_deg.has_value());
    EXPECT_FALSE(described->longitude_deg.has_value());
    EXPECT_THAT(described->assumptions, IsEmpty());
  }
}

TEST_F(WrfPlaceTest, AMovingNestHasAPlaceAtEachTime) {
  SyntheticWrf file = Cloud();
  file.times = {"2013-05-20_20:00:00", "2013-05-20_20:10:00", "2013-05-20_20:20:00"};
  file.north_per_record_deg = 0.2;
  file.east_per_record_deg = 0.5;
  for (const int domain : {1, 2}) {
    file.domain = domain;
    const auto described = Describe(file);
    ASSERT_TRUE(described.ok()) << described.status();
    ASSERT_EQ(described->middles.size(), 3U);
    EXPECT_NEAR(described->middles[2].latitude_deg, 35.41799, 1e-4);
    EXPECT_NEAR(described->middles[2].longitude_deg, -95.98352, 1e-4);
    EXPECT_THAT(Assumptions(*described), HasSubstr("The domain moves"));
  }
  // A nest that has returned by its last time has moved too.
  for (int y = 0; y < 3; ++y) {
    for (int x = 0; x < 4; ++x) {
      file.stored_values.push_back({"XLAT", {x, y, 0, 2}, 35.0 + 0.01799 * y});
      file.stored_values.push_back({"XLONG", {x, y, 0, 2}, -97.0 + 0.010984 * x});
    }
  }
  const auto described = Describe(file);
  ASSERT_TRUE(described.ok()) << described.status();
  ASSERT_EQ(described->middles.size(), 3U);
  EXPECT_NEAR(described->middles[1].latitude_deg, 35.21799, 1e-4);
}

TEST_F(WrfPlaceTest, ANestThatMovesBetweenFilesHasAPlaceAtEachTime) {
  std::vector<StormFile> files;
  for (int i = 0; i < 2; ++i) {
    SyntheticWrf file = Cloud();
    file.times = {i == 0 ? "2013-05-20_20:00:00" : "2013-05-20_20:10:00"};
    file.latitude_deg += 0.2 * i;
    auto described = Describe(file);
    ASSERT_TRUE(described.ok()) << described.status();
    described->path += std::to_string(i);
    files.push_back(*std::move(described));
  }
  const storm_store::StormInfo info = storm_store::AssembleStorm("storm", files).info;
  EXPECT_NEAR(storm_store::MiddleOf(info, 0)->latitude_deg, 35.01799, 1e-4);
  EXPECT_NEAR(storm_store::MiddleOf(info, 1)->latitude_deg, 35.21799, 1e-4);
}

TEST_F(WrfPlaceTest, IsThatOfTheAttributesWithoutCoordinates) {
  SyntheticWrf file = Cloud();
  file.omitted = {"XLAT", "XLONG"};
  file.numbers = {{"CEN_LAT", 40.5},
                  {"CEN_LON", -100.25},
                  {"WEST-EAST_GRID_DIMENSION", 5.0},
                  {"SOUTH-NORTH_GRID_DIMENSION", 4.0}};
  auto described = Describe(file);
  ASSERT_TRUE(described.ok()) << described.status();
  EXPECT_DOUBLE_EQ(described->latitude_deg.value_or(0), 40.5);
  EXPECT_DOUBLE_EQ(described->longitude_deg.value_or(0), -100.25);
  EXPECT_THAT(Assumptions(*described), HasSubstr("CEN_LAT"));
  // The attributes do not give the place of a part of the domain. Nor do they give that of a nest,
  // because it may move.
  SyntheticWrf part = file;
  part.numbers["WEST-EAST_GRID_DIMENSION"] = 99.0;
  SyntheticWrf nest = file;
  nest.domain = 2;
  for (const SyntheticWrf& each : {part, nest}) {
    described = Describe(each);
    ASSERT_TRUE(described.ok()) << described.status();
    EXPECT_FALSE(described->latitude_deg.has_value());
    EXPECT_THAT(Assumptions(*described), HasSubstr("The place on Earth is unknown"));
    EXPECT_THAT(described->about, ::testing::Not(HasSubstr("idealised")));
  }
}

TEST_F(WrfPlaceTest, CoordinatesOfAnotherShapeAreRefused) {
  SyntheticWrf wrong = Cloud();
  wrong.renamed = {{"XLAT", "OTHER"}, {"QRAIN", "XLAT"}};
  wrong.mixing_ratios["QRAIN"] = [](const testing::WrfCell&) { return 35.0; };
  wrong.units["QRAIN"] = "degree_north";
  EXPECT_THAT(Message(wrong), HasSubstr("XLAT has dimensions (1, 8, 3, 4) where (1, 3, 4)"));
}

}  // namespace
}  // namespace thunderhead::storm_files

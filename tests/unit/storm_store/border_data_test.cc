#include "storm_store/border_data.h"

#include <filesystem>
#include <fstream>

#include "gtest/gtest.h"
#include "tests/support/border_files.h"
#include "tests/support/synthetic_wrf.h"
#include "tests/support/temporary_folder.h"

namespace thunderhead::storm_store {
namespace {

using testing::BorderSegment;
using testing::PaintedAt;
using testing::SegmentThrough;

// Returns a grid with columns of 1 km.
volume::RegularGrid Columns(int count) {
  volume::RegularGrid grid;
  grid.cells = {count, count, 1};
  grid.spacing_m = {1000.0, 1000.0, 1000.0};
  grid.low_corner_m = {-500.0 * count, -500.0 * count, 0.0};
  return grid;
}

StormInfo StormAt(const volume::EarthPlace& middle, const std::string& proj) {
  StormInfo storm;
  storm.id = "there";
  storm.latitude_deg = middle.latitude_deg;
  storm.longitude_deg = middle.longitude_deg;
  storm.projection = proj + testing::kSphereOfWrf;
  return storm;
}

// Returns a segment from west to east through a place.
BorderSegment Through(const glm::dvec2& place, int level = 1) {
  return SegmentThrough({place - glm::dvec2(0.1, 0.0), place + glm::dvec2(0.1, 0.0)}, level);
}

class BorderDataTest : public ::testing::Test {
 protected:
  void Write(const std::vector<BorderSegment>& coasts, const std::vector<BorderSegment>& borders,
             char letter = 'h') {
    WriteBorderFiles(folder_.Path().string(), letter, coasts, borders);
  }

  std::shared_ptr<const volume::BorderMap> Map(const StormInfo& storm, int columns = 200) {
    const auto data = BorderData::Find(folder_.Path().string());
    EXPECT_NE(data, nullptr);
    return data->MapOf(storm, 0, Columns(columns));
  }

  testing::TemporaryFolder folder_;
  const StormInfo plains_ =
      StormAt({36.7, -96.2}, "+proj=lcc +lat_1=30 +lat_2=60 +lat_0=38.5 +lon_0=-97.5");
};

TEST_F(BorderDataTest, IsFoundWhereCoastsAndBordersAre) {
  EXPECT_EQ(BorderData::Find(folder_.File("nothing")), nullptr);
  EXPECT_EQ(BorderData::Find(folder_.Path().string()), nullptr);
  Write({}, {});
  EXPECT_NE(BorderData::Find(folder_.Path().string()), nullptr);
  std::filesystem::remove(folder_.File("binned_border_h.nc"));
  EXPECT_EQ(BorderData::Find(folder_.Path().string()), nullptr);
}

// The expected places are from PROJ 9.1.1, as in map_projection_test.cc. The cases are a cone with
// two parallels, the southern hemisphere, and the date line.
TEST_F(BorderDataTest, LinesAreWhereTheirPlacesAreProjected) {
  const glm::dvec2 there_m(120e3, -80e3);
  struct Case {
    StormInfo storm;
    glm::dvec2 place;
  };
  for (const Case& each :
       {Case{plains_, {-94.853252053, 35.937287006}},
        Case{StormAt({-75.0, 170.0}, "+proj=stere +lat_0=-90 +lat_ts=-71 +lon_0=0"),
             {166.552719220, -74.067033356}}}) {
    Write({Through(each.place)}, {});
    const auto map = Map(each.storm);
    ASSERT_NE(map, nullptr);
    EXPECT_GT(PaintedAt(*map, there_m), 0.99F);
    double painted = 0.0;
    for (int step = -1000; step <= 1000; ++step) {
      painted += PaintedAt(*map, there_m + glm::dvec2(0.0, 10.0 * step)) * 10.0;
    }
    // The line is 120 m wide, and a little more where the parallel does not run from west to east
    // on the map.
    EXPECT_NEAR(painted, 122.0, 3.0);
  }
  const StormInfo pacific = StormAt({12.0, -179.5}, "+proj=merc +lat_ts=15 +lon_0=120");
  Write({Through({179.382569122, 11.270359038})}, {});
  EXPECT_GT(PaintedAt(*Map(pacific), {-120e3, -80e3}), 0.99F);
}

// On a conic map a parallel is a curve. It is 3 km off the straight line between meridians 5
// degrees apart, although its segment has two points.
TEST_F(BorderDataTest, ParallelsAreCurves) {
  Write({}, {SegmentThrough({{-99.0, 36.7}, {-94.0, 36.7}})});
  const auto projection = volume::MapProjection::Of(plains_.projection, {36.7, -96.2});
  ASSERT_TRUE(projection.ok());
  const auto map = Map(plains_);
  for (double longitude = -98.0; longitude < -94.5; longitude += 0.07) {
    EXPECT_GT(PaintedAt(*map, *projection->WorldOf({36.7, longitude})), 0.9F) << longitude;
  }
}

// One of the 65536 possible coordinates equals netCDF's code for a missing value, and must still
// count as a coordinate.
TEST_F(BorderDataTest, EveryCoordinateIsOne) {
  const int middle = 36 * 5 + 26;  // 30 to 40 degrees north, 100 to 90 west
  Write({{.bin = middle, .points = {{32'769, 30'000}, {32'769, 32'769}, {32'769, 50'000}}}}, {});
  const auto projection = volume::MapProjection::Of(plains_.projection, {36.7, -96.2});
  const auto map = Map(plains_);
  const double per_step = 10.0 / 65'535.0;
  const auto at = [&](double steps) {
    return *projection->WorldOf({30.0 + steps * per_step, -100.0 + 32'769.0 * per_step});
  };
  EXPECT_GT(PaintedAt(*map, at(40'000.0)), 0.9F);
  EXPECT_GT(PaintedAt(*map, at(32'769.0)), 0.9F);
}

TEST_F(BorderDataTest, LinesAtSeaGroundedIceAndSmallIslandsAreLeftOut) {
  const glm::dvec2 place(-96.2, 36.7);
  const auto paint = [&](const std::vector<BorderSegment>& coasts,
                         const std::vector<BorderSegment>& borders) {
    Write(coasts, borders);
    return PaintedAt(*Map(plains_), {0.0, 0.0});
  };
  EXPECT_GT(paint({Through(place)}, {}), 0.99F);
  EXPECT_GT(paint({Through(place, 2)}, {}), 0.99F);
  EXPECT_EQ(paint({Through(place, 6)}, {}), 0.0F);
  BorderSegment island = Through(place);
  island.area_km2 = 20.0;  // it covers 64 texels of 0.59 km: 22 km2
  EXPECT_EQ(paint({island}, {}), 0.0F);
  EXPECT_GT(paint({}, {Through(place)}), 0.99F);
  EXPECT_NEAR(paint({}, {Through(place, 2)}), 0.6F, 0.01F);
  EXPECT_EQ(paint({}, {Through(place, 3)}), 0.0F);
}

// The store must read a set of borders whose resolution matches the map's texels. A map has 1024
// texels, so a texel is 0.6 km wide in a map of 600 km, and 1.4 km in a map of 1400 km.
TEST_F(BorderDataTest, ASetThatIsAsFineAsTheMapIsRead) {
  const glm::dvec2 place(-96.2, 36.7);
  Write({}, {Through(place)}, 'h');
  Write({}, {Through(place, 2)}, 'i');
  Write({}, {}, 'l');
  EXPECT_NEAR(PaintedAt(*Map(plains_, 200), {0.0, 0.0}), 1.0F, 0.01F);
  EXPECT_NEAR(PaintedAt(*Map(plains_, 1000), {0.0, 0.0}), 0.6F, 0.01F);
  EXPECT_NEAR(PaintedAt(*Map(plains_, 50), {0.0, 0.0}), 1.0F, 0.01F) << "the finest that is there";
}

TEST_F(BorderDataTest, LinesGoOnBeyondTheDomain) {
  Write({SegmentThrough({{-99.9, 36.7}, {-90.1, 36.7}})}, {});
  const auto map = Map(plains_, 100);
  const auto projection = volume::MapProjection::Of(plains_.projection, {36.7, -96.2});
  EXPECT_GT(PaintedAt(*map, *projection->WorldOf({36.7, -95.2})),
            0.9F);  // a place 89 km to the east
  const float fading = PaintedAt(*map, *projection->WorldOf({36.7, -94.8}));  // 125 km to the east
  EXPECT_GT(fading, 0.3F);
  EXPECT_LT(fading, 0.7F);
  EXPECT_EQ(PaintedAt(*map, *projection->WorldOf({36.7, -94.4})), 0.0F);  // 160 km to the east
}

TEST_F(BorderDataTest, WithoutAMapProjectionOrWithDamagedDataThereIsNone) {
  Write({Through({-96.2, 36.7})}, {});
  StormInfo idealised = plains_;
  idealised.projection.clear();
  EXPECT_EQ(Map(idealised), nullptr);
  idealised = plains_;
  idealised.latitude_deg.reset();
  EXPECT_EQ(Map(idealised), nullptr);
  EXPECT_NE(Map(plains_), nullptr);
  std::ofstream(folder_.File("binned_border_h.nc")) << "nothing of the kind";
  EXPECT_EQ(Map(plains_), nullptr);
  // The file declares more points than the segment has.
  BorderSegment cut = Through({-96.2, 36.7});
  cut.declared_points = 9;
  Write({cut}, {});
  EXPECT_EQ(Map(plains_), nullptr);
}

// The store adds a border map to a storm, but only if the storm has geographical coordinates.
TEST_F(BorderDataTest, TimesOfAStormShareItsMap) {
  Write({Through({-96.98352, 35.01799})}, {});
  testing::SyntheticWrf file;
  file.mixing_ratios["QCLOUD"] = [](const testing::WrfCell&) { return 1e-3; };
  file.times = {"2013-05-20_20:00:00", "2013-05-20_21:00:00"};
  file.numbers = {{"TRUELAT1", 30.0}, {"STAND_LON", -97.0}};
  WriteWrf(file, folder_.File("real.nc"));
  file.map_projection = 0;
  WriteWrf(file, folder_.File("idealised.nc"));
  StormStoreOptions options;
  options.read_ahead = 0;
  options.borders = BorderData::Find(folder_.Path().string());
  const auto store =
      StormStore::Open({folder_.File("real.nc"), folder_.File("idealised.nc")}, options);
  ASSERT_TRUE(store.ok()) << store.status();
  const auto first = (*store)->Get("real", 0, {});
  const auto second = (*store)->Get("real", 1, {});
  const auto nowhere = (*store)->Get("idealised", 0, {});
  ASSERT_TRUE(first.ok() && second.ok() && nowhere.ok());
  ASSERT_NE((*first)->borders, nullptr);
  EXPECT_EQ((*first)->borders, (*second)->borders);
  EXPECT_EQ((*nowhere)->borders, nullptr);
  EXPECT_GT(PaintedAt(*(*first)->borders, {0.0, 0.0}), 0.99F);
  // The cone with both parallels at 30 degrees has the constant sin(30). The domain's middle is
  // 0.0165 degrees east of its central meridian.
  EXPECT_NEAR((*first)->true_north_deg, -0.016476 * 0.5, 1e-3);
  EXPECT_EQ((*nowhere)->true_north_deg, 0.0);
  EXPECT_GT((*first)->Bytes(), (*nowhere)->Bytes() + (*first)->borders->Bytes() / 2);
}

}  // namespace
}  // namespace thunderhead::storm_store

// Tests of the formats in which products state their place on the map.
#include "product/map_place.h"

#include <string>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "product/cf_grid_mapping.h"
#include "storm_files/grid_mapping.h"

namespace thunderhead::product {
namespace {

constexpr char kLambert[] =
    "+proj=lcc +lat_1=30 +lat_2=60 +lat_0=38.5 +lon_0=-97 +x_0=0 +y_0=0 +R=6370000 +units=m "
    "+no_defs";

volume::MapProjection Open(const std::string& text) {
  auto projection = volume::MapProjection::Open(text);
  EXPECT_TRUE(projection.ok()) << projection.status();
  return *std::move(projection);
}

TEST(WorldFile, SixLinesFromTheMiddleOfTheUpperLeftPixel) {
  EXPECT_EQ(
      WorldFile({.projection = "", .upper_left_m = {-1000.0, 500.0}, .pixel_m = {10.0, 20.0}}),
      "10.0000000000\n0.0000000000\n0.0000000000\n-20.0000000000\n-995.0000000000\n"
      "490.0000000000\n");
}

TEST(CfGridMapping, HasTheParametersOfEachProjection) {
  const auto lambert = GridMappingOf(Open(kLambert));
  ASSERT_TRUE(lambert.ok());
  EXPECT_EQ(lambert->texts.at("grid_mapping_name"), "lambert_conformal_conic");
  EXPECT_EQ(lambert->numbers.at("standard_parallel"), (std::vector{30.0, 60.0}));
  EXPECT_EQ(lambert->numbers.at("longitude_of_central_meridian"), std::vector{-97.0});
  EXPECT_EQ(lambert->numbers.at("latitude_of_projection_origin"), std::vector{38.5});
  EXPECT_EQ(lambert->numbers.at("earth_radius"), std::vector{6'370'000.0});
  EXPECT_THAT(lambert->texts.at("crs_wkt"), ::testing::HasSubstr("Lambert Conic Conformal"));
  const auto polar =
      GridMappingOf(Open("+proj=stere +lat_0=-90 +lat_ts=-60 +lon_0=10 +x_0=0 +y_0=0 +R=6370000"));
  ASSERT_TRUE(polar.ok());
  EXPECT_EQ(polar->texts.at("grid_mapping_name"), "polar_stereographic");
  EXPECT_EQ(polar->numbers.at("latitude_of_projection_origin"), std::vector{-90.0});
  const auto degrees = GridMappingOf(Open("+proj=eqc +lat_ts=35 +lat_0=35 +lon_0=0 +R=6371229"));
  ASSERT_TRUE(degrees.ok());
  EXPECT_TRUE(degrees->in_degrees);
}

// Returns the attributes as a reader of the file gets them.
storm_files::Attributes AttributesOf(const CfGridMapping& mapping) {
  storm_files::Attributes attributes;
  for (const auto& [name, text] : mapping.texts) attributes[name] = text;
  for (const auto& [name, numbers] : mapping.numbers) attributes[name] = numbers;
  return attributes;
}

// A file that Thunderhead writes is at the same place when it is read.
TEST(CfGridMapping, IsReadBackAsTheSameMap) {
  for (const char* const proj : {
           kLambert,
           "+proj=lcc +lat_1=38.5 +lat_2=38.5 +lat_0=38.5 +lon_0=-97.5 +R=6371229 +to_meter=1.25",
           "+proj=stere +lat_0=90 +lat_ts=60 +lon_0=10 +x_0=1000 +y_0=-500 +ellps=WGS84",
           "+proj=stere +lat_0=90 +k_0=0.97 +lon_0=10 +R=6370000",
           "+proj=stere +lat_0=47 +lon_0=10 +k_0=0.9 +R=6370000",
           "+proj=merc +lat_ts=15 +lon_0=120 +pm=2.5 +R=6370000",
           "+proj=tmerc +lat_0=49 +lon_0=-2 +k_0=0.9996 +x_0=400000 +y_0=-100000 +ellps=airy",
           "+proj=laea +lat_0=52 +lon_0=10 +x_0=4321000 +y_0=3210000 +ellps=GRS80",
           "+proj=aeqd +lat_0=52 +lon_0=10 +R=6370000",
           "+proj=aea +lat_1=29.5 +lat_2=45.5 +lat_0=23 +lon_0=-96 +ellps=clrk66",
           "+proj=cea +lat_ts=30 +lon_0=-75 +R=6370000",
           "+proj=geos +h=35785831 +lon_0=0 +sweep=x +a=6378169 +b=6356583.8",
           "+proj=eqc +lat_ts=50 +lat_0=50 +lon_0=8 +R=6371229",
           "+proj=ob_tran +o_proj=eqc +o_lat_p=40 +o_lon_p=5 +lon_0=10 +lat_ts=2 +R=6371229",
       }) {
    const volume::MapProjection map = Open(proj);
    const auto written = GridMappingOf(map);
    ASSERT_TRUE(written.ok()) << written.status();
    for (const volume::EarthPlace& place :
         {volume::EarthPlace{48.0, 9.0}, volume::EarthPlace{51.5, 12.5}}) {
      const auto plane_m = map.WorldOf(place);
      ASSERT_TRUE(plane_m.has_value()) << proj;
      const glm::dvec2 axes(written->x.origin + written->x.per_metre * plane_m->x,
                            written->y.origin + written->y.per_metre * plane_m->y);
      const auto read = storm_files::ReadGridMapping(AttributesOf(*written), {.middle = axes});
      ASSERT_TRUE(read.ok()) << read.status();
      EXPECT_TRUE(read->assumptions.empty()) << proj;
      const auto back = Open(read->projection).PlaceOf(read->Plane_m(axes));
      ASSERT_TRUE(back.has_value()) << read->projection;
      EXPECT_NEAR(back->latitude_deg, place.latitude_deg, 1e-8) << read->projection;
      EXPECT_NEAR(back->longitude_deg, place.longitude_deg, 1e-8) << read->projection;
    }
  }
}

}  // namespace
}  // namespace thunderhead::product

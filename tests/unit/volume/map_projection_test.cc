#include "volume/map_projection.h"

#include <gtest/gtest.h>

#include <string>

#include "tests/support/synthetic_wrf.h"

namespace thunderhead::volume {
namespace {

struct Case {
  const char* proj;
  EarthPlace middle;
  glm::dvec2 world_m;
  EarthPlace expected;  // from PROJ 9.1.1: proj of the middle, plus metres, proj -I
};

class MapProjections : public ::testing::TestWithParam<Case> {};

TEST_P(MapProjections, PlacesAreThoseOfProj) {
  const auto map =
      MapProjection::Of(std::string(GetParam().proj) + testing::kSphereOfWrf, GetParam().middle);
  ASSERT_TRUE(map.has_value());
  const auto middle = map->PlaceOf({0.0, 0.0});
  ASSERT_TRUE(middle.has_value());
  EXPECT_NEAR(middle->latitude_deg, GetParam().middle.latitude_deg, 1e-9);
  EXPECT_NEAR(middle->longitude_deg, GetParam().middle.longitude_deg, 1e-9);
  const auto place = map->PlaceOf(GetParam().world_m);
  ASSERT_TRUE(place.has_value());
  // The tolerance is a millimetre.
  EXPECT_NEAR(place->latitude_deg, GetParam().expected.latitude_deg, 1e-8);
  EXPECT_NEAR(place->longitude_deg, GetParam().expected.longitude_deg, 1e-8);
  const auto back_m = map->WorldOf(GetParam().expected);
  ASSERT_TRUE(back_m.has_value());
  EXPECT_NEAR(back_m->x, GetParam().world_m.x, 2e-3);
  EXPECT_NEAR(back_m->y, GetParam().world_m.y, 2e-3);
}

INSTANTIATE_TEST_SUITE_P(
    All, MapProjections,
    ::testing::Values(Case{"+proj=lcc +lat_1=30 +lat_2=60 +lat_0=38.5 +lon_0=-97.5",
                           {36.7, -96.2},
                           {120000.0, -80000.0},
                           {35.937287006, -94.853252053}},
                      // The next case has one standard parallel, in the southern hemisphere.
                      Case{"+proj=lcc +lat_1=-30 +lat_2=-30 +lat_0=-30 +lon_0=140",
                           {-33.0, 138.0},
                           {120000.0, -80000.0},
                           {-33.731058687, 139.279818193}},
                      Case{"+proj=stere +lat_0=90 +lat_ts=60 +lon_0=10",
                           {68.0, 15.0},
                           {120000.0, -80000.0},
                           {67.139289348, 17.684713862}},
                      Case{"+proj=stere +lat_0=-90 +lat_ts=-71 +lon_0=0",
                           {-75.0, 170.0},
                           {120000.0, -80000.0},
                           {-74.067033356, 166.552719220}},
                      // The grid crosses the date line.
                      Case{"+proj=merc +lat_ts=15 +lon_0=120",
                           {12.0, -179.5},
                           {-120000.0, -80000.0},
                           {11.270359038, 179.382569122}}));

TEST(MapProjectionTest, DegreesAreEvenInAPlateCarree) {
  const auto map = MapProjection::Of(
      "+proj=eqc +lat_ts=50 +lat_0=50 +lon_0=8 +x_0=0 +y_0=0 +R=6371229 +units=m +no_defs",
      {50.0, 8.0});
  ASSERT_TRUE(map.has_value());
  const auto place = map->PlaceOf({120000.0, -80000.0});
  ASSERT_TRUE(place.has_value());
  EXPECT_NEAR(place->latitude_deg, 49.280568575, 1e-8);  // the value that PROJ computes
  EXPECT_NEAR(place->longitude_deg, 9.678854915, 1e-8);
  EXPECT_FALSE(map->PlaceOf({0.0, 5e6}).has_value()) << "beyond the pole";
}

TEST(MapProjectionTest, WhatNamesNoMapHasNone) {
  for (const char* proj :
       {"", "+proj=ob_tran +R=6370000", "+proj=lcc +lat_1=30 +lat_2=60 +lat_0=38 +R=6370000",
        "+proj=merc +lat_ts=x +lon_0=0 +R=6370000", "+proj=merc +lat_ts=0 +lon_0=0", "nonsense",
        "+proj=lcc +lat_1=0 +lat_2=0 +lat_0=0 +lon_0=0 +R=6370000"}) {
    EXPECT_FALSE(MapProjection::Of(proj, {40.0, 10.0}).has_value()) << proj;
  }
  EXPECT_FALSE(
      MapProjection::Of("+proj=merc +lat_ts=0 +lon_0=0 +R=6370000", {90.0, 0.0}).has_value());
}

}  // namespace
}  // namespace thunderhead::volume

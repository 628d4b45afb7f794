// Tests of map projections against values that were computed without PROJ. They are closed forms on
// the sphere, and the numerical examples of Snyder (1987, Map Projections - A Working Manual, USGS
// Professional Paper 1395, appendix A).
#include "volume/map_projection.h"

#include <cmath>
#include <string>
#include <thread>
#include <vector>

#include "glm/geometric.hpp"
#include "glm/gtc/constants.hpp"
#include "glm/trigonometric.hpp"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/support/synthetic_wrf.h"

namespace thunderhead::volume {
namespace {

using ::testing::HasSubstr;

MapProjection Opened(const std::string& proj) {
  auto map = MapProjection::Open(proj);
  EXPECT_TRUE(map.ok()) << map.status();
  return *std::move(map);
}

MapProjection OpenedAt(const std::string& proj, const EarthPlace& middle) {
  auto map = MapProjection::Of(proj, middle);
  EXPECT_TRUE(map.ok()) << map.status();
  return *std::move(map);
}

// An example of Snyder. Those on a sphere of radius 1 are enlarged to a radius of 1000 km, so that
// their seven decimals are decimetres.
struct Example {
  const char* proj;
  EarthPlace place;
  glm::dvec2 expected_m;
};

class SnyderExamples : public ::testing::TestWithParam<Example> {};

TEST_P(SnyderExamples, AgreeWithinAMetre) {
  const MapProjection map = Opened(GetParam().proj);
  const auto found_m = map.WorldOf(GetParam().place);
  ASSERT_TRUE(found_m.has_value());
  EXPECT_LT(glm::distance(*found_m, GetParam().expected_m), 1.0) << found_m->x << " " << found_m->y;
  const auto back = map.PlaceOf(*found_m);
  ASSERT_TRUE(back.has_value());
  EXPECT_NEAR(back->latitude_deg, GetParam().place.latitude_deg, 1e-7);
  EXPECT_NEAR(std::remainder(back->longitude_deg - GetParam().place.longitude_deg, 360.0), 0.0,
              1e-7);
}

INSTANTIATE_TEST_SUITE_P(
    All, SnyderExamples,
    ::testing::Values(
        Example{"+proj=merc +lon_0=180 +R=1e6", {35.0, -75.0}, {1832595.7, 652836.6}},
        Example{"+proj=merc +lon_0=180 +ellps=clrk66", {35.0, -75.0}, {11688673.7, 4139145.6}},
        Example{"+proj=tmerc +lat_0=0 +lon_0=-75 +R=1e6", {40.5, -73.5}, {19907.7, 707027.6}},
        Example{"+proj=tmerc +lat_0=0 +lon_0=-75 +k_0=0.9996 +ellps=clrk66",
                {40.5, -73.5},
                {127106.5, 4484124.4}},
        Example{"+proj=cea +lat_ts=30 +lon_0=-75 +R=1e6", {35.0, 80.0}, {2342824.2, 662309.0}},
        Example{
            "+proj=cea +lat_ts=5 +lon_0=-75 +ellps=clrk66", {5.0, -78.0}, {-332699.8, 554248.5}},
        Example{"+proj=aea +lat_1=29.5 +lat_2=45.5 +lat_0=23 +lon_0=-96 +R=1e6",
                {35.0, -75.0},
                {295272.0, 241677.4}},
        Example{"+proj=aea +lat_1=29.5 +lat_2=45.5 +lat_0=23 +lon_0=-96 +ellps=clrk66",
                {35.0, -75.0},
                {1885472.7, 1535925.0}},
        Example{"+proj=lcc +lat_1=33 +lat_2=45 +lat_0=23 +lon_0=-96 +R=1e6",
                {35.0, -75.0},
                {296678.5, 246211.2}},
        Example{"+proj=lcc +lat_1=33 +lat_2=45 +lat_0=23 +lon_0=-96 +ellps=clrk66",
                {35.0, -75.0},
                {1894410.9, 1564649.5}},
        Example{"+proj=stere +lat_0=40 +lon_0=-100 +R=1e6", {30.0, -75.0}, {380722.4, -126380.2}},
        Example{"+proj=stere +lat_0=40 +lon_0=-100 +k_0=0.9999 +ellps=clrk66",
                {30.0, -90.0},
                {971630.8, -1063049.3}},
        Example{"+proj=stere +lat_0=-90 +lat_ts=-71 +lon_0=-100 +ellps=intl",
                {-75.0, 150.0},
                {-1540033.6, -560526.4}},
        Example{"+proj=laea +lat_0=40 +lon_0=-100 +R=3e6", {-20.0, 100.0}, {-4233930.3, 4025777.5}},
        Example{"+proj=laea +lat_0=40 +lon_0=-100 +ellps=clrk66",
                {30.0, -110.0},
                {-965932.1, -1056814.9}}));

// Returns the longitude and latitude of a place on a rotated grid, computed with Cartesian vectors.
glm::dvec2 Rotated_deg(const EarthPlace& place, const EarthPlace& pole) {
  const auto vector = [](const EarthPlace& at) {
    const double latitude = glm::radians(at.latitude_deg);
    const double longitude = glm::radians(at.longitude_deg);
    return glm::dvec3(std::cos(latitude) * std::cos(longitude),
                      std::cos(latitude) * std::sin(longitude), std::sin(latitude));
  };
  const glm::dvec3 up = vector(pole);
  // The grid's meridian 0 leads from its north pole through the Earth's north pole.
  const glm::dvec3 along = glm::normalize(glm::dvec3(0.0, 0.0, 1.0) - up.z * up);
  const glm::dvec3 across = glm::cross(up, along);
  const glm::dvec3 at = vector(place);
  return {glm::degrees(std::atan2(glm::dot(at, across), glm::dot(at, along))),
          glm::degrees(std::asin(glm::dot(at, up)))};
}

// COSMO's domain of Germany, with the pole at 40 N 170 W.
constexpr char kRotated[] =
    "+proj=ob_tran +o_proj=eqc +o_lat_p=40 +o_lon_p=0 +lon_0=10 +lat_ts=-1 +R=6371229 +units=m "
    "+no_defs";

TEST(MapProjectionTest, ARotatedGridIsEvenInItsOwnDegrees) {
  const EarthPlace middle{49.0, 11.0};
  const EarthPlace pole{40.0, -170.0};
  const MapProjection map = OpenedAt(kRotated, middle);
  const double degree_m = 6371229.0 * glm::pi<double>() / 180.0;
  const glm::dvec2 from = Rotated_deg(middle, pole);
  for (const EarthPlace& place :
       {middle, EarthPlace{47.0, 8.0}, EarthPlace{56.0, 3.0}, EarthPlace{60.0, 30.0}}) {
    const glm::dvec2 to = Rotated_deg(place, pole);
    const glm::dvec2 expected_m =
        (to - from) * glm::dvec2(degree_m * std::cos(glm::radians(-1.0)), degree_m);
    const auto world_m = map.WorldOf(place);
    ASSERT_TRUE(world_m.has_value());
    EXPECT_LT(glm::distance(*world_m, expected_m), 0.01);
    const auto back = map.PlaceOf(*world_m);
    ASSERT_TRUE(back.has_value());
    EXPECT_NEAR(back->latitude_deg, place.latitude_deg, 1e-9);
    EXPECT_NEAR(back->longitude_deg, place.longitude_deg, 1e-9);
  }
}

// The satellite's view by CGMS 03 (LRIT/HRIT Global Specification), section 4.4.3.2, with the
// satellite's scanning angles times its height as coordinates.
TEST(MapProjectionTest, AGeostationaryGridIsThatOfTheSatellite) {
  const MapProjection map =
      Opened("+proj=geos +h=35785831 +lon_0=0 +sweep=y +a=6378169 +b=6356583.8 +units=m");
  const double height_m = 35785831.0;
  const double a = 6378169.0;
  const double b = 6356583.8;
  const double longitude = glm::radians(8.0);
  const double geocentric = std::atan(b * b / (a * a) * std::tan(glm::radians(47.0)));
  const double radius_m =
      b / std::sqrt(1.0 - (1.0 - b * b / (a * a)) * std::pow(std::cos(geocentric), 2));
  const glm::dvec3 towards_m(height_m + a - radius_m * std::cos(geocentric) * std::cos(longitude),
                             -radius_m * std::cos(geocentric) * std::sin(longitude),
                             radius_m * std::sin(geocentric));
  const double x = std::atan(-towards_m.y / towards_m.x);
  const double y = std::asin(towards_m.z / glm::length(towards_m));
  const auto found_m = map.WorldOf({47.0, 8.0});
  ASSERT_TRUE(found_m.has_value());
  EXPECT_LT(glm::distance(*found_m, height_m * glm::dvec2(x, y)), 1.0);
  EXPECT_FALSE(map.PlaceOf({6e6, 0.0}).has_value()) << "beside the Earth's disc";
  EXPECT_FALSE(map.WorldOf({0.0, 100.0}).has_value()) << "behind the Earth";
}

struct Case {
  const char* proj;
  EarthPlace middle;
  glm::dvec2 world_m;
  EarthPlace expected;  // by the projections' closed forms on the sphere (Snyder 1987)
};

class WrfProjections : public ::testing::TestWithParam<Case> {};

TEST_P(WrfProjections, PlacesAreWhereTheGridIs) {
  const MapProjection map =
      OpenedAt(std::string(GetParam().proj) + testing::kSphereOfWrf, GetParam().middle);
  const auto middle = map.PlaceOf({0.0, 0.0});
  ASSERT_TRUE(middle.has_value());
  EXPECT_NEAR(middle->latitude_deg, GetParam().middle.latitude_deg, 1e-9);
  EXPECT_NEAR(middle->longitude_deg, GetParam().middle.longitude_deg, 1e-9);
  const auto place = map.PlaceOf(GetParam().world_m);
  ASSERT_TRUE(place.has_value());
  // The tolerance is a millimetre.
  EXPECT_NEAR(place->latitude_deg, GetParam().expected.latitude_deg, 1e-8);
  EXPECT_NEAR(place->longitude_deg, GetParam().expected.longitude_deg, 1e-8);
  const auto back_m = map.WorldOf(GetParam().expected);
  ASSERT_TRUE(back_m.has_value());
  EXPECT_NEAR(back_m->x, GetParam().world_m.x, 2e-3);
  EXPECT_NEAR(back_m->y, GetParam().world_m.y, 2e-3);
}

INSTANTIATE_TEST_SUITE_P(
    All, WrfProjections,
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
  const MapProjection map =
      OpenedAt("+proj=eqc +lat_ts=50 +lat_0=50 +lon_0=8 +x_0=0 +y_0=0 +R=6371229 +units=m +no_defs",
               {50.0, 8.0});
  const auto place = map.PlaceOf({120000.0, -80000.0});
  ASSERT_TRUE(place.has_value());
  const double degree_m = 6371229.0 * glm::pi<double>() / 180.0;
  EXPECT_NEAR(place->latitude_deg, 50.0 - 80000.0 / degree_m, 1e-9);
  EXPECT_NEAR(place->longitude_deg, 8.0 + 120000.0 / degree_m / std::cos(glm::radians(50.0)), 1e-9);
  EXPECT_FALSE(map.PlaceOf({0.0, 5e6}).has_value()) << "beyond the pole";
}

// A Mercator grid whose own cut, opposite lon_0, lies in the domain. WRF's x runs on across it.
TEST(MapProjectionTest, ACylinderHasNoCutNearTheDomain) {
  for (const char* const proj :
       {"+proj=merc +lat_ts=0 +lon_0=0 +R=6370000", "+proj=cea +lat_ts=0 +lon_0=0 +R=6370000",
        "+proj=eqc +lat_ts=0 +lat_0=0 +lon_0=0 +R=6370000"}) {
    const MapProjection map = OpenedAt(proj, {0.0, 179.5});
    const double degree_m = 6370000.0 * glm::pi<double>() / 180.0;
    for (const double east_deg : {-3.0, 0.4, 0.6, 3.0}) {
      const auto world_m = map.WorldOf({0.0, std::remainder(179.5 + east_deg, 360.0)});
      ASSERT_TRUE(world_m.has_value());
      EXPECT_NEAR(world_m->x, east_deg * degree_m, 0.01) << proj;
      const auto place = map.PlaceOf({east_deg * degree_m, 0.0});
      ASSERT_TRUE(place.has_value()) << proj << " " << east_deg;
      EXPECT_NEAR(std::remainder(place->longitude_deg - 179.5 - east_deg, 360.0), 0.0, 1e-9);
    }
  }
}

TEST(MapProjectionTest, AUnitScalesTheWholeMap) {
  const std::string proj = "+proj=lcc +lat_1=30 +lat_2=60 +lat_0=38.5 +lon_0=-97.5 +R=6370000";
  const EarthPlace place{40.0, -90.0};
  const auto plain_m = Opened(proj).WorldOf(place);
  const auto scaled = Opened(proj + " +to_meter=1.25").WorldOf(place);
  ASSERT_TRUE(plain_m.has_value() && scaled.has_value());
  EXPECT_LT(glm::distance(*plain_m, 1.25 * *scaled), 1e-3);
}

// In Lambert's projection with the cone constant n, a meridian is turned by n times its distance in
// longitude from the central one. In the polar projection n is 1.
TEST(MapProjectionTest, TrueNorthIsTheMeridiansDirection) {
  const auto north_deg = [](const std::string& proj, const EarthPlace& place) {
    return Opened(proj).TrueNorth_deg(place).value_or(1000.0);
  };
  const std::string tangent = "+proj=lcc +lat_1=38.5 +lat_2=38.5 +lat_0=38.5 +lon_0=-97.5";
  const double n = std::sin(glm::radians(38.5));
  EXPECT_NEAR(north_deg(tangent + " +R=6371229", {35.0, -97.5}), 0.0, 1e-6);
  EXPECT_NEAR(north_deg(tangent + " +R=6371229", {35.0, -90.0}), -7.5 * n, 1e-6);
  EXPECT_NEAR(north_deg(tangent + " +R=6371229", {50.0, -120.0}), 22.5 * n, 1e-6);
  EXPECT_NEAR(
      north_deg("+proj=lcc +lat_1=-30 +lat_2=-30 +lat_0=-30 +lon_0=140 +R=6370000", {-33.0, 150.0}),
      5.0, 1e-6);
  EXPECT_NEAR(north_deg("+proj=stere +lat_0=90 +lat_ts=60 +lon_0=10 +R=6370000", {70.0, 130.0}),
              -120.0, 1e-6);
  EXPECT_NEAR(north_deg("+proj=stere +lat_0=-90 +lat_ts=-60 +lon_0=20 +R=6370000", {-70.0, 35.0}),
              15.0, 1e-6);
  EXPECT_NEAR(north_deg("+proj=merc +lat_ts=15 +lon_0=120 +R=6370000", {12.0, 150.0}), 0.0, 1e-6);
  // Snyder's equation 5-8 for the rotated pole: the angle between the ways to the two poles.
  const EarthPlace place{56.0, 3.0};
  const double turn = glm::radians(-170.0 - place.longitude_deg);
  const double to_pole =
      std::atan2(std::cos(glm::radians(40.0)) * std::sin(turn),
                 std::cos(glm::radians(place.latitude_deg)) * std::sin(glm::radians(40.0)) -
                     std::sin(glm::radians(place.latitude_deg)) * std::cos(glm::radians(40.0)) *
                         std::cos(turn));
  const glm::dvec2 grid = Rotated_deg(place, {40.0, -170.0});
  // The map widens the grid's parallels away from lat_ts.
  const double stretch = std::cos(glm::radians(-1.0)) / std::cos(glm::radians(grid.y));
  EXPECT_NEAR(north_deg(kRotated, place),
              glm::degrees(std::atan2(stretch * std::sin(-to_pole), std::cos(to_pole))), 1e-5);
  EXPECT_FALSE(Opened(tangent + " +R=6371229").TrueNorth_deg({-90.0, 0.0}).has_value());
}

TEST(MapProjectionTest, TextsThatOpenFilesOrAreNoMapOfAStormAreRefused) {
  struct Refused {
    const char* proj;
    const char* reason;
  };
  for (const Refused& each :
       {Refused{"", "does not name a projection"},
        Refused{"nonsense", "+nonsense is not accepted"},
        Refused{"EPSG:4326", "not accepted"},
        Refused{"+init=epsg:2154", "+init is not accepted"},
        Refused{"+proj=pipeline +step +proj=merc +R=1", "+proj=pipeline is not a projection"},
        Refused{"+proj=merc +R=1 +nadgrids=/etc/passwd", "+nadgrids is not accepted"},
        Refused{"+proj=merc +R=1 +geoidgrids=a.gtx", "+geoidgrids is not accepted"},
        Refused{"+proj=merc +R=1 +axis=neu", "+axis is not accepted"},
        Refused{"+proj=merc +datum=NAD27", "+datum=NAD27 is not known"},
        Refused{"+proj=hgridshift +grids=a", "+proj=hgridshift"},
        Refused{"+proj=longlat +R=6370000", "+proj=longlat"},
        Refused{"+proj=merc +lat_ts=x +lon_0=0 +R=6370000", "+lat_ts=x is not a number"},
        Refused{"+proj=merc +lat_ts=nan +lon_0=0 +R=6370000", "is not a number"},
        Refused{"+proj=merc +proj=lcc +R=6370000", "+proj is given twice"},
        Refused{"+proj=merc +units=km +R=6370000", "+units=km"},
        Refused{"+proj=merc +units=m +to_meter=2 +R=6370000", "both +units= and +to_meter="},
        Refused{"+proj=merc +lat_ts=0 +lon_0=0", "size of the Earth"},
        Refused{"+proj=ob_tran +R=6370000", "+o_proj=eqc together"},
        Refused{"+proj=ob_tran +o_proj=longlat +o_lat_p=40 +R=6370000", "+o_proj=longlat"},
        Refused{"+proj=lcc +lat_1=0 +lat_2=0 +lat_0=0 +lon_0=0 +R=6370000", "PROJ does not accept"},
        Refused{"+proj=merc +lat_ts=0 +lon_0=0 +R=-5", "PROJ does not accept"}}) {
    const auto map = MapProjection::Open(each.proj);
    EXPECT_EQ(map.status().code(), absl::StatusCode::kInvalidArgument) << each.proj;
    EXPECT_THAT(std::string(map.status().message()), HasSubstr(each.reason));
  }
  EXPECT_FALSE(MapProjection::Open(std::string(2000, 'a')).ok());
  const auto off = MapProjection::Of("+proj=merc +lat_ts=0 +lon_0=0 +R=6370000", {90.0, 0.0});
  EXPECT_THAT(std::string(off.status().message()), HasSubstr("is not on the map"));
}

TEST(MapProjectionTest, SeveralThreadsMayUseOne) {
  const MapProjection map = Opened("+proj=lcc +lat_1=33 +lat_2=45 +lat_0=23 +lon_0=-96 +R=6370000");
  const std::optional<glm::dvec2> expected_m = map.WorldOf({35.0, -75.0});
  std::vector<std::jthread> threads;
  for (int i = 0; i < 4; ++i) {
    threads.emplace_back([&] {
      for (int j = 0; j < 1000; ++j) {
        EXPECT_EQ(map.WorldOf({35.0, -75.0}), expected_m);
        EXPECT_FALSE(map.WorldOf({-90.0, 0.0}).has_value());
      }
    });
  }
}

TEST(MapProjectionTest, WellKnownTextIsConvertedBothWays) {
  const std::string proj = "+proj=lcc +lat_1=33 +lat_2=45 +lat_0=23 +lon_0=-96 +ellps=GRS80";
  const MapProjection map = Opened(proj);
  const std::string text = map.WellKnownText(MapProjection::WellKnown::kIso);
  EXPECT_THAT(text, HasSubstr("Lambert Conic Conformal"));
  const auto back = ProjectionOfWellKnownText(text);
  ASSERT_TRUE(back.ok()) << back.status();
  const auto again_m = Opened(*back).WorldOf({35.0, -75.0});
  ASSERT_TRUE(again_m.has_value());
  EXPECT_LT(glm::distance(*again_m, *map.WorldOf({35.0, -75.0})), 1e-6);
  EXPECT_NEAR(map.Figure().semi_major_m, 6378137.0, 1e-6);
  EXPECT_NEAR(map.Figure().inverse_flattening, 298.257222101, 1e-6);
  EXPECT_EQ(Opened(kRotated).Figure().semi_major_m, 6371229.0);
  EXPECT_EQ(Opened(kRotated).Figure().inverse_flattening, 0.0);
  EXPECT_FALSE(ProjectionOfWellKnownText("PROJCS[nonsense").ok());
  EXPECT_FALSE(ProjectionOfWellKnownText("+proj=merc +nadgrids=x").ok());
}

}  // namespace
}  // namespace thunderhead::volume

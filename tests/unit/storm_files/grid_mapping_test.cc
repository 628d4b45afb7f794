// Tests of CF grid mappings against values that were computed without PROJ. They are the corners of
// GRIB grids, closed forms, and the numerical examples of Snyder (1987, Map Projections - A Working
// Manual, USGS Professional Paper 1395, appendix A).
#include "storm_files/grid_mapping.h"

#include <cmath>
#include <string>

#include "absl/strings/str_cat.h"
#include "glm/geometric.hpp"
#include "glm/gtc/constants.hpp"
#include "glm/trigonometric.hpp"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "volume/map_projection.h"

namespace thunderhead::storm_files {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;
using volume::EarthPlace;
using volume::MapProjection;

using Numbers = std::vector<double>;

GridMapping Read(const Attributes& attributes, const MappedGrid& grid = {}) {
  auto mapping = ReadGridMapping(attributes, grid);
  EXPECT_TRUE(mapping.ok()) << mapping.status();
  return *std::move(mapping);
}

// Returns the place of values of x and y.
EarthPlace PlaceOf(const GridMapping& mapping, const glm::dvec2& coordinates) {
  const auto map = MapProjection::Open(mapping.projection);
  EXPECT_TRUE(map.ok()) << map.status();
  const auto place = map->PlaceOf(mapping.Plane_m(coordinates));
  EXPECT_TRUE(place.has_value());
  return place.value_or(EarthPlace{});
}

// Expects two places to be at most a metre apart.
void ExpectSame(const EarthPlace& found, const EarthPlace& expected, const std::string& what = "") {
  constexpr double kMetre_deg = 1.0 / 111'200.0;
  EXPECT_NEAR(found.latitude_deg, expected.latitude_deg, kMetre_deg) << what;
  EXPECT_NEAR(std::remainder(found.longitude_deg - expected.longitude_deg, 360.0) *
                  std::cos(glm::radians(expected.latitude_deg)),
              0.0, kMetre_deg)
      << what;
}

// Returns these attributes with Snyder's ellipsoid, Clarke's of 1866.
Attributes OnClarke(Attributes attributes) {
  attributes["semi_major_axis"] = Numbers{6378206.4};
  attributes["semi_minor_axis"] = Numbers{6356583.8};
  return attributes;
}

TEST(GridMappingTest, MappingsAgreeWithSnyderWithinAMetre) {
  struct Example {
    Attributes attributes;
    glm::dvec2 coordinates;
    EarthPlace place;
  };
  const std::vector<Example> examples = {
      {OnClarke({{"grid_mapping_name", "albers_conical_equal_area"},
                 {"standard_parallel", Numbers{29.5, 45.5}},
                 {"longitude_of_central_meridian", Numbers{-96.0}},
                 {"latitude_of_projection_origin", Numbers{23.0}}}),
       {1885472.7, 1535925.0},
       {35.0, -75.0}},
      {OnClarke({{"grid_mapping_name", "lambert_conformal_conic"},
                 {"standard_parallel", Numbers{33.0, 45.0}},
                 {"longitude_of_central_meridian", Numbers{264.0}},
                 {"latitude_of_projection_origin", Numbers{23.0}}}),
       {1894410.9, 1564649.5},
       {35.0, -75.0}},
      {OnClarke({{"grid_mapping_name", "mercator"},
                 {"standard_parallel", Numbers{0.0}},
                 {"longitude_of_projection_origin", Numbers{180.0}}}),
       {11688673.7, 4139145.6},
       {35.0, -75.0}},
      {OnClarke({{"grid_mapping_name", "transverse_mercator"},
                 {"scale_factor_at_central_meridian", Numbers{0.9996}},
                 {"longitude_of_central_meridian", Numbers{-75.0}},
                 {"latitude_of_projection_origin", Numbers{0.0}},
                 {"false_easting", Numbers{500'000.0}}}),
       {627106.5, 4484124.4},
       {40.5, -73.5}},
      {OnClarke({{"grid_mapping_name", "lambert_azimuthal_equal_area"},
                 {"longitude_of_projection_origin", Numbers{-100.0}},
                 {"latitude_of_projection_origin", Numbers{40.0}}}),
       {-965932.1, -1056814.9},
       {30.0, -110.0}},
      {OnClarke({{"grid_mapping_name", "lambert_cylindrical_equal_area"},
                 {"standard_parallel", Numbers{5.0}},
                 {"longitude_of_central_meridian", Numbers{-75.0}}}),
       {-332699.8, 554248.5},
       {5.0, -78.0}},
      {OnClarke({{"grid_mapping_name", "stereographic"},
                 {"longitude_of_projection_origin", Numbers{-100.0}},
                 {"latitude_of_projection_origin", Numbers{40.0}},
                 {"scale_factor_at_projection_origin", Numbers{0.9999}}}),
       {971630.8, -1063049.3},
       {30.0, -90.0}},
      {{{"grid_mapping_name", "polar_stereographic"},
        {"straight_vertical_longitude_from_pole", Numbers{-100.0}},
        {"latitude_of_projection_origin", Numbers{-90.0}},
        {"standard_parallel", Numbers{-71.0}},
        {"semi_major_axis", Numbers{6378388.0}},
        {"inverse_flattening", Numbers{297.0}}},
       {-1540033.6, -560526.4},
       {-75.0, 150.0}},
  };
  for (const Example& example : examples) {
    const GridMapping mapping = Read(example.attributes);
    EXPECT_EQ(mapping.axes, GridAxes::kMetres);
    EXPECT_THAT(mapping.assumptions, IsEmpty());
    ExpectSame(PlaceOf(mapping, example.coordinates), example.place, mapping.projection);
  }
}

// A grid of 74 by 46 columns in HRRR's projection, 1 km apart. Its corners are those of a GRIB
// file, and were computed without PROJ.
TEST(GridMappingTest, CornersOfALambertGridAgreeWithGrib) {
  const GridMapping mapping = Read({{"grid_mapping_name", "lambert_conformal_conic"},
                                    {"standard_parallel", Numbers{38.5}},
                                    {"longitude_of_central_meridian", Numbers{-97.5}},
                                    {"latitude_of_projection_origin", Numbers{38.5}},
                                    {"earth_radius", Numbers{6371229.0}}});
  const auto map = MapProjection::Of(mapping.projection, {35.105507, -95.606578});
  ASSERT_TRUE(map.ok()) << map.status();
  struct Corner {
    glm::dvec2 world_m;
    EarthPlace place;
  };
  for (const Corner& corner : {Corner{{73'000.0, 0.0}, {35.089176, -94.805846}},
                               Corner{{0.0, 45'000.0}, {35.509481, -95.596365}},
                               Corner{{73'000.0, 45'000.0}, {35.493056, -94.791319}}}) {
    const auto place = map->PlaceOf(corner.world_m);
    ASSERT_TRUE(place.has_value());
    ExpectSame(*place, corner.place);
  }
}

TEST(GridMappingTest, DegreesBecomeMetresAtTheGridsMiddle) {
  const glm::dvec2 middle(10.99, 51.09);
  const GridMapping mapping =
      Read({{"grid_mapping_name", "latitude_longitude"}, {"earth_radius", Numbers{6371229.0}}},
           {.middle = middle});
  EXPECT_EQ(mapping.axes, GridAxes::kDegrees);
  const double degree_m = 6371229.0 * glm::pi<double>() / 180.0;
  EXPECT_NEAR(mapping.metres_per_unit.y, degree_m, 1e-6);
  EXPECT_NEAR(mapping.metres_per_unit.x, degree_m * std::cos(glm::radians(51.09)), 1e-6);
  EXPECT_EQ(mapping.Plane_m(middle), glm::dvec2(0.0));
  // Two corners of the ICON-D2-like grid of a GRIB file.
  ExpectSame(PlaceOf(mapping, {10.4, 50.6}), {50.6, 10.4});
  ExpectSame(PlaceOf(mapping, {11.58, 51.58}), {51.58, 11.58});
  const GridMapping west =
      Read({{"grid_mapping_name", "latitude_longitude"}}, {.middle = {261.99, 35.295}});
  ExpectSame(PlaceOf(west, {262.98, 36.09}), {36.09, -97.02});
  EXPECT_THAT(west.assumptions, ::testing::ElementsAre(HasSubstr("6371000 m is assumed")));
}

// The grid's north pole is at 43 N 172 W. Its middle is therefore at 47 N 8 E, and 8 E is a
// meridian of the grid.
TEST(GridMappingTest, ARotatedPoleTurnsTheGrid) {
  const Attributes attributes = {{"grid_mapping_name", "rotated_latitude_longitude"},
                                 {"grid_north_pole_latitude", Numbers{43.0}},
                                 {"grid_north_pole_longitude", Numbers{-172.0}},
                                 {"earth_radius", Numbers{6371229.0}}};
  const GridMapping mapping = Read(attributes, {.middle = {0.0, 0.5}});
  EXPECT_EQ(mapping.axes, GridAxes::kRotatedDegrees);
  ExpectSame(PlaceOf(mapping, {0.0, 0.0}), {47.0, 8.0});
  ExpectSame(PlaceOf(mapping, {0.0, 1.5}), {48.5, 8.0});
  // Along the grid's equator a place is as far from the middle as its grid longitude says.
  const EarthPlace east = PlaceOf(mapping, {5.0, 0.0});
  const double latitude = std::asin(std::sin(glm::radians(47.0)) * std::cos(glm::radians(5.0)));
  const double turn = std::atan2(std::sin(glm::radians(5.0)),
                                 std::cos(glm::radians(47.0)) * std::cos(glm::radians(5.0)));
  ExpectSame(east, {glm::degrees(latitude), 8.0 + glm::degrees(turn)});
  const double degree_m = 6371229.0 * glm::pi<double>() / 180.0;
  EXPECT_NEAR(mapping.metres_per_unit.x, degree_m * std::cos(glm::radians(0.5)), 1e-6);
  EXPECT_NEAR(mapping.metres_per_unit.y, degree_m, 1e-6);
  // Grid longitudes from 0 to 360 are the same places.
  ExpectSame(PlaceOf(mapping, {365.0, 0.0}), east);
  // The Earth's north pole is at grid longitude 30, so everything is 30 degrees further east.
  Attributes turned = attributes;
  turned["north_pole_grid_longitude"] = Numbers{30.0};
  ExpectSame(PlaceOf(Read(turned, {.middle = {30.0, 0.5}}), {30.0, 0.0}), {47.0, 8.0});
}

// CGMS 03 (LRIT/HRIT Global Specification), section 4.4.3.2: the scanning angles of a place.
TEST(GridMappingTest, AGeostationaryGridHasScanningAngles) {
  const Attributes attributes = {{"grid_mapping_name", "geostationary"},
                                 {"perspective_point_height", Numbers{35785831.0}},
                                 {"longitude_of_projection_origin", Numbers{0.0}},
                                 {"latitude_of_projection_origin", Numbers{0.0}},
                                 {"sweep_angle_axis", "y"},
                                 {"semi_major_axis", Numbers{6378169.0}},
                                 {"semi_minor_axis", Numbers{6356583.8}}};
  const GridMapping mapping = Read(attributes);
  EXPECT_EQ(mapping.axes, GridAxes::kScanAngles);
  const double flat = std::pow(6356583.8 / 6378169.0, 2);
  const double geocentric = std::atan(flat * std::tan(glm::radians(47.0)));
  const double radius_m =
      6356583.8 / std::sqrt(1.0 - (1.0 - flat) * std::pow(std::cos(geocentric), 2));
  const double turn = glm::radians(8.0);
  const glm::dvec3 way_m(35785831.0 + 6378169.0 - radius_m * std::cos(geocentric) * std::cos(turn),
                         -radius_m * std::cos(geocentric) * std::sin(turn),
                         radius_m * std::sin(geocentric));
  const glm::dvec2 angles(std::atan(-way_m.y / way_m.x), std::asin(way_m.z / glm::length(way_m)));
  ExpectSame(PlaceOf(mapping, angles), {47.0, 8.0});
  // The coordinates may also be the angles times the satellite's height, here in kilometres.
  const GridMapping in_km = Read(attributes, {.unit_m = 1000.0});
  EXPECT_EQ(in_km.axes, GridAxes::kMetres);
  ExpectSame(PlaceOf(in_km, angles * 35785.831), {47.0, 8.0});
  Attributes other = attributes;
  other.erase("sweep_angle_axis");
  other["fixed_angle_axis"] = "x";
  EXPECT_EQ(Read(other).projection, mapping.projection);
}

TEST(GridMappingTest, KilometresCountForTheFalseOriginToo) {
  const Attributes attributes = OnClarke({{"grid_mapping_name", "lambert_conformal_conic"},
                                          {"standard_parallel", Numbers{33.0, 45.0}},
                                          {"longitude_of_central_meridian", Numbers{-96.0}},
                                          {"latitude_of_projection_origin", Numbers{23.0}},
                                          {"false_easting", Numbers{100.0}},
                                          {"false_northing", Numbers{-20.0}}});
  const GridMapping mapping = Read(attributes, {.unit_m = 1000.0});
  EXPECT_EQ(mapping.metres_per_unit, glm::dvec2(1000.0));
  ExpectSame(PlaceOf(mapping, {1994.4109, 1544.6495}), {35.0, -75.0});
}

TEST(GridMappingTest, TheFigureOfTheEarthIsReadOrAssumedAloud) {
  const auto read = [](Attributes more) {
    more["grid_mapping_name"] = "mercator";
    more["standard_parallel"] = Numbers{0.0};
    more["longitude_of_projection_origin"] = Numbers{0.0};
    return Read(more);
  };
  EXPECT_THAT(read({{"semi_major_axis", Numbers{6378137.0}},
                    {"inverse_flattening", Numbers{298.257223563}}})
                  .projection,
              HasSubstr("+a=6378137 +rf=298.257223563"));
  EXPECT_THAT(read({{"semi_major_axis", Numbers{6371229.0}}, {"inverse_flattening", Numbers{0.0}}})
                  .projection,
              HasSubstr("+R=6371229"));
  EXPECT_THAT(read({{"reference_ellipsoid_name", "WGS 84"}}).projection, HasSubstr("+ellps=WGS84"));
  const GridMapping assumed = read({});
  EXPECT_THAT(assumed.projection, HasSubstr("+R=6371000"));
  EXPECT_THAT(assumed.assumptions,
              ::testing::ElementsAre(HasSubstr("does not give the figure of the Earth")));
  EXPECT_THAT(
      read({{"earth_radius", Numbers{6.37e6}}, {"longitude_of_prime_meridian", Numbers{2.5}}})
          .projection,
      HasSubstr("+pm=2.5"));
}

// Snyder's example of zone 18 (page 269), and its mirror image south of the equator. PROJ writes
// such a system as a zone, and not as a transverse Mercator projection.
TEST(GridMappingTest, WellKnownTextMayBeOfAUtmZone) {
  const auto zone = [](const std::string& letter, const std::string& false_northing) {
    return absl::StrCat(
        R"(PROJCS["UTM zone 18)", letter,
        R"(",GEOGCS["unknown",DATUM["unknown",SPHEROID["Clarke 1866",6378206.4,294.978698213898]],)"
        R"(PRIMEM["Greenwich",0],UNIT["degree",0.0174532925199433]],)"
        R"(PROJECTION["Transverse_Mercator"],PARAMETER["latitude_of_origin",0],)"
        R"(PARAMETER["central_meridian",-75],PARAMETER["scale_factor",0.9996],)"
        R"(PARAMETER["false_easting",500000],PARAMETER["false_northing",)",
        false_northing, R"(],UNIT["metre",1]])");
  };
  ExpectSame(PlaceOf(Read({{"crs_wkt", zone("N", "0")}}), {627106.5, 4484124.4}), {40.5, -73.5});
  ExpectSame(PlaceOf(Read({{"crs_wkt", zone("S", "10000000")}}), {627106.5, 1e7 - 4484124.4}),
             {-40.5, -73.5});
}

TEST(GridMappingTest, WellKnownTextCountsOnlyWithoutAName) {
  const auto lambert =
      MapProjection::Open("+proj=lcc +lat_1=33 +lat_2=45 +lat_0=23 +lon_0=-96 +ellps=clrk66");
  ASSERT_TRUE(lambert.ok());
  const std::string text = lambert->WellKnownText(MapProjection::WellKnown::kIso);
  const GridMapping mapping = Read({{"crs_wkt", text}});
  ExpectSame(PlaceOf(mapping, {1894410.9, 1564649.5}), {35.0, -75.0});
  EXPECT_THAT(mapping.assumptions, ::testing::ElementsAre(HasSubstr("well-known text")));
  ExpectSame(PlaceOf(Read({{"spatial_ref", text}}), {1894410.9, 1564649.5}), {35.0, -75.0});
  const GridMapping named = Read({{"crs_wkt", text},
                                  {"grid_mapping_name", "mercator"},
                                  {"standard_parallel", Numbers{0.0}},
                                  {"longitude_of_projection_origin", Numbers{0.0}},
                                  {"earth_radius", Numbers{6.37e6}}});
  EXPECT_THAT(named.projection, HasSubstr("+proj=merc"));
}

TEST(GridMappingTest, ErrorsNameTheAttribute) {
  const Attributes lambert = {{"grid_mapping_name", "lambert_conformal_conic"},
                              {"standard_parallel", Numbers{30.0, 60.0}},
                              {"longitude_of_central_meridian", Numbers{-97.0}},
                              {"latitude_of_projection_origin", Numbers{38.5}},
                              {"earth_radius", Numbers{6.37e6}}};
  const auto error = [](const Attributes& attributes) {
    const auto mapping = ReadGridMapping(attributes, {});
    EXPECT_EQ(mapping.status().code(), absl::StatusCode::kInvalidArgument);
    return std::string(mapping.status().message());
  };
  for (const char* const name : {"standard_parallel", "longitude_of_central_meridian",
                                 "latitude_of_projection_origin", "grid_mapping_name"}) {
    Attributes without = lambert;
    without.erase(name);
    EXPECT_THAT(error(without), HasSubstr(std::string("has no attribute ") + name));
  }
  const auto with = [&lambert](const char* name, AttributeValue value) {
    Attributes changed = lambert;
    changed[name] = std::move(value);
    return changed;
  };
  EXPECT_THAT(error(with("standard_parallel", "thirty")), HasSubstr("standard_parallel without"));
  EXPECT_THAT(error(with("standard_parallel", Numbers{})), HasSubstr("standard_parallel without"));
  EXPECT_THAT(error(with("standard_parallel", Numbers{1, 2, 3})), HasSubstr("more than two"));
  EXPECT_THAT(error(with("standard_parallel", Numbers{30.0, 120.0})), HasSubstr("-90 to 90"));
  EXPECT_THAT(error(with("standard_parallel", Numbers{30.0, -30.0})), HasSubstr("PROJ"));
  EXPECT_THAT(error(with("earth_radius", Numbers{-1.0})), HasSubstr("earth_radius -1"));
  EXPECT_THAT(error(with("latitude_of_projection_origin", Numbers{1.0, 2.0})),
              HasSubstr("several numbers in latitude_of_projection_origin"));
  EXPECT_THAT(error(with("grid_mapping_name", "sinusoidal")),
              HasSubstr("'sinusoidal', which is not supported; supported are albers"));
  EXPECT_THAT(error({{"grid_mapping_name", "polar_stereographic"},
                     {"straight_vertical_longitude_from_pole", Numbers{0.0}},
                     {"latitude_of_projection_origin", Numbers{90.0}}}),
              HasSubstr("neither of the attributes standard_parallel and "
                        "scale_factor_at_projection_origin"));
  EXPECT_THAT(error({{"grid_mapping_name", "polar_stereographic"},
                     {"straight_vertical_longitude_from_pole", Numbers{0.0}},
                     {"standard_parallel", Numbers{60.0}},
                     {"latitude_of_projection_origin", Numbers{60.0}}}),
              HasSubstr("must be 90 or -90"));
  EXPECT_THAT(error({{"grid_mapping_name", "rotated_latitude_longitude"},
                     {"grid_north_pole_latitude", Numbers{43.0}}}),
              HasSubstr("has no attribute grid_north_pole_longitude"));
  EXPECT_THAT(error({{"grid_mapping_name", "geostationary"},
                     {"perspective_point_height", Numbers{3.5e7}},
                     {"longitude_of_projection_origin", Numbers{0.0}}}),
              HasSubstr("has no attribute sweep_angle_axis"));
  EXPECT_THAT(error({{"crs_wkt", "no text"}}), HasSubstr("well-known text"));
}

}  // namespace
}  // namespace thunderhead::storm_files

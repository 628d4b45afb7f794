// Tests of places on maps against closed forms of the projections on a sphere (Snyder, Map
// Projections: A Working Manual, 1987).
#include "product/map_place.h"

#include <cmath>
#include <numbers>
#include <string>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "product/cf_grid_mapping.h"

namespace thunderhead::product {
namespace {

constexpr double kRadius_m = 6'370'000.0;  // radius of the Earth in WRF
constexpr double kRadian = std::numbers::pi / 180.0;
constexpr char kLambert[] =
    "+proj=lcc +lat_1=30 +lat_2=60 +lat_0=38.5 +lon_0=-97 +x_0=0 +y_0=0 +R=6370000 +units=m "
    "+no_defs";

double ConeOf(double latitude_deg) {
  return std::tan(std::numbers::pi / 4.0 + 0.5 * latitude_deg * kRadian);
}

// Returns the place on the map by equations 15-1 to 15-5 of Snyder.
glm::dvec2 Lambert_m(const Place& place) {
  const double n = std::log(std::cos(30.0 * kRadian) / std::cos(60.0 * kRadian)) /
                   std::log(ConeOf(60.0) / ConeOf(30.0));
  const double scale = kRadius_m * std::cos(30.0 * kRadian) * std::pow(ConeOf(30.0), n) / n;
  const double rho = scale / std::pow(ConeOf(place.latitude_deg), n);
  const double rho_0 = scale / std::pow(ConeOf(38.5), n);
  const double theta = n * (place.longitude_deg + 97.0) * kRadian;
  return {rho * std::sin(theta), rho_0 - rho * std::cos(theta)};
}

MapProjection Open(const std::string& text) {
  auto projection = MapProjection::Open(text);
  EXPECT_TRUE(projection.ok()) << projection.status();
  return *std::move(projection);
}

TEST(MapProjection, LambertAgreesWithSnyder) {
  const MapProjection projection = Open(kLambert);
  for (const Place& place : {Place{35.2, -97.4}, Place{49.0, -110.0}, Place{20.0, -70.0}}) {
    const glm::dvec2 expected = Lambert_m(place);
    const glm::dvec2 found = projection.PlaneOf_m(place);
    EXPECT_NEAR(found.x, expected.x, 1e-3);
    EXPECT_NEAR(found.y, expected.y, 1e-3);
    const Place back = projection.PlaceOf(found);
    EXPECT_NEAR(back.latitude_deg, place.latitude_deg, 1e-9);
    EXPECT_NEAR(back.longitude_deg, place.longitude_deg, 1e-9);
  }
}

TEST(MapProjection, AnUnknownOneIsRefusedByName) {
  const auto projection = MapProjection::Open("+proj=flat_earth");
  EXPECT_EQ(projection.status().code(), absl::StatusCode::kInvalidArgument);
  EXPECT_THAT(projection.status().message(), ::testing::HasSubstr("flat_earth"));
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
  EXPECT_EQ(lambert->numbers.at("earth_radius"), std::vector{kRadius_m});
  EXPECT_THAT(lambert->texts.at("crs_wkt"), ::testing::HasSubstr("Lambert Conic Conformal"));
  const auto polar =
      GridMappingOf(Open("+proj=stere +lat_0=-90 +lat_ts=-60 +lon_0=10 +x_0=0 +y_0=0 +R=6370000"));
  ASSERT_TRUE(polar.ok());
  EXPECT_EQ(polar->texts.at("grid_mapping_name"), "polar_stereographic");
  EXPECT_EQ(polar->numbers.at("latitude_of_projection_origin"), std::vector{-90.0});
  const auto degrees = GridMappingOf(Open("+proj=eqc +lat_ts=35 +lat_0=35 +lon_0=0 +R=6371229"));
  ASSERT_TRUE(degrees.ok());
  EXPECT_TRUE(degrees->in_degrees);
  EXPECT_EQ(GridMappingOf(Open("+proj=laea +R=6370000")).status().code(),
            absl::StatusCode::kInvalidArgument);
}

}  // namespace
}  // namespace thunderhead::product

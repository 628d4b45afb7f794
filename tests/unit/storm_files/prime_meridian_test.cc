// Tests of longitudes that count from another prime meridian than that of Greenwich. They cover
// every kind of grid mapping, axes in degrees, and longitudes of all columns.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "storm_files/grid_mapping.h"
#include "tests/unit/storm_files/cf_file_test.h"
#include "volume/map_projection.h"

// Tests are compiled together, and other tests have the same names.
namespace thunderhead::storm_files::prime_meridian_test {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;
using testing::Middles;
using ::testing::Not;
using testing::SyntheticCf;

constexpr double kParis_deg = 2.0 + 20.0 / 60.0 + 14.025 / 3600.0;

SyntheticCf Cloud() {
  SyntheticCf file = testing::ExtinctionFile(6, 4, 4, 1000.0, 1000.0, 500.0, {});
  file.variables[0] = {
      "qc", {"z", "y", "x"}, {{"units", "kg m-3"}}, [](const Index&) { return 1e-4; }};
  return file;
}

void AddMapping(SyntheticCf& file, const Texts& texts,
                const std::map<std::string, double>& numbers) {
  file.variables.push_back({"crs", {}, texts, [](const Index&) { return 0.0; }});
  file.number_attributes["crs"] = numbers;
  file.variables[0].attributes["grid_mapping"] = "crs";
}

// Returns the cloud on axes of longitude and latitude, with its middle at 10 E 47 N.
SyntheticCf InDegrees() {
  SyntheticCf file = Cloud();
  file.coordinates[0] = {"lon", Middles(6, 9.97, 0.01), {{"units", "degrees_east"}}, {}};
  file.coordinates[1] = {"lat", Middles(4, 46.98, 0.01), {{"units", "degrees_north"}}, {}};
  file.variables[0].dimensions = {"z", "lat", "lon"};
  return file;
}

// Adds longitudes and latitudes of all columns, as functions of their indices.
void AddPlaces(SyntheticCf& file, const std::function<double(double x, double y)>& longitude_deg,
               const std::function<double(double x, double y)>& latitude_deg) {
  const auto add = [&](const char* name, const char* units,
                       const std::function<double(double, double)>& value) {
    file.variables.push_back({name, {"y", "x"}, {{"units", units}}, [value](const Index& at) {
                                return value(static_cast<double>(at.at("x")),
                                             static_cast<double>(at.at("y")));
                              }});
  };
  add("lon2d", "degrees_east", longitude_deg);
  add("lat2d", "degrees_north", latitude_deg);
}

constexpr char kWktOfParis[] =
    "GEOGCRS[\"x\",DATUM[\"d\",ELLIPSOID[\"w\",6378137,298.257223563]],PRIMEM[\"Paris\","
    "2.33722917,ANGLEUNIT[\"degree\",0.0174532925199433]],CS[ellipsoidal,2],AXIS[\"latitude\","
    "north],AXIS[\"longitude\",east],ANGLEUNIT[\"degree\",0.0174532925199433]]";

class PrimeMeridian : public CfFileTest {
 protected:
  // Returns the longitude of the middle of the domain.
  double LongitudeOf(const SyntheticCf& file) {
    const auto fields = Read(file);
    EXPECT_TRUE(fields.ok()) << fields.status();
    return info_.longitude_deg.value_or(1000.0);
  }
};

TEST_F(PrimeMeridian, MovesAxesOfLongitude) {
  for (const double meridian_deg : {0.0, kParis_deg, -17.6666667, 90.0, 175.0, -175.0}) {
    SyntheticCf file = InDegrees();
    AddMapping(file, {{"grid_mapping_name", "latitude_longitude"}},
               {{"earth_radius", 6371229.0}, {"longitude_of_prime_meridian", meridian_deg}});
    const double east_deg = 10.0 + meridian_deg;
    EXPECT_NEAR(LongitudeOf(file), east_deg > 180.0 ? east_deg - 360.0 : east_deg, 1e-6);
    EXPECT_NEAR(*info_.latitude_deg, 47.0, 1e-3);
    const auto says = Contains(HasSubstr("The longitudes lon count from the prime meridian"));
    if (meridian_deg == 0.0) {
      EXPECT_THAT(info_.assumptions, Not(says));
    } else {
      EXPECT_THAT(info_.assumptions, says);
    }
  }
}

TEST_F(PrimeMeridian, MayBeAName) {
  const std::map<std::string, double> meridians = {
      {"Greenwich", 0.0}, {"Paris", kParis_deg}, {"ferro", -17.6666667}, {"Rome", 12.4523333}};
  for (const auto& [name, meridian_deg] : meridians) {
    SyntheticCf file = InDegrees();
    AddMapping(file, {{"grid_mapping_name", "latitude_longitude"}, {"prime_meridian_name", name}},
               {});
    EXPECT_NEAR(LongitudeOf(file), 10.0 + meridian_deg, 1e-6) << name;
  }
  SyntheticCf file = InDegrees();
  AddMapping(file, {{"grid_mapping_name", "latitude_longitude"}, {"prime_meridian_name", "Ys"}},
             {});
  ExpectError(file,
              "the grid mapping crs has prime_meridian_name 'Ys', which is not known; add "
              "longitude_of_prime_meridian");
  // If the mapping has both a name and a number of its prime meridian, the number is used.
  file.number_attributes["crs"] = {{"longitude_of_prime_meridian", 5.0}};
  EXPECT_NEAR(LongitudeOf(file), 15.0, 1e-6);
  file.number_attributes["crs"] = {{"longitude_of_prime_meridian", 400.0}};
  ExpectError(file, "longitude_of_prime_meridian 400, which is not from -360 to 360");
  file.number_attributes.clear();
  file.variables.back().attributes["longitude_of_prime_meridian"] = "Paris";
  ExpectError(file, "an attribute longitude_of_prime_meridian without a number");
}

TEST_F(PrimeMeridian, MayBeInWellKnownText) {
  for (const Texts& texts :
       {Texts{{"crs_wkt", kWktOfParis}}, Texts{{"spatial_ref", kWktOfParis}},
        Texts{{"grid_mapping_name", "latitude_longitude"}, {"crs_wkt", kWktOfParis}}}) {
    SyntheticCf file = InDegrees();
    AddMapping(file, texts, {});
    EXPECT_NEAR(LongitudeOf(file), 10.0 + 2.33722917, 1e-6);
  }
}

// The place of rlon 10, rlat 5 follows from the rotation's formulas (pole at 43 N, 172 W).
TEST_F(PrimeMeridian, MovesRotatedGrids) {
  SyntheticCf file = Cloud();
  file.coordinates[0] = {"rlon", Middles(6, 9.97, 0.01), {{"units", "degrees"}}, {}};
  file.coordinates[1] = {"rlat", Middles(4, 4.98, 0.01), {{"units", "degrees"}}, {}};
  file.variables[0].dimensions = {"z", "rlat", "rlon"};
  AddMapping(file, {{"grid_mapping_name", "rotated_latitude_longitude"}},
             {{"grid_north_pole_latitude", 43.0},
              {"grid_north_pole_longitude", -172.0},
              {"longitude_of_prime_meridian", 90.0}});
  EXPECT_NEAR(LongitudeOf(file), 23.94830 + 90.0, 1e-3);
  EXPECT_NEAR(*info_.latitude_deg, 50.98145, 1e-3);
}

// The middle of the domain is on the central meridian of each mapping, which is 8 degrees from the
// prime meridian.
TEST_F(PrimeMeridian, MovesEveryProjection) {
  struct Mapping {
    const char* name;
    std::map<std::string, double> numbers;
  };
  const std::map<std::string, double> origin = {{"latitude_of_projection_origin", 0.0},
                                                {"longitude_of_projection_origin", 8.0}};
  const std::map<std::string, double> cone = {{"latitude_of_projection_origin", 40.0},
                                              {"longitude_of_central_meridian", 8.0},
                                              {"standard_parallel", 40.0}};
  const auto with = [](std::map<std::string, double> numbers, const char* name, double value) {
    numbers[name] = value;
    return numbers;
  };
  const std::vector<Mapping> mappings = {
      {"albers_conical_equal_area", cone},
      {"lambert_conformal_conic", cone},
      {"lambert_cylindrical_equal_area", cone},
      {"azimuthal_equidistant", origin},
      {"lambert_azimuthal_equal_area", origin},
      {"mercator", with(origin, "standard_parallel", 0.0)},
      {"stereographic", with(origin, "scale_factor_at_projection_origin", 1.0)},
      {"transverse_mercator", with(cone, "scale_factor_at_central_meridian", 1.0)},
  };
  for (const Mapping& mapping : mappings) {
    for (const double meridian_deg : {0.0, kParis_deg, -90.0}) {
      SyntheticCf file = Cloud();
      file.coordinates[0].values = Middles(6, -3000.0, 1000.0);
      file.coordinates[1].values = Middles(4, -2000.0, 1000.0);
      AddMapping(file, {{"grid_mapping_name", mapping.name}},
                 with(mapping.numbers, "longitude_of_prime_meridian", meridian_deg));
      EXPECT_NEAR(LongitudeOf(file), 8.0 + meridian_deg, 1e-4) << mapping.name;
    }
  }
}

// If each column has its longitude, the prime meridian is taken from a grid mapping of longitudes
// and latitudes, or from the mapping that the field names for these coordinates.
TEST_F(PrimeMeridian, MovesLongitudesOfAllColumns) {
  SyntheticCf file = Cloud();
  file.coordinates[0].written = false;
  file.coordinates[1].written = false;
  AddPlaces(
      file, [](double x, double) { return 8.0 + 0.01 * (x - 2.5); },
      [](double, double y) { return 47.0 + 0.01 * (y - 1.5); });
  file.variables[0].attributes["coordinates"] = "lon2d lat2d";
  EXPECT_NEAR(LongitudeOf(file), 8.0, 1e-4);
  AddMapping(file, {{"grid_mapping_name", "latitude_longitude"}},
             {{"longitude_of_prime_meridian", kParis_deg}});
  EXPECT_NEAR(LongitudeOf(file), 8.0 + kParis_deg, 1e-4);
  EXPECT_THAT(info_.assumptions, Contains(HasSubstr("The longitudes lon2d count from")));
  file.variables[0].attributes["grid_mapping"] = "none: x y crs: lat2d lon2d";
  EXPECT_NEAR(LongitudeOf(file), 8.0 + kParis_deg, 1e-4);
  // The mapping of other coordinates says nothing about the longitudes.
  file.variables[0].attributes["grid_mapping"] = "crs";
  file.variables.back().attributes["grid_mapping_name"] = "mercator";
  EXPECT_NEAR(LongitudeOf(file), 8.0, 1e-4);
  EXPECT_THAT(info_.assumptions, Contains(HasSubstr("lon2d are taken to count from Greenwich")));
}

// With a map, the longitudes of all columns may count from Greenwich or from the map's meridian.
TEST_F(PrimeMeridian, LongitudesOfAllColumnsAgreeWithTheMapFromEitherMeridian) {
  constexpr double kPerDegree_m = 6371000.0 * M_PI / 180.0;
  for (const double counted_from_deg : {0.0, kParis_deg, 1.0}) {
    SyntheticCf file = Cloud();
    file.coordinates[0].values = Middles(6, -30'000.0, 10'000.0);
    file.coordinates[1].values = Middles(4, -20'000.0, 10'000.0);
    AddPlaces(
        file,
        [=](double x, double) {
          return 8.0 + kParis_deg - counted_from_deg + (x - 2.5) * 1e4 / kPerDegree_m;
        },
        [=](double, double y) { return (y - 1.5) * 1e4 / kPerDegree_m; });
    AddMapping(file, {{"grid_mapping_name", "mercator"}},
               {{"standard_parallel", 0.0},
                {"longitude_of_projection_origin", 8.0},
                {"earth_radius", 6371000.0},
                {"longitude_of_prime_meridian", kParis_deg}});
    const double expected_deg = 8.0 + kParis_deg - (counted_from_deg == 1.0 ? 1.0 : 0.0);
    EXPECT_NEAR(LongitudeOf(file), expected_deg, 1e-3) << counted_from_deg;
    const auto says = Contains(HasSubstr("The longitudes lon2d count from the prime meridian"));
    if (counted_from_deg == kParis_deg) {
      EXPECT_THAT(info_.assumptions, says);
    } else {
      EXPECT_THAT(info_.assumptions, Not(says));
    }
  }
}

// Several mappings are told apart by the coordinates for which they are named.
TEST_F(PrimeMeridian, IsThatOfTheMappingOfTheCoordinate) {
  SyntheticCf file = InDegrees();
  AddMapping(file, {{"grid_mapping_name", "latitude_longitude"}},
             {{"longitude_of_prime_meridian", kParis_deg}});
  file.variables.push_back(
      {"other", {}, {{"grid_mapping_name", "latitude_longitude"}}, [](const Index&) {
         return 0.0;
       }});
  file.variables[0].attributes["grid_mapping"] = "other: a b crs: lat lon";
  EXPECT_NEAR(LongitudeOf(file), 10.0 + kParis_deg, 1e-6);
  file.variables[0].attributes["grid_mapping"] = "crs: a b other: lat lon";
  EXPECT_NEAR(LongitudeOf(file), 10.0, 1e-6);
}

TEST(PrimeMeridianText, AMapInWellKnownTextKeepsItsNamedMeridian) {
  const Attributes attributes = {
      {"crs_wkt",
       "PROJCRS[\"x\",BASEGEOGCRS[\"b\",DATUM[\"d\",ELLIPSOID[\"s\",6371000,0]],PRIMEM[\"Paris\","
       "2.5969213,ANGLEUNIT[\"grad\",0.01570796326794897]]],CONVERSION[\"m\",METHOD[\"Mercator "
       "(variant A)\",ID[\"EPSG\",9804]],PARAMETER[\"Latitude of natural origin\",0,"
       "ANGLEUNIT[\"degree\",0.0174532925199433]],PARAMETER[\"Longitude of natural origin\",8,"
       "ANGLEUNIT[\"degree\",0.0174532925199433]],PARAMETER[\"Scale factor at natural origin\",1,"
       "SCALEUNIT[\"unity\",1]],PARAMETER[\"False easting\",0,LENGTHUNIT[\"metre\",1]],"
       "PARAMETER[\"False northing\",0,LENGTHUNIT[\"metre\",1]]],CS[Cartesian,2],AXIS[\"(E)\","
       "east],AXIS[\"(N)\",north],LENGTHUNIT[\"metre\",1]]"}};
  const auto mapping = ReadGridMapping(attributes, MappedGrid());
  ASSERT_TRUE(mapping.ok()) << mapping.status();
  const auto place = volume::MapProjection::Open(mapping->projection)->PlaceOf({0.0, 0.0});
  ASSERT_TRUE(place.has_value()) << mapping->projection;
  EXPECT_NEAR(place->longitude_deg, 8.0 + kParis_deg, 1e-6);
}

}  // namespace
}  // namespace thunderhead::storm_files::prime_meridian_test

// Tests of CF files as storms: axes in any order and direction, quantities by standard name or
// name, clear errors for incomplete files.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "physics/air.h"
#include "storm_files/cf_names.h"
#include "storm_files/units.h"
#include "storm_files/vertical_remap.h"
#include "tests/support/captured_log.h"
#include "tests/unit/storm_files/cf_file_test.h"

namespace thunderhead::storm_files {
namespace {

using testing::CapturedLog;
using testing::CfContent;
using testing::CfCoordinate;
using ::testing::Contains;
using testing::ExtinctionFile;
using ::testing::HasSubstr;
using testing::Middles;
using ::testing::SizeIs;
using testing::SyntheticCf;

// Returns a value that differs in every cell and is above zero.
double Value(std::size_t x, std::size_t y, std::size_t z) {
  return 1e-3 * static_cast<double>(1 + x + 10 * y + 100 * z);
}

class CfReader : public CfFileTest {
 protected:
  void ExpectValues(const volume::HydrometeorFields& fields) {
    ASSERT_THAT(fields.fields, SizeIs(1));
    const auto& values = fields.fields[0].concentration_kg_per_m3;
    ASSERT_THAT(values, SizeIs(fields.grid.CellCount()));
    for (int z = 0; z < fields.grid.cells.z; ++z) {
      for (int y = 0; y < fields.grid.cells.y; ++y) {
        for (int x = 0; x < fields.grid.cells.x; ++x) {
          EXPECT_FLOAT_EQ(values[fields.grid.Offset(x, y, z)], static_cast<float>(Value(x, y, z)));
        }
      }
    }
  }
};

SyntheticCf Small() { return ExtinctionFile(4, 3, 2, 100.0, 200.0, 50.0, Value); }

TEST_F(CfReader, ReadsExtinctionAsOneFieldOnItsGrid) {
  const auto fields = Read(Small());
  ASSERT_TRUE(fields.ok()) << fields.status();
  EXPECT_EQ((*fields)->grid.cells, glm::ivec3(4, 3, 2));
  EXPECT_EQ((*fields)->grid.spacing_m, glm::dvec3(100.0, 200.0, 50.0));
  EXPECT_EQ((*fields)->grid.low_corner_m, glm::dvec3(-200.0, -300.0, 0.0));
  ExpectValues(**fields);
  const volume::HydrometeorField& field = (*fields)->fields[0];
  EXPECT_EQ(field.quantity, volume::Quantity::kExtinction);
  EXPECT_EQ(field.variable, "extinction");
  physics::ParticleOptics optics = physics::DefaultOptics(field.hydrometeor);
  EXPECT_EQ(volume::MassExtinctionOf(field, optics, physics::SizeSource::kModel).m2_per_kg, 1.0F);
  optics.radius_m *= 7.0F;
  EXPECT_EQ(volume::MassExtinctionOf(field, optics, physics::SizeSource::kGiven).m2_per_kg, 1.0F);
  EXPECT_NEAR(field.statistics.maximum_water_path_kg_per_m2,
              50.0 * (Value(3, 2, 0) + Value(3, 2, 1)), 1e-4);
  EXPECT_EQ((*fields)->condensate, (volume::CellBox{{0, 0, 0}, {4, 3, 2}}));
  EXPECT_EQ(info_.times[0].valid_time, "0001-01-01T00:00:00Z");
}

TEST_F(CfReader, TakesAnyOrderOfDimensions) {
  for (const std::vector<std::string>& order : {std::vector<std::string>{"x", "y", "z"},
                                                {"y", "z", "x"},
                                                {"z", "x", "y"},
                                                {"x", "z", "y"},
                                                {"y", "x", "z"}}) {
    SyntheticCf file = Small();
    file.variables[0].dimensions = order;
    const auto fields = Read(file);
    ASSERT_TRUE(fields.ok()) << fields.status();
    ExpectValues(**fields);
  }
}

TEST_F(CfReader, TakesAxesThatRunWestSouthOrDown) {
  for (const std::size_t reversed : {0U, 1U, 2U}) {
    SyntheticCf file = Small();
    CfCoordinate& axis = file.coordinates[reversed];
    std::ranges::reverse(axis.values);
    const std::size_t last = axis.values.size() - 1;
    const std::string name = axis.name;
    file.variables[0].value = [last, name](Index at) {
      at[name] = last - at[name];
      return Value(at["x"], at["y"], at["z"]);
    };
    const auto fields = Read(file);
    ASSERT_TRUE(fields.ok()) << fields.status();
    EXPECT_EQ((*fields)->grid.low_corner_m, glm::dvec3(-200.0, -300.0, 0.0));
    ExpectValues(**fields);
  }
}

TEST_F(CfReader, DepthsPointDown) {
  SyntheticCf file = Small();
  file.coordinates[2] = {"level", {-25.0, -75.0}, {{"units", "m"}, {"positive", "down"}}, {}};
  file.variables[0].dimensions[0] = "level";
  file.variables[0].value = [](Index at) { return Value(at["x"], at["y"], at["level"]); };
  const auto fields = Read(file);
  ASSERT_TRUE(fields.ok()) << fields.status();
  EXPECT_EQ((*fields)->grid.low_corner_m.z, 0.0);
  ExpectValues(**fields);
  // Heights that are marked as depths would turn the storm upside down below the sea.
  file.coordinates[2].values = {25.0, 75.0};
  ExpectError(file, "its layers lie 0 to 100 m below sea level");
}

// The names are meaningless. Each axis is identified by a different attribute.
TEST_F(CfReader, AxesAreKnownByAttributesStandardNamesOrUnits) {
  SyntheticCf file = Small();
  file.coordinates[0] = {"a", Middles(4, 0.0, 0.1), {{"units", "km"}, {"axis", "X"}}, {}};
  file.coordinates[1] = {"b",
                         Middles(3, 7.0, 200.0),
                         {{"units", "m"}, {"standard_name", "projection_y_coordinate"}},
                         {}};
  file.coordinates[2] = {"c", Middles(2, 0.0, 50.0), {{"units", "m"}, {"positive", "up"}}, {}};
  file.variables[0].dimensions = {"a", "c", "b"};
  file.variables[0].value = [](Index at) { return Value(at["a"], at["b"], at["c"]); };
  const auto fields = Read(file);
  ASSERT_TRUE(fields.ok()) << fields.status();
  EXPECT_NEAR((*fields)->grid.spacing_m.x, 100.0, 1e-9);
  ExpectValues(**fields);
}

TEST_F(CfReader, SingleCellsHaveTheSizeOfTheirBounds) {
  SyntheticCf file = ExtinctionFile(1, 1, 1, 100.0, 200.0, 50.0, Value);
  file.coordinates[0].faces = {1000.0, 1300.0};
  file.coordinates[2].faces = {500.0, 450.0};
  const auto fields = Read(file);
  ASSERT_TRUE(fields.ok()) << fields.status();
  EXPECT_EQ((*fields)->grid.spacing_m, glm::dvec3(300.0, 200.0, 50.0));
  EXPECT_EQ((*fields)->grid.low_corner_m.z, 450.0);
  file.coordinates[2].faces = {};
  file.coordinates[2].values = {0.0};
  ExpectError(file, "bounds");
  // The file is a slice with one cell along y, at y = 0. The width of this cell is unknown, so it
  // is taken from the other axis.
  file = ExtinctionFile(4, 1, 1, 100.0, 1.0, 50.0, Value);
  file.coordinates[1].values = {0.0};
  const auto slice = Read(file);
  ASSERT_TRUE(slice.ok()) << slice.status();
  EXPECT_EQ((*slice)->grid.spacing_m, glm::dvec3(100.0, 100.0, 50.0));
}

// Each layer is 7.3 % thicker than the one below. The column's optical depth must be kept.
TEST_F(CfReader, UnevenLayersKeepTheirOpticalDepth) {
  SyntheticCf file = ExtinctionFile(1, 1, 20, 100.0, 100.0, 1.0, Value);
  std::vector<double> faces = {0.0};
  double depth = 0.0;
  for (std::size_t z = 0; z < 20; ++z) {
    const double thickness_m = 30.0 * std::pow(1.073, static_cast<double>(z));
    file.coordinates[2].values[z] = faces.back() + 0.5 * thickness_m;
    faces.push_back(faces.back() + thickness_m);
    depth += thickness_m * Value(0, 0, z);
  }
  for (const bool bounds : {false, true}) {
    if (bounds) file.coordinates[2].faces = faces;
    const auto fields = Read(file);
    ASSERT_TRUE(fields.ok()) << fields.status();
    // The grid is the one that layers of the same heights get from every format.
    const volume::RegularGrid& grid = (*fields)->grid;
    const VerticalGrid chosen =
        ChooseVerticalGrid(std::vector<float>(faces.begin(), faces.end()), 20, 1);
    EXPECT_EQ(grid.cells.z, chosen.cells);
    EXPECT_NEAR(grid.spacing_m.z, chosen.spacing_m, 1e-3);
    EXPECT_GE(grid.HighCorner_m().z, faces.back());
    double on_grid = 0.0;
    for (const float each : (*fields)->fields[0].concentration_kg_per_m3) {
      on_grid += each * grid.spacing_m.z;
    }
    EXPECT_NEAR(on_grid, depth, 1e-5 * depth);
    EXPECT_NEAR((*fields)->fields[0].statistics.mean_water_path_kg_per_m2, depth, 1e-5 * depth);
  }
}

SyntheticCf Water(const std::string& name, const std::map<std::string, std::string>& attributes,
                  double amount) {
  SyntheticCf file = Small();
  file.variables[0] = {
      name, {"z", "y", "x"}, attributes, [amount](const Index&) { return amount; }};
  return file;
}

TEST_F(CfReader, HydrometeorsByStandardNameOrNameInTheirUnits) {
  struct Case {
    std::string name;
    std::map<std::string, std::string> attributes;
    double amount;
    physics::Hydrometeor hydrometeor;
    float concentration_kg_per_m3;
  };
  using physics::Hydrometeor;
  const std::string concentration = "mass_concentration_of_";
  for (const Case& c : {
           Case{"w",
                {{"standard_name", concentration + "cloud_liquid_water_in_air"},
                 {"units", "kg m-3"}},
                2e-4,
                Hydrometeor::kCloud,
                2e-4F},
           Case{"w",
                {{"standard_name", concentration + "liquid_water_in_air"}, {"units", "g m**-3"}},
                0.5,
                Hydrometeor::kCloud,
                5e-4F},
           Case{"lwc", {{"units", "g/m^3"}}, 0.3, Hydrometeor::kCloud, 3e-4F},
           Case{"QS", {{"units", "mg m-3"}}, 70.0, Hydrometeor::kSnow, 7e-5F},
           Case{"QS", {{"units", "ug.m^(-3)"}}, 7e4, Hydrometeor::kSnow, 7e-5F},
           Case{"QHL", {{"units", "1e-3 kg m-3"}}, 0.5, Hydrometeor::kHail, 5e-4F},
           Case{"hail",
                {{"standard_name", concentration + "hail_in_air"}, {"units", "kg m-3"}},
                1e-3,
                Hydrometeor::kHail,
                1e-3F},
       }) {
    SCOPED_TRACE(c.name + " " + c.attributes.begin()->second);
    const auto fields = Read(Water(c.name, c.attributes, c.amount));
    ASSERT_TRUE(fields.ok()) << fields.status();
    const volume::HydrometeorField& field = (*fields)->fields[0];
    EXPECT_EQ(field.hydrometeor, c.hydrometeor);
    EXPECT_EQ(field.quantity, volume::Quantity::kMassConcentration);
    EXPECT_FLOAT_EQ(field.concentration_kg_per_m3[5], c.concentration_kg_per_m3);
    EXPECT_FLOAT_EQ(field.statistics.maximum, c.concentration_kg_per_m3);
  }
}

CfContent UniformField(const std::string& name, const std::string& units, double value) {
  return {name, {"y", "z", "x"}, {{"units", units}}, [value](const Index&) { return value; }};
}

// Mixing ratios are multiplied by the density of the air that they refer to.
TEST_F(CfReader, MixingRatiosTakeTheAirsDensity) {
  const double q_v = 0.01;
  const double dry = physics::DryAirDensity_kg_per_m3(9e4, 290.0, q_v);
  SyntheticCf file = Water("qc", {{"units", "g/kg"}}, 0.8);
  file.variables.push_back(UniformField("prs", "hPa", 900.0));
  file.variables.push_back(UniformField("temp", "K", 290.0));
  file.variables.push_back(UniformField("qv", "kg/kg", q_v));
  auto fields = Read(file);
  ASSERT_TRUE(fields.ok()) << fields.status();
  EXPECT_NEAR((*fields)->fields[0].concentration_kg_per_m3[3], 0.8e-3 * dry, 1e-9);
  EXPECT_FLOAT_EQ((*fields)->fields[0].statistics.maximum, 0.8e-3F);
  file.variables[0] =
      Water("w", {{"standard_name", "mass_fraction_of_cloud_liquid_water_in_air"}, {"units", "1"}},
            0.8e-3)
          .variables[0];
  fields = Read(file);
  ASSERT_TRUE(fields.ok()) << fields.status();
  // A mass fraction is a share of dry air, vapour and condensate together.
  const double whole = dry * (1.0 + q_v) / (1.0 - 0.8e-3);
  EXPECT_NEAR((*fields)->fields[0].concentration_kg_per_m3[3], 0.8e-3 * whole, 1e-9);
  file.variables = {file.variables[0], UniformField("rho", "kg m-3", 0.9)};
  fields = Read(file);
  ASSERT_TRUE(fields.ok()) << fields.status();
  EXPECT_NEAR((*fields)->fields[0].concentration_kg_per_m3[3], 0.8e-3 * 0.9, 1e-9);
}

TEST_F(CfReader, TimesAreRecords) {
  SyntheticCf file = Small();
  file.coordinates.push_back(
      {"time", {0.0, 90.5}, {{"units", "minutes since 2013-05-20 18:00:00"}}, {}});
  file.variables[0].dimensions = {"time", "z", "y", "x"};
  file.variables[0].value = [](Index at) {
    return Value(at["x"], at["y"], at["z"]) * (at["time"] == 1 ? 1.0 : 2.0);
  };
  const auto fields = Read(file, 1);
  ASSERT_TRUE(fields.ok()) << fields.status();
  ExpectValues(**fields);
  ASSERT_THAT(info_.times, SizeIs(2));
  EXPECT_EQ(info_.times[1].valid_time, "2013-05-20T19:30:30Z");
}

// Returns a file with one time in these units.
SyntheticCf Timed(const std::string& units, double time) {
  SyntheticCf file = Small();
  file.coordinates.push_back({"time", {time}, {{"units", units}}, {}});
  file.variables[0].dimensions = {"time", "z", "y", "x"};
  return file;
}

TEST_F(CfReader, TimesCountFromTheDateOfTheirUnits) {
  const std::tuple<const char*, double, const char*> cases[] = {
      {"seconds since 2013-05-20 18:00:00", 90.0, "2013-05-20T18:01:30Z"},
      {"hours since 2013-05-20 18:00:00 +05:30", 2.0, "2013-05-20T14:30:00Z"},
      {"hours since 2013-05-20 18:00:00 -6:00", -1.0, "2013-05-20T23:00:00Z"},
      {"days since 2012-02-28", 1.0, "2012-02-29T00:00:00Z"},
      {"days since 2013-02-28", 1.0, "2013-03-01T00:00:00Z"},
      {"minutes since 0001-01-01 00:00:00", 20.0, "0001-01-01T00:20:00Z"},
      {"min", 20.0, "0001-01-01T00:20:00Z"},  // units as in an idealised run
      {"", 20.0, "0001-01-01T00:00:00Z"},
  };
  for (const auto& [units, time, expected] : cases) {
    const auto fields = Read(Timed(units, time));
    ASSERT_TRUE(fields.ok()) << fields.status();
    EXPECT_EQ(info_.times[0].valid_time, expected) << units;
  }
}

TEST_F(CfReader, TimesThatCountFromNoDateAreRefused) {
  for (const std::string units :
       {"seconds since 2013-13-20 18:00:00", "seconds since 2013-05-20 99:99:99",
        "seconds since 2013-05-20 18:00:00 +9999", "seconds since 2013-02-29",
        "seconds since 2013-05-20 24:00:00", "moons since 2013-05-20", "months since 2013-05-20",
        "10 minutes since 2013-05-20", "K"}) {
    ExpectError(Timed(units, 0.0), "the coordinate time has units '" + units + "'");
  }
  SyntheticCf file = Timed("", 0.0);
  file.coordinates.back().values = {0.0, 1.0};
  ExpectError(file, "the coordinate time has no units");
}

// The expected times were computed with cftime.
TEST_F(CfReader, TimesHaveTheDatesOfTheFilesCalendar) {
  SyntheticCf file = Timed("days since 2013-02-28", 1.0);
  for (const char* calendar : {"standard", "gregorian", "Gregorian", "proleptic_gregorian"}) {
    file.coordinates.back().attributes["calendar"] = calendar;
    ASSERT_TRUE(Read(file).ok()) << calendar;
    EXPECT_EQ(info_.times[0].valid_time, "2013-03-01T00:00:00Z");
  }
  const std::tuple<const char*, const char*, double, const char*> cases[] = {
      {"noleap", "days since 1900-01-01", 41384.833333333336, "2013-05-20T20:00:00Z"},
      {"365_day", "days since 1900-01-01", 41384.833333333336, "2013-05-20T20:00:00Z"},
      {"all_leap", "days since 2012-02-28", 1.0, "2012-02-29T00:00:00Z"},
      {"360_day", "days since 1900-01-01", 40819.833333333336, "2013-05-20T20:00:00Z"},
      {"julian", "days since 1900-01-01", 41413.833333333336, "2013-05-20T20:00:00Z"},
      // CF's default calendar has two more days in the years since 1.
      {"standard", "hours since 0001-01-01 00:00:00", 17637120.0, "2013-01-11T00:00:00Z"},
      {"proleptic_gregorian", "hours since 0001-01-01", 17637120.0, "2013-01-13T00:00:00Z"},
      {"standard", "days since -4713-01-01 12:00:00", 2456433.3333333335, "2013-05-20T20:00:00Z"},
      {"standard", "day as %Y%m%d.%f", 20130520.833333332, "2013-05-20T20:00:00Z"},
      {"360_day", "day as %Y%m%d.%f", 20130520.25, "2013-05-20T06:00:00Z"},
  };
  for (const auto& [calendar, units, time, expected] : cases) {
    file = Timed(units, time);
    file.coordinates.back().attributes["calendar"] = calendar;
    const auto fields = Read(file);
    ASSERT_TRUE(fields.ok()) << fields.status();
    EXPECT_EQ(info_.times[0].valid_time, expected) << calendar << " " << units;
  }
  file.coordinates.back().attributes["calendar"] = "noleap";
  ASSERT_TRUE(Read(file).ok());
  EXPECT_THAT(info_.assumptions, Contains(HasSubstr("calendar noleap")));
}

TEST_F(CfReader, DatesThatNoOtherCalendarHasAreRefused) {
  SyntheticCf file = Timed("days since 2013-02-28", 2.0);
  file.coordinates.back().attributes["calendar"] = "360_day";
  ExpectError(file, "2013-02-30 of the calendar 360_day");
  file.coordinates.back().attributes["calendar"] = "mayan";
  ExpectError(file, "counts in the calendar 'mayan'");
  ExpectError(Timed("months since 2013-05-20", 1.0), "months and years have no fixed length");
  ExpectError(Timed("years since 2013-05-20", 1.0), "months and years have no fixed length");
  ExpectError(Timed("month as %Y%m.%f", 201305.5), "only 'day as %Y%m%d.%f'");
  ExpectError(Timed("days since 2013-05-00", 1.0), "day 0");
  ExpectError(Timed("days since 0000-01-01", 735374.0), "no year 0");
  ExpectError(Timed("day as %Y%m%d.%f", 20130230.0), "20130230");
  file = Timed("days since 2013-02-29", 1.0);
  ExpectError(file, "does not exist in the calendar standard");
}

// Returns a file whose fields have no time dimension.
SyntheticCf WithScalarTime() {
  SyntheticCf file = Small();
  file.variables[0].attributes["coordinates"] = "valid";
  file.variables.push_back(
      {"valid",
       {},
       {{"units", "hours since 2013-05-20 18:00:00"}, {"standard_name", "time"}},
       [](const Index&) { return 2.5; }});
  return file;
}

TEST_F(CfReader, TimesMayBeScalarOrAuxiliary) {
  ASSERT_TRUE(Read(WithScalarTime()).ok());
  EXPECT_EQ(info_.times[0].valid_time, "2013-05-20T20:30:00Z");
  // The dimension is a number of the record, and an auxiliary coordinate has the times.
  SyntheticCf file = Timed("1", 7.0);
  file.coordinates.back().attributes = {{"units", "1"}, {"axis", "T"}};
  file.variables.push_back(
      {"valid_time", {"time"}, {{"units", "hours since 2013-05-20 18:00:00"}}, [](const Index&) {
         return 2.0;
       }});
  ASSERT_TRUE(Read(file).ok());
  EXPECT_EQ(info_.times[0].valid_time, "2013-05-20T20:00:00Z");
  // Files made from GRIB give the start of the forecast and the time since then.
  file = WithScalarTime();
  file.variables.back().attributes["standard_name"] = "forecast_reference_time";
  file.variables.push_back(
      {"step", {}, {{"units", "minutes"}, {"standard_name", "forecast_period"}}, [](const Index&) {
         return 15.0;
       }});
  ASSERT_TRUE(Read(file).ok());
  EXPECT_EQ(info_.times[0].valid_time, "2013-05-20T20:45:00Z");
  EXPECT_EQ(info_.run_start, "2013-05-20T20:30:00Z");
  // PALM gives the date apart from the units.
  file = Timed("seconds", 3600.0);
  file.attributes["origin_time"] = "2013-05-20 18:00:00 +00";
  ASSERT_TRUE(Read(file).ok());
  EXPECT_EQ(info_.times[0].valid_time, "2013-05-20T19:00:00Z");
}

TEST_F(CfReader, TimesThatOccurTwiceOrFallAreReported) {
  SyntheticCf file = Timed("hours since 2013-05-20 18:00:00", 2.0);
  file.coordinates.back().values = {2.0, 2.0};
  ASSERT_TRUE(Read(file).ok());
  EXPECT_THAT(info_.assumptions, Contains(HasSubstr("twice")));
  file.coordinates.back().values = {2.5, 2.0};
  ASSERT_TRUE(Read(file).ok());
  EXPECT_THAT(info_.assumptions, Contains(HasSubstr("do not rise")));
  EXPECT_EQ(info_.times[0].valid_time, "2013-05-20T20:00:00Z");
}

TEST_F(CfReader, CoordinatesInOtherUnitsAreRefused) {
  SyntheticCf file = Small();
  file.coordinates[0].attributes["axis"] = "X";
  for (const std::string units :
       {"degrees_north", "degrees_west", "degree_Celsius", "hPa", "1", "s"}) {
    file.coordinates[0].attributes["units"] = units;
    ExpectError(file, "the coordinate x has units '" + units + "'");
  }
  file = Small();
  file.coordinates[2].attributes["axis"] = "Z";
  for (const std::string units : {"degrees_north", "degrees", "s"}) {
    file.coordinates[2].attributes["units"] = units;
    ExpectError(file, "the coordinate z has units '" + units + "'");
  }
  for (const std::string units : {"1", "level"}) {
    file.coordinates[2].attributes["units"] = units;
    ExpectError(
        file, "the vertical coordinate z has units '" + units + "', so it holds numbers of levels");
  }
  file.coordinates[2].attributes["units"] = "hPa";
  ExpectError(file, "the vertical coordinate z holds pressures");
  file = Small();
  file.coordinates[2].attributes["positive"] = "sideways";
  ExpectError(file, "positive 'sideways'");
  file = Small();
  file.coordinates[0].name = "lon";
  file.coordinates[0].attributes.clear();
  file.variables[0].dimensions = {"z", "y", "lon"};
  file.variables[0].value = [](const Index&) { return 0.0; };
  ExpectError(file, "the coordinate lon has no units");
}

TEST_F(CfReader, CoordinatesWithoutUnitsAreTakenToBeInMetres) {
  SyntheticCf file = Small();
  for (CfCoordinate& coordinate : file.coordinates) coordinate.attributes.clear();
  const auto fields = Read(file);
  ASSERT_TRUE(fields.ok()) << fields.status();
  EXPECT_EQ((*fields)->grid.spacing_m, glm::dvec3(100.0, 200.0, 50.0));
  for (const char* name : {"x", "y", "z"}) {
    EXPECT_THAT(info_.assumptions,
                Contains(std::string(name) + " has no units; it is taken to be in m."));
  }
}

TEST_F(CfReader, BoundsAreInTheUnitsOfTheirCoordinate) {
  SyntheticCf file = Small();
  file.coordinates[2] = {"z", {0.025, 0.075}, {{"units", "km"}}, {0.0, 0.05, 0.1}};
  file.bounds_attributes = {{"units", "km"}};
  const auto fields = Read(file);
  ASSERT_TRUE(fields.ok()) << fields.status();
  EXPECT_NEAR((*fields)->grid.spacing_m.z, 50.0, 1e-9);
  file.bounds_attributes = {{"units", "m"}};
  ExpectError(file, "z_bounds has units 'm'");
}

TEST_F(CfReader, TheGroundIsInItsUnits) {
  SyntheticCf file = Small();
  file.variables.push_back(
      {"orog",
       {"y", "x"},
       {{"standard_name", "surface_altitude"}, {"units", "km"}},
       [](const Index& at) { return 0.01 * static_cast<double>(at.at("x")); }});
  auto fields = Read(file);
  ASSERT_TRUE(fields.ok()) << fields.status();
  EXPECT_FLOAT_EQ((*fields)->terrain_height_m[3], 30.0F);
  file.variables.back().attributes["units"] = "ft";
  fields = Read(file);
  ASSERT_TRUE(fields.ok()) << fields.status();
  EXPECT_FLOAT_EQ((*fields)->terrain_height_m[3], 0.03F * 0.3048F);
  file.variables.back().attributes["units"] = "kg";
  const CapturedLog log;
  fields = Read(file);
  ASSERT_TRUE(fields.ok()) << fields.status();
  EXPECT_EQ((*fields)->terrain_height_m[3], 0.0F);
  EXPECT_THAT(log.Text(), HasSubstr("orog (units 'kg') is not read"));
  EXPECT_THAT(info_.assumptions, Contains(HasSubstr("the terrain orog")));
}

TEST_F(CfReader, DegreesHaveAPlaceOnEarth) {
  SyntheticCf file = Small();
  file.coordinates[0] = {"lon", {9.98, 9.99, 10.0, 10.01}, {{"units", "degrees_east"}}, {}};
  file.coordinates[1] = {"lat", {59.99, 60.0, 60.01}, {{"units", "degrees_north"}}, {}};
  file.variables[0].dimensions = {"z", "lat", "lon"};
  file.variables[0].value = [](Index at) { return Value(at["lon"], at["lat"], at["z"]); };
  const auto fields = Read(file);
  ASSERT_TRUE(fields.ok()) << fields.status();
  EXPECT_NEAR((*fields)->grid.spacing_m.y, 1111.9, 0.1);
  EXPECT_NEAR((*fields)->grid.spacing_m.x, 0.5 * 1111.9, 0.1);
  EXPECT_NEAR(info_.latitude_deg.value(), 60.0, 1e-9);
  EXPECT_NEAR(info_.longitude_deg.value(), 9.995, 1e-9);
}

TEST_F(CfReader, MissingAndNegativeCellsAreEmptyAndCounted) {
  SyntheticCf file = Small();
  file.variables[0].value = [](Index at) {
    if (at["x"] == 0) return std::nan("");
    if (at["x"] == 1) return -999.0;
    return at["x"] == 2 ? -1e-9 : 0.01;
  };
  const auto fields = Read(file);
  ASSERT_TRUE(fields.ok()) << fields.status();
  const volume::HydrometeorField& field = (*fields)->fields[0];
  EXPECT_EQ(field.statistics.missing_cells, 12);
  EXPECT_EQ(field.statistics.negative_cells, 6);
  EXPECT_EQ((*fields)->condensate, (volume::CellBox{{3, 0, 0}, {4, 3, 2}}));
}

TEST_F(CfReader, RefusesAFieldWithoutAnyValue) {
  SyntheticCf file = Small();
  file.variables[0].value = [](Index) { return std::nan(""); };
  const auto fields = Read(file);
  ASSERT_FALSE(fields.ok());
  EXPECT_THAT(std::string(fields.status().message()),
              HasSubstr("holds nothing but missing values"));
}

TEST_F(CfReader, SaysWhatAFileLacks) {
  SyntheticCf file = Small();
  file.variables[0].name = "brightness";
  ExpectError(file, "neither WRF");
  file = Small();
  file.coordinates[0].written = false;
  ExpectError(file, "no coordinate variable x");
  file = Small();
  file.coordinates[0].values[2] += 30.0;
  ExpectError(file, "not evenly spaced");
  file = Small();
  file.coordinates[1].values[2] = file.coordinates[1].values[0];
  ExpectError(file, "neither rises nor falls");
  file = Small();
  file.coordinates[2].attributes["units"] = "s";
  ExpectError(file, "heights in m or km");
  file = Small();
  file.variables[0].attributes["units"] = "dBZ";
  ExpectError(file, "'m-1' is needed");
  ExpectError(Water("qc", {{"units", "kg kg-1"}}, 1e-3), "lacks the air's density");
  ExpectError(Water("qc", {}, 1e-3), "has no units");
  ExpectError(Water("lwc", {{"units", "kg m-3"}}, 0.8), "more than air can hold");
  file = Small();
  file.coordinates.push_back({"scenario", {1.0, 2.0}, {}, {}});
  file.variables[0].dimensions = {"scenario", "z", "y", "x"};
  ExpectError(file, "scenario");
  file = Small();
  file.coordinates[2].name = "q";
  file.variables[0].dimensions[0] = "q";
  file.variables[0].value = [](const Index&) { return 0.0; };
  ExpectError(file, "q");
}

TEST_F(CfReader, AmountsInUnknownUnitsAreRefused) {
  for (const std::string units :
       {"kg", "g", "kg m-2", "ppm", "mol m-3", "kg kg-2", "degrees", "(not text)", "%"}) {
    ExpectError(Water("lwc", {{"units", units}}, 1e-3), "lwc has units '" + units + "'");
  }
  for (const std::string units : {"kg m-3", "s-1", "m"}) {
    SyntheticCf file = Small();
    file.variables[0].attributes["units"] = units;
    ExpectError(file, "extinction has units '" + units + "'");
  }
  SyntheticCf file = Water("qc", {{"units", "g/kg"}}, 0.8);
  for (const auto& [name, units] : {std::pair<std::string, std::string>{"prs", "m"},
                                    {"temp", "kg"},
                                    {"qv", "ppm"},
                                    {"rho", "mol m-3"}}) {
    file.variables.resize(1);
    file.variables.push_back(UniformField(name, units, 1.0));
    ExpectError(file, name + " has units '" + units + "'");
  }
}

// Units that are a number carry no meaning, but do not count as absent either.
TEST_F(CfReader, UnitsThatAreNoTextAreRefused) {
  SyntheticCf file = Small();
  file.number_attributes["extinction"]["units"] = 1.0;
  file.variables[0].attributes.clear();
  ExpectError(file, "extinction has units '(not text)'");
  file = Small();
  file.number_attributes["x"]["units"] = 1.0;
  file.coordinates[0].attributes.clear();
  ExpectError(file, "the coordinate x has units '(not text)'");
}

TEST_F(CfReader, AirWithoutUnitsIsTakenToBeInThoseOfTheSi) {
  SyntheticCf file = Water("qc", {{"units", "g/kg"}}, 0.8);
  file.variables.push_back(UniformField("rho", "", 0.9));
  const CapturedLog log;
  const auto fields = Read(file);
  ASSERT_TRUE(fields.ok()) << fields.status();
  EXPECT_NEAR((*fields)->fields[0].concentration_kg_per_m3[3], 0.8e-3 * 0.9, 1e-9);
  EXPECT_THAT(log.Text(), HasSubstr("rho has no units"));
}

// Returns cloud water below ice, and wind that grows with height, in two layers of 50 m.
SyntheticCf Windy() {
  SyntheticCf file = Water("lwc", {{"units", "kg m-3"}}, 0.0);
  file.variables[0].value = [](const Index& at) { return at.at("z") == 0 ? 1e-3 : 0.0; };
  CfContent ice = file.variables[0];
  ice.name = "iwc";
  ice.value = [](const Index& at) { return at.at("z") == 1 ? 1e-4 : 0.0; };
  file.variables.push_back(ice);
  CfContent eastward = UniformField("u", "m s-1", 0.0);
  eastward.value = [](const Index& at) { return at.at("z") == 0 ? 4.0 : 10.0; };
  file.variables.push_back(eastward);
  file.variables.push_back(UniformField("V_north", "m/s", -3.0));
  file.variables.back().attributes["standard_name"] = "northward_wind";
  file.variables.push_back(UniformField("winterp", "m s**-1", 2.0));
  return file;
}

TEST_F(CfReader, TurbulenceIsThatOfTheWindsDeformation) {
  const auto fields = Read(Windy());
  ASSERT_TRUE(fields.ok()) << fields.status();
  const volume::AirMotion& motion = (*fields)->motion;
  EXPECT_EQ(motion.source, volume::TurbulenceSource::kDeformation);
  EXPECT_EQ(motion.shear_m_per_s, glm::dvec2(6.0, 0.0));
  EXPECT_EQ(motion.steering_m_per_s, glm::dvec2(7.0, -3.0));
  ASSERT_THAT(motion.ascent, SizeIs((*fields)->grid.CellCount()));
  EXPECT_EQ(motion.ascent[7], 8);  // in units of 0.25 m/s
  // The shear is 6 m/s over 50 m, in cells of 100 x 200 x 50 m.
  const double root = 0.4 * std::cbrt(100.0 * 200.0 * 50.0) * 6.0 / 50.0;
  ASSERT_THAT(motion.turbulence, SizeIs((*fields)->grid.CellCount()));
  EXPECT_NEAR(motion.turbulence[7], 255.0 * root * root / (root * root + 0.25), 1.0);
}

TEST_F(CfReader, TurbulenceIsTheFilesOwnWhereItHasSome) {
  SyntheticCf file = Windy();
  file.variables.push_back(UniformField("tke", "m2 s-2", 0.25));
  auto fields = Read(file);
  ASSERT_TRUE(fields.ok()) << fields.status();
  EXPECT_EQ((*fields)->motion.source, volume::TurbulenceSource::kEnergy);
  EXPECT_EQ((*fields)->motion.variable, "tke");
  EXPECT_EQ((*fields)->motion.turbulence[7], 128);
  EXPECT_EQ((*fields)->motion.shear_m_per_s, glm::dvec2(6.0, 0.0));
  // If one component of the wind is missing, the wind is not used, but the turbulent energy is.
  file.variables.erase(file.variables.begin() + 4);
  fields = Read(file);
  ASSERT_TRUE(fields.ok()) << fields.status();
  EXPECT_EQ((*fields)->motion.source, volume::TurbulenceSource::kEnergy);
  EXPECT_TRUE((*fields)->motion.ascent.empty());
}

TEST_F(CfReader, WindThatDoesNotFitIsLeftOut) {
  // The cases are pressure velocity, wind on a separate grid (as in CM1), and missing values.
  SyntheticCf file = Windy();
  file.variables[4].attributes["units"] = "Pa s-1";
  const CapturedLog log;
  auto fields = Read(file);
  ASSERT_TRUE(fields.ok()) << fields.status();
  EXPECT_THAT(log.Text(), HasSubstr("winterp has units 'Pa s-1' where m s-1 is needed"));
  EXPECT_EQ((*fields)->motion.source, volume::TurbulenceSource::kGradient);
  EXPECT_TRUE((*fields)->motion.turbulence.empty());
  file = Windy();
  file.coordinates.push_back(
      {"xf", {-250.0, -150.0, -50.0, 50.0, 150.0, 250.0}, {{"units", "m"}}, {}});
  file.variables[2].dimensions = {"z", "y", "xf"};
  fields = Read(file);
  ASSERT_TRUE(fields.ok()) << fields.status();
  EXPECT_EQ((*fields)->motion.source, volume::TurbulenceSource::kGradient);
  EXPECT_THAT(log.Text(), HasSubstr("u has a dimension xf"));
  file = Windy();
  file.variables.push_back(UniformField("tke", "kg", 0.25));
  fields = Read(file);
  ASSERT_TRUE(fields.ok()) << fields.status();
  EXPECT_EQ((*fields)->motion.source, volume::TurbulenceSource::kDeformation);
  EXPECT_THAT(log.Text(), HasSubstr("tke has units 'kg' where m2 s-2 is needed"));
  file = Windy();
  file.variables[2].value = [](const Index& at) {
    return at.at("x") == 0 ? std::nan("") : 5.0 + static_cast<double>(at.at("z"));
  };
  fields = Read(file);
  ASSERT_TRUE(fields.ok()) << fields.status();
  EXPECT_EQ((*fields)->motion.turbulence[0], 0);
  EXPECT_EQ((*fields)->motion.shear_m_per_s, glm::dvec2(1.0, 0.0));
}

// "Mm-1" is used for aerosols.
TEST(CfNames, UnitsAreReadInTheirSpellings) {
  for (const auto& [from, to, scale, offset] :
       {std::tuple<const char*, const char*, double, double>{"kg m**-3", "kg m-3", 1.0, 0.0},
        {"g.m^(-3)", "kg m-3", 1e-3, 0.0},
        {"mg/m^3", "kg m-3", 1e-6, 0.0},
        {"Mg m-3", "kg m-3", 1e3, 0.0},
        {"g kg^-1", "1", 1e-3, 0.0},
        {"KG/KG", "1", 1.0, 0.0},
        {"Mm-1", "m-1", 1e-6, 0.0},
        {"/m", "m-1", 1.0, 0.0},
        {"mb", "Pa", 100.0, 0.0},
        {"atm", "Pa", 101325.0, 0.0},
        {"degC", "K", 1.0, 273.15},
        {"radian", "degree", 57.29577951308232, 0.0},
        {"g/Kg", "1", 1e-3, 0.0},
        {"Kg/Kg", "1", 1.0, 0.0},
        {"-", "1", 1.0, 0.0},
        {"Km", "m", 1000.0, 0.0},
        {"gpkm", "m", 1000.0, 0.0},
        {"grams/kg", "1", 1e-3, 0.0},
        {"degrees Celsius", "K", 1.0, 273.15},
        {"degrees north", "degree_north", 1.0, 0.0},
        {"degrees east", "degree_east", 1.0, 0.0},
        {"weeks", "s", 604800.0, 0.0}}) {
    const std::optional<UnitConversion> conversion = ConversionOf(from, to);
    ASSERT_TRUE(conversion.has_value()) << from;
    EXPECT_NEAR(conversion->scale, scale, 1e-9 * scale) << from;
    EXPECT_NEAR(conversion->offset, offset, 1e-9) << from;
  }
  for (const auto& [from, to] : {std::pair{"", "m"},
                                 {"degrees", "1"},
                                 {"1", "degree"},
                                 {"hPa", "m"},
                                 {"s", "Hz"},
                                 {"(not text)", "m"},
                                 {"gr/kg", "1"},
                                 {"gr m-3", "kg m-3"},
                                 {"grains/kg", "1"},
                                 {"Gr kg-1", "1"},
                                 {"kg kg-2", "1"}}) {
    EXPECT_FALSE(ConversionOf(from, to).has_value()) << from;
  }
  EXPECT_EQ(DegreesIn("degrees_E", CfDirection::kX), 1.0);
  EXPECT_EQ(DegreesIn("degree_north", CfDirection::kY), 1.0);
  EXPECT_EQ(DegreesIn("degrees", CfDirection::kY), 1.0);
  EXPECT_FALSE(DegreesIn("degrees_E", CfDirection::kY).has_value());
  EXPECT_FALSE(DegreesIn("degrees_west", CfDirection::kX).has_value());
  EXPECT_FALSE(DegreesIn("degrees", CfDirection::kZ).has_value());
  EXPECT_EQ(MetresIn("km"), 1000.0);
  EXPECT_FALSE(MetresIn("hPa").has_value());
}

}  // namespace
}  // namespace thunderhead::storm_files

// Tests of physically impossible values in CF and WRF files: factors of units and packing, air
// temperatures, and places on Earth. Each is refused by name, or its cells are missing.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <netcdf.h>

#include <array>
#include <cmath>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "tests/unit/storm_files/cf_file_test.h"
#include "tests/unit/storm_files/wrf_kind_test.h"

namespace thunderhead::storm_files {
namespace {

using ::testing::HasSubstr;
using testing::SyntheticCf;
using testing::SyntheticWrf;

// Returns cloud water of 1e-3 in the lowest of 4 layers of 500 m, on 6 x 4 columns of 1 km.
SyntheticCf WaterIn(const std::string& units = "kg m-3") {
  SyntheticCf file = testing::ExtinctionFile(6, 4, 4, 1000.0, 1000.0, 500.0, {});
  file.variables[0] = {"qc", {"z", "y", "x"}, {{"units", units}}, [](const Index& at) {
                         return at.at("z") == 0 ? 1e-3 : 0.0;
                       }};
  return file;
}

// Returns a mixing ratio with air of 900 hPa and of the temperature that `kelvin` returns.
SyntheticCf InAir(std::function<double(const Index&)> kelvin, const std::string& units = "K") {
  SyntheticCf file = WaterIn("kg kg-1");
  const std::vector<std::string> on = {"z", "y", "x"};
  file.variables.push_back(
      OfOneValue("p", on, {{"units", "Pa"}, {"standard_name", "air_pressure"}}, 90'000.0));
  file.variables.push_back(
      {"ta", on, {{"units", units}, {"standard_name", "air_temperature"}}, std::move(kelvin)});
  return file;
}

// Returns cloud water on longitudes and latitudes 0.01 degrees apart.
SyntheticCf InDegrees(double west_deg, double south_deg) {
  SyntheticCf file = WaterIn();
  const auto axis = [](const std::string& name, std::size_t count, double first_deg,
                       const std::string& units) {
    testing::CfCoordinate coordinate{name, {}, {{"units", units}}, {}};
    for (std::size_t i = 0; i < count; ++i) {
      coordinate.values.push_back(first_deg + 0.01 * static_cast<double>(i));
    }
    return coordinate;
  };
  file.coordinates[0] = axis("lon", 6, west_deg, "degrees_east");
  file.coordinates[1] = axis("lat", 4, south_deg, "degrees_north");
  file.variables[0].dimensions = {"z", "lat", "lon"};
  return file;
}

using ImpossibleCfValues = CfFileTest;
using ImpossibleWrfValues = WrfKindTest;

TEST_F(ImpossibleCfValues, UnitsNeedAFactorAboveZero) {
  for (const char* units :
       {"1e300 kg m-3", "1e-300 kg m-3", "-1 kg m-3", "0 kg m-3", "-1 g kg-1"}) {
    ExpectError(WaterIn(units), std::string("qc has units '") + units + "'");
  }
  ASSERT_TRUE(Read(WaterIn("1e-3 kg m-3")).ok());
}

// The factor itself is possible, but not the values in kg m-3.
TEST_F(ImpossibleCfValues, UnitsMustNotMakeValuesInfinite) {
  SyntheticCf file = WaterIn("1e25 kg m-3");
  file.variables[0].value = [](const Index&) { return 1e20; };
  ExpectError(file, "qc of record 0 has a value that no quantity has, because of its units");
}

TEST_F(ImpossibleCfValues, APackingMustNotMakeAmountsNegative) {
  SyntheticCf file = WaterIn();
  std::map<std::string, double>& packing = file.number_attributes["qc"];
  packing["scale_factor"] = -1.0;
  ExpectError(file, "qc has the scale_factor -1 and no add_offset above 0");
  // Packed numbers may run downwards from an offset. Cells without water are stored as 0.
  packing["add_offset"] = 3e-3;
  auto fields = Read(file);
  ASSERT_TRUE(fields.ok()) << fields.status();
  EXPECT_FLOAT_EQ((*fields)->fields[0].statistics.maximum, 3e-3F);
  packing["scale_factor"] = 0.5;
  packing.erase("add_offset");
  fields = Read(file);
  ASSERT_TRUE(fields.ok()) << fields.status();
  EXPECT_FLOAT_EQ((*fields)->fields[0].statistics.maximum, 0.5e-3F);
}

// Cells with an impossible temperature are missing. The others keep their density. Here the missing
// cells have 3 % of the water, so the file is not refused.
TEST_F(ImpossibleCfValues, AirHasFrom100To400Kelvin) {
  SyntheticCf file = InAir([](const Index& at) {
    constexpr std::array kKelvin = {280.0, 2000.0, 401.0, 99.0, 400.0, 100.0};
    return kKelvin[at.at("x")];
  });
  file.variables[0].value = [](const Index& at) {
    const bool impossible = at.at("x") > 0 && at.at("x") < 4;
    return at.at("z") > 0 ? 0.0 : impossible ? 3e-5 : 1e-3;
  };
  const auto fields = Read(file);
  ASSERT_TRUE(fields.ok()) << fields.status();
  const volume::HydrometeorField& field = (*fields)->fields[0];
  EXPECT_EQ(field.statistics.missing_cells, 3 * 4 * 4);
  constexpr double kGas = 287.0;
  const volume::RegularGrid& grid = (*fields)->grid;
  const auto at = [&](int x) { return field.concentration_kg_per_m3[grid.Offset(x, 0, 0)]; };
  EXPECT_NEAR(at(0), 1e-3 * 90'000.0 / (kGas * 280.0), 1e-6);
  for (const int x : {1, 2, 3}) EXPECT_EQ(at(x), 0.0F) << x;
  EXPECT_NEAR(at(4), 1e-3 * 90'000.0 / (kGas * 400.0), 1e-6);
  EXPECT_NEAR(at(5), 1e-3 * 90'000.0 / (kGas * 100.0), 1e-5);
}

// Lost water is only refused if it is more than a twentieth of a field. Cells without water may
// have no air, as under the ground.
TEST_F(ImpossibleCfValues, AirThatWouldLoseWaterIsRefused) {
  const auto kelvin = [](const Index& at) { return at.at("x") == 1 ? std::nan("") : 280.0; };
  ExpectError(InAir(kelvin),
              "17 % of qc of record 0 is in cells whose air is missing or "
              "impossible, and would be lost; check the values and units of p, ta");
  SyntheticCf file = InAir(kelvin);
  file.variables[0].value = [](const Index& at) {
    return at.at("z") > 0 || at.at("x") == 1 ? 0.0 : 1e-3;
  };
  const auto fields = Read(file);
  ASSERT_TRUE(fields.ok()) << fields.status();
  EXPECT_EQ((*fields)->fields[0].statistics.missing_cells, 4 * 4);
}

// Values in g/kg that are labelled kg/kg would make the air, and so its water, 10 times too thin.
TEST_F(ImpossibleCfValues, AirHasLittleVapour) {
  for (const char* name : {"humidity_mixing_ratio", "specific_humidity"}) {
    const auto with_vapour = [&](double kg_per_kg, const std::string& units) {
      SyntheticCf file = InAir([](const Index&) { return 280.0; });
      file.variables.push_back(OfOneValue("hum", {"z", "y", "x"},
                                          {{"units", units}, {"standard_name", name}}, kg_per_kg));
      return file;
    };
    ExpectError(with_vapour(10.0, "kg kg-1"),
                "hum of record 0 gives 10 kg of vapour per kg of dry air, more than air can hold");
    ExpectError(with_vapour(0.15, "kg kg-1"), "more than air can hold");
    for (const auto& [value, units] : {std::pair{10.0, "g kg-1"}, std::pair{0.01, "kg kg-1"}}) {
      const auto fields = Read(with_vapour(value, units));
      ASSERT_TRUE(fields.ok()) << fields.status();
      EXPECT_NEAR((*fields)->fields[0].concentration_kg_per_m3[0],
                  1e-3 * 90'000.0 / (287.0 * 280.0 * 1.01608), 3e-6)
          << name;
    }
  }
}

// A file may have no humidity where it has no air.
TEST_F(ImpossibleCfValues, VapourWithoutAirDoesNotCount) {
  SyntheticCf file = InAir([](const Index& at) { return at.at("x") == 1 ? 9999.0 : 280.0; });
  file.variables[0].value = [](const Index& at) { return at.at("x") == 1 ? 0.0 : 1e-3; };
  file.variables.push_back({"hum",
                            {"z", "y", "x"},
                            {{"units", "kg kg-1"}, {"standard_name", "humidity_mixing_ratio"}},
                            [](const Index& at) { return at.at("x") == 1 ? 9999.0 : 0.01; }});
  const auto fields = Read(file);
  ASSERT_TRUE(fields.ok()) << fields.status();
  EXPECT_EQ((*fields)->fields[0].statistics.missing_cells, 4 * 4);
}

TEST_F(ImpossibleCfValues, AFileOfImpossibleTemperaturesIsRefused) {
  ExpectError(InAir([](const Index&) { return 2000.0; }), "of record 0 give no usable air density");
  ExpectError(InAir([](const Index&) { return 280.0; }, "-1 K"), "ta has units '-1 K'");
}

TEST_F(ImpossibleCfValues, LatitudesEndAtThePoles) {
  ExpectError(InDegrees(10.0, 89.98), "89.98 to 90.01 degrees north");
  ExpectError(InDegrees(10.0, -90.02), "-90.02 to -89.99 degrees north");
  ExpectError(InDegrees(10.0, 200.0), "200 to 200.03 degrees north");
  // The last row is at the pole, or beyond it by rounding.
  for (const double rounding_deg : {0.0, 0.0005}) {
    const auto fields = Read(InDegrees(10.0, 89.97 + rounding_deg));
    EXPECT_TRUE(fields.ok()) << fields.status();
  }
}

TEST_F(ImpossibleCfValues, LongitudesHaveTheirLimit) {
  ExpectError(InDegrees(360e9, 50.0), "degrees east");
  const auto fields = Read(InDegrees(3600.0, 50.0));
  ASSERT_TRUE(fields.ok()) << fields.status();
  EXPECT_NEAR(info_.longitude_deg.value(), 0.025, 1e-6);
}

// The places of all columns may be rounded, too.
TEST_F(ImpossibleCfValues, PlacesOfColumnsEndAtThePoles) {
  const auto with_places = [](double south_deg, double west_deg) {
    SyntheticCf file = WaterIn();
    for (testing::CfCoordinate& each : file.coordinates) each.written = each.name == "z";
    file.variables.push_back({"lon", {"y", "x"}, {{"units", "degrees_east"}}, [=](const Index& at) {
                                return west_deg + 10.0 * static_cast<double>(at.at("x"));
                              }});
    file.variables.push_back(
        {"lat", {"y", "x"}, {{"units", "degrees_north"}}, [=](const Index& at) {
           return south_deg + 0.01 * static_cast<double>(at.at("y"));
         }});
    return file;
  };
  EXPECT_TRUE(Read(with_places(89.9705, 10.0)).ok());
  ExpectError(with_places(89.98, 10.0), "lat and lon have missing or impossible values");
  ExpectError(with_places(50.0, -999.0), "lat and lon have missing or impossible values");
}

TEST_F(ImpossibleWrfValues, AirHasFrom100To400Kelvin) {
  SyntheticWrf file = Cloud();
  file.potential_temperature_at_K = [](const testing::WrfCell& cell) {
    return cell.level == 1 && cell.x == 0 ? 5000.0 : 310.0;
  };
  const auto fields = Read(file);
  ASSERT_TRUE(fields.ok()) << fields.status();
  EXPECT_EQ(fields->fields[0].statistics.missing_cells, 3);
  EXPECT_NEAR(ColumnPath(*fields, 0, 0, 0), 7 * 500.0 * 1e-3 * kDryDensity_kg_per_m3, 1e-3);
  file.potential_temperature_at_K = [](const testing::WrfCell&) { return 5000.0; };
  EXPECT_THAT(Message(file), HasSubstr("give no usable air density"));
}

// A T that is the whole potential temperature becomes 300 K too high. At 800 hPa it is then too hot
// for air, but not above 400 hPa.
TEST_F(ImpossibleWrfValues, ATemperatureWith300KTooManyIsRefused) {
  SyntheticWrf file = Cloud();
  file.potential_temperature_K = 610.0;
  file.stored_values.clear();
  for (int x = 0; x < file.nx; ++x) {
    for (int y = 0; y < file.ny; ++y)
      file.stored_values.push_back({"T", {x, y, 7, 0}, 310.0 - 300.0});
  }
  EXPECT_THAT(
      Message(file),
      HasSubstr("88 % of QCLOUD of record 0 is in cells whose air is missing or impossible, "
                "and would be lost; check the values and units of P + PB (Pa) and T (K, "
                "the potential temperature minus 300 K) and QVAPOR"));
}

TEST_F(ImpossibleWrfValues, AirHasLittleVapour) {
  SyntheticWrf file = Cloud();
  file.vapour_kg_per_kg = 16.0;
  EXPECT_THAT(Message(file),
              HasSubstr("QVAPOR of record 0 gives 16 kg of vapour per kg of dry air"));
  // The potential temperature of moist air depends on the vapour.
  file.numbers["USE_THETA_M"] = 1.0;
  file.texts["T"]["description"] = "perturbation moist potential temperature";
  EXPECT_THAT(Message(file),
              HasSubstr("QVAPOR of record 0 gives 16 kg of vapour per kg of dry air"));
}

TEST_F(ImpossibleWrfValues, APackingMustNotMakeAmountsNegative) {
  const auto described = [this](double factor) {
    testing::WriteWrf(Cloud(), path_);
    int file = -1;
    int variable = -1;
    EXPECT_EQ(nc_open(path_.c_str(), NC_WRITE, &file), NC_NOERR);
    EXPECT_EQ(nc_inq_varid(file, "QCLOUD", &variable), NC_NOERR);
    EXPECT_EQ(nc_put_att_double(file, variable, "scale_factor", NC_DOUBLE, 1, &factor), NC_NOERR);
    EXPECT_EQ(nc_close(file), NC_NOERR);
    return StormFormats::BuiltIn().Describe(path_);
  };
  EXPECT_THAT(std::string(described(-1.0).status().message()),
              HasSubstr("QCLOUD has the scale_factor -1 and no add_offset above 0"));
  const auto constant = described(0.0);
  ASSERT_TRUE(constant.ok()) << constant.status();
  EXPECT_THAT(Assumptions(*constant),
              HasSubstr("QCLOUD is 0 everywhere, because its scale_factor is 0."));
}

TEST_F(ImpossibleWrfValues, LatitudesEndAtThePoles) {
  SyntheticWrf file = Cloud();
  file.latitude_deg = 95.0;
  EXPECT_THAT(Message(file), HasSubstr("XLAT and XLONG place the domain at 95.0"));
  // Without coordinates, attributes give the place.
  file = Cloud();
  file.omitted = {"XLAT", "XLONG"};
  file.numbers = {{"CEN_LAT", -91.0},
                  {"CEN_LON", -100.25},
                  {"WEST-EAST_GRID_DIMENSION", 5.0},
                  {"SOUTH-NORTH_GRID_DIMENSION", 4.0}};
  EXPECT_THAT(Message(file), HasSubstr("CEN_LAT and CEN_LON place the domain at -91 degrees"));
}

}  // namespace
}  // namespace thunderhead::storm_files

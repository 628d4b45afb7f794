// Tests of files on unstructured grids in the layouts of ICON and MPAS: what is read is the cloud
// that was written, and what is missing is named.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <netcdf.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <string>

#include "glm/geometric.hpp"
#include "glm/trigonometric.hpp"
#include "tests/support/earth_formulas.h"
#include "tests/unit/storm_files/cell_meshes.h"
#include "tests/unit/storm_files/cf_file_test.h"

// Tests are compiled together, and other tests have the same names.
namespace thunderhead::storm_files::unstructured_files_test {
namespace {

using testing::CellMesh;
using testing::CfContent;
using ::testing::Contains;
using ::testing::HasSubstr;
using testing::SyntheticCf;
using volume::EarthPlace;
using Attributes = std::map<std::string, std::string>;

constexpr std::size_t kLayers = 10;
constexpr double kDepth_m = 500.0;
constexpr EarthPlace kMiddle{48.0, 11.0};
const glm::dvec2 kBlob_m(15e3, -8e3);  // centre of the cloud, from the middle of the domain
constexpr double kWidth_m = 9e3;
constexpr double kPeak = 2e-3;  // kg per kg
constexpr double kVapour = 0.015;

// The ground rises to the east.
double Ground_m(const glm::dvec2& at_m) { return 300.0 + 0.005 * at_m.x; }

// Cloud water in the layers 3 to 5 above the ground, rain in the two lowest.
double Cloud(const glm::dvec2& at_m, std::size_t layer) {
  const double distance = glm::distance(at_m, kBlob_m) / kWidth_m;
  return layer >= 3 && layer <= 5 ? kPeak * std::exp(-distance * distance) : 0.0;
}
double Rain(const glm::dvec2& at_m, std::size_t layer) {
  return layer < 2 ? 0.25 * Cloud(at_m, 4) : 0.0;
}
double Density(std::size_t layer) { return 1.2 - 0.05 * static_cast<double>(layer); }

// Returns the mass of a hydrometeor whose amounts are per kg of air of this density.
double Mass_kg(const CellMesh& mesh,
               const std::function<double(const glm::dvec2&, std::size_t)>& amount) {
  double mass_kg = 0.0;
  for (const glm::dvec2& at_m : mesh.centres_m) {
    for (std::size_t layer = 0; layer < kLayers; ++layer) {
      mass_kg += amount(at_m, layer) * Density(layer) * kDepth_m * mesh.area_m2;
    }
  }
  return mass_kg;
}

// The names and the order of a file's dimensions.
struct Layout {
  std::string cells;
  std::string layers;
  std::string faces;
  std::string time;
  bool downwards = false;
  bool level_fastest = false;
};

class UnstructuredFiles : public CfFileTest {
 protected:
  static std::vector<std::string> On(const Layout& layout, const std::string& z) {
    if (layout.level_fastest) return {layout.time, layout.cells, z};
    return {layout.time, z, layout.cells};
  }

  static SyntheticCf Empty(const Layout& layout, const CellMesh& mesh) {
    SyntheticCf file;
    file.coordinates = {
        {layout.time, {0.0}, {{"units", "minutes since 2024-06-01 12:00:00"}}, {}},
        {layout.cells, std::vector<double>(mesh.centres_m.size()), {}, {}, false},
        {layout.layers, testing::Middles(kLayers, 0.5, 1.0), {{"axis", "Z"}}, {}},
        {layout.faces, testing::Middles(kLayers + 1, 0.5, 1.0), {{"axis", "Z"}}, {}}};
    return file;
  }

  // Returns a variable in layers, from its value at a position and a layer above the ground.
  static CfContent InLayers(const Layout& layout, const CellMesh& mesh, const std::string& name,
                            const Attributes& attributes,
                            std::function<double(const glm::dvec2&, std::size_t)> value) {
    return {name, On(layout, layout.layers), attributes,
            [layout, &mesh, value = std::move(value)](const Index& at) {
              const std::size_t level = at.at(layout.layers);
              return value(mesh.centres_m[at.at(layout.cells)],
                           layout.downwards ? kLayers - 1 - level : level);
            }};
  }

  static CfContent Faces(const Layout& layout, const CellMesh& mesh, const std::string& name,
                         const Attributes& attributes) {
    std::vector<std::string> on = On(layout, layout.faces);
    on.erase(on.begin());
    return {name, on, attributes, [layout, &mesh](const Index& at) {
              const std::size_t face = at.at(layout.faces);
              const glm::dvec2& at_m = mesh.centres_m[at.at(layout.cells)];
              return Ground_m(at_m) +
                     kDepth_m * static_cast<double>(layout.downwards ? kLayers - face : face);
            }};
  }

  static CfContent OnCells(const Layout& layout, const CellMesh& mesh, const std::string& name,
                           const Attributes& attributes,
                           std::function<double(const glm::dvec2&)> value) {
    return {name,
            {layout.cells},
            attributes,
            [layout, &mesh, value = std::move(value)](const Index& at) {
              return value(mesh.centres_m[at.at(layout.cells)]);
            }};
  }

  // Returns a file in ICON's layout: levels downwards, radians, and specific contents.
  static SyntheticCf Icon(const CellMesh& mesh) {
    const Layout layout{"ncells", "height", "height_2", "time", true, false};
    SyntheticCf file = Empty(layout, mesh);
    file.attributes = {{"uuidOfHGrid", "a27b8de6-18c4-11e4-820a-b5b098c6a5c0"},
                       {"title", "ICON simulation"}};
    for (std::size_t i : {2, 3}) {
      file.coordinates[i].attributes["units"] = "1";
      file.coordinates[i].attributes["long_name"] = "generalized_height";
    }
    const Attributes grid = {{"CDI_grid_type", "unstructured"}, {"coordinates", "clat clon"}};
    const auto with = [&](Attributes attributes) {
      attributes.insert(grid.begin(), grid.end());
      return attributes;
    };
    file.variables = {
        OnCells(layout, mesh, "clon", {{"standard_name", "longitude"}, {"units", "radian"}},
                [](const glm::dvec2& at_m) {
                  return glm::radians(testing::FromStereographic(at_m, kMiddle).longitude_deg);
                }),
        OnCells(layout, mesh, "clat", {{"standard_name", "latitude"}, {"units", "radian"}},
                [](const glm::dvec2& at_m) {
                  return glm::radians(testing::FromStereographic(at_m, kMiddle).latitude_deg);
                }),
        Faces(layout, mesh, "z_ifc",
              with({{"standard_name", "geometric_height_at_half_level_center"}, {"units", "m"}})),
        InLayers(layout, mesh, "qc",
                 with({{"standard_name", "qc"},
                       {"long_name", "specific_cloud_water_content"},
                       {"units", "kg kg-1"}}),
                 Cloud),
        InLayers(layout, mesh, "qr",
                 with({{"standard_name", "specific_rain_content"}, {"units", "kg kg-1"}}), Rain),
        InLayers(layout, mesh, "qv", with({{"standard_name", "qv"}, {"units", "kg kg-1"}}),
                 [](const glm::dvec2&, std::size_t) { return kVapour; }),
        InLayers(layout, mesh, "rho", with({{"standard_name", "air_density"}, {"units", "kg m-3"}}),
                 [](const glm::dvec2&, std::size_t layer) { return Density(layer); })};
    return file;
  }

  // Returns a file in MPAS' layout: levels upwards and fastest, units with braces, and mixing
  // ratios per mass of dry air, whose density is `rho`.
  static SyntheticCf Mpas(const CellMesh& mesh) {
    const Layout layout{"nCells", "nVertLevels", "nVertLevelsP1", "Time", false, true};
    SyntheticCf file = Empty(layout, mesh);
    file.attributes = {{"on_a_sphere", "YES"}, {"core_name", "atmosphere"}};
    file.coordinates[0].values = {0.0, 1.0};
    for (testing::CfCoordinate& coordinate : file.coordinates) coordinate.written = false;
    const Attributes ratio = {{"units", "kg kg^{-1}"}};
    file.variables = {
        OnCells(layout, mesh, "lonCell", {{"units", "rad"}},
                [](const glm::dvec2& at_m) {
                  const double longitude = testing::FromStereographic(at_m, kMiddle).longitude_deg;
                  return glm::radians(longitude + 360.0);
                }),
        OnCells(layout, mesh, "latCell", {{"units", "rad"}},
                [](const glm::dvec2& at_m) {
                  return glm::radians(testing::FromStereographic(at_m, kMiddle).latitude_deg);
                }),
        Faces(layout, mesh, "zgrid", {{"units", "m"}}),
        InLayers(layout, mesh, "qc", ratio, Cloud),
        InLayers(layout, mesh, "qr", ratio, Rain),
        InLayers(layout, mesh, "qv", ratio, [](const glm::dvec2&, std::size_t) { return kVapour; }),
        InLayers(layout, mesh, "rho", {{"units", "kg m^{-3}"}},
                 [](const glm::dvec2&, std::size_t layer) { return Density(layer); }),
        InLayers(layout, mesh, "uReconstructZonal", {{"units", "m s^{-1}"}},
                 [](const glm::dvec2&, std::size_t) { return 7.0; }),
        InLayers(layout, mesh, "uReconstructMeridional", {{"units", "m s^{-1}"}},
                 [](const glm::dvec2&, std::size_t) { return -3.0; }),
        InLayers(layout, mesh, "w", {{"units", "m s^{-1}"}},
                 [](const glm::dvec2& at_m, std::size_t layer) {
                   return Cloud(at_m, layer) > 0.5 * kPeak ? 20.0 : 0.0;
                 })};
    return file;
  }

  // Writes the file, and MPAS' times as text if it has two.
  void Write(const SyntheticCf& file) override {
    testing::WriteCf(file, path_);
    if (file.coordinates[0].values.size() < 2) return;
    int id = 0;
    int length = 0;
    int times = 0;
    int on[2] = {0, 0};
    ASSERT_EQ(nc_open(path_.c_str(), NC_WRITE, &id), NC_NOERR);
    ASSERT_EQ(nc_redef(id), NC_NOERR);
    ASSERT_EQ(nc_inq_dimid(id, "Time", &on[0]), NC_NOERR);
    ASSERT_EQ(nc_def_dim(id, "StrLen", 64, &length), NC_NOERR);
    on[1] = length;
    ASSERT_EQ(nc_def_var(id, "xtime", NC_CHAR, 2, on, &times), NC_NOERR);
    ASSERT_EQ(nc_enddef(id), NC_NOERR);
    std::string text = "2024-06-01_12:00:00";
    text.resize(64, ' ');
    text += "2024-06-01_12:10:00";
    text.resize(128, ' ');
    ASSERT_EQ(nc_put_var_text(id, times, text.c_str()), NC_NOERR);
    ASSERT_EQ(nc_close(id), NC_NOERR);
  }

  // Checks mass, water path, place and height of the cloud.
  void ExpectCloud(const volume::HydrometeorFields& fields, const CellMesh& mesh) {
    ASSERT_EQ(fields.fields.size(), 2U);
    const volume::RegularGrid& grid = fields.grid;
    const std::array masses_kg = {Mass_kg(mesh, Cloud), Mass_kg(mesh, Rain)};
    for (const std::size_t i : {0U, 1U}) {
      double sum = 0.0;
      for (const float each : fields.fields[i].concentration_kg_per_m3) sum += each;
      const double mass_kg = sum * grid.spacing_m.x * grid.spacing_m.y * grid.spacing_m.z;
      EXPECT_NEAR(mass_kg / masses_kg[i], 1.0, 0.005) << fields.fields[i].variable;
      RecordProperty("relative_error_of_mass_" + fields.fields[i].variable,
                     std::to_string(mass_kg / masses_kg[i] - 1.0));
    }
    const std::vector<float>& cloud = fields.fields[0].concentration_kg_per_m3;
    double largest_path = 0.0;
    glm::dvec2 strongest(0.0);
    double height_sum = 0.0;
    double sum = 0.0;
    for (int y = 0; y < grid.cells.y; ++y) {
      for (int x = 0; x < grid.cells.x; ++x) {
        double path = 0.0;
        for (int z = 0; z < grid.cells.z; ++z) {
          const double each = cloud[grid.Offset(x, y, z)] * grid.spacing_m.z;
          path += each;
          sum += each;
          height_sum += each * (grid.low_corner_m.z + (z + 0.5) * grid.spacing_m.z);
        }
        if (path <= largest_path) continue;
        largest_path = path;
        strongest =
            glm::dvec2(grid.low_corner_m) + (glm::dvec2(x, y) + 0.5) * glm::dvec2(grid.spacing_m);
      }
    }
    const double written_path = kPeak * kDepth_m * (Density(3) + Density(4) + Density(5));
    EXPECT_NEAR(largest_path / written_path, 1.0, 0.02);
    RecordProperty("relative_error_of_largest_path",
                   std::to_string(largest_path / written_path - 1.0));
    EXPECT_NEAR(height_sum / sum, Ground_m(kBlob_m) + 4.5 * kDepth_m, 20.0);
    if (info_.projection.empty()) {
      EXPECT_LT(glm::distance(strongest, kBlob_m), 1.2 * mesh.spacing_m);
      return;
    }
    const auto map = storm_store::ProjectionOf(info_, 0);
    ASSERT_TRUE(map.has_value());
    const auto place = map->PlaceOf(strongest);
    ASSERT_TRUE(place.has_value());
    EXPECT_LT(testing::Distance_m(*place, testing::FromStereographic(kBlob_m, kMiddle)),
              mesh.spacing_m);
  }

  const CellMesh triangles_ = testing::Triangles({80e3, 60e3}, 2500.0);
  const CellMesh hexagons_ = testing::Hexagons({80e3, 60e3}, 1500.0);
};

CfContent& Variable(SyntheticCf& file, const std::string& name) {
  return *std::ranges::find(file.variables, name, &CfContent::name);
}

void Remove(SyntheticCf& file, const std::string& name) {
  std::erase_if(file.variables, [&](const CfContent& content) { return content.name == name; });
}

TEST_F(UnstructuredFiles, IconsTrianglesAreRead) {
  const auto fields = Read(Icon(triangles_));
  ASSERT_TRUE(fields.ok()) << fields.status();
  ExpectCloud(**fields, triangles_);
  EXPECT_THAT(info_.assumptions, Contains(HasSubstr("values of the nearest cell")));
  EXPECT_THAT(info_.assumptions, Contains(HasSubstr("kg of the whole air")));
  EXPECT_NEAR(info_.dx_m, triangles_.spacing_m, 0.01 * triangles_.spacing_m);
  EXPECT_EQ(info_.times[0].valid_time, "2024-06-01T12:00:00Z");
}

// Other programs write degrees, other names and no time.
TEST_F(UnstructuredFiles, TheFieldNamesItsCoordinates) {
  SyntheticCf file = Icon(triangles_);
  for (const auto& [from, to] :
       std::map<std::string, std::string>{{"clon", "east"}, {"clat", "north"}}) {
    CfContent& variable = Variable(file, from);
    variable.name = to;
    variable.attributes = {{"units", to == "east" ? "degrees_east" : "degrees_north"}};
    variable.value = [value = variable.value](const Index& at) { return glm::degrees(value(at)); };
  }
  for (CfContent& variable : file.variables) {
    if (variable.dimensions.size() < 3) continue;
    variable.dimensions.erase(variable.dimensions.begin());
    variable.attributes["coordinates"] = "north east";
  }
  const auto fields = Read(file);
  ASSERT_TRUE(fields.ok()) << fields.status();
  ExpectCloud(**fields, triangles_);
}

TEST_F(UnstructuredFiles, CellsCountFromThePrimeMeridianOfTheirMapping) {
  SyntheticCf file = Icon(triangles_);
  ASSERT_TRUE(Read(file).ok());
  const double from_greenwich_deg = info_.longitude_deg.value();
  for (CfContent& variable : file.variables) {
    if (variable.dimensions.size() > 2) variable.attributes["grid_mapping"] = "crs";
  }
  file.variables.push_back(
      OfOneValue("crs", {}, {{"grid_mapping_name", "latitude_longitude"}}, 0.0));
  file.number_attributes["crs"] = {{"longitude_of_prime_meridian", 2.5}};
  ASSERT_TRUE(Read(file).ok());
  EXPECT_NEAR(info_.longitude_deg.value(), from_greenwich_deg + 2.5, 1e-6);
  EXPECT_THAT(info_.assumptions, Contains(HasSubstr("The longitudes clon count from")));
}

// ICON's files often have pressure and temperature, but no density.
TEST_F(UnstructuredFiles, TheDensityFollowsFromPressureAndTemperature) {
  constexpr double kTemperature_K = 280.0;
  SyntheticCf file = Icon(triangles_);
  CfContent temperature = Variable(file, "rho");
  temperature.name = "temp";
  temperature.attributes["standard_name"] = "air_temperature";
  temperature.attributes["units"] = "K";
  temperature.value = [](const Index&) { return kTemperature_K; };
  CfContent& pressure = Variable(file, "rho");
  pressure.name = "pres";
  pressure.attributes["standard_name"] = "air_pressure";
  pressure.attributes["units"] = "Pa";
  pressure.value = [density = pressure.value](const Index& at) {
    constexpr double kGas_J_per_kg_K = 287.0;
    return density(at) * kGas_J_per_kg_K * kTemperature_K * (1.0 + 0.608 * kVapour);
  };
  file.variables.push_back(std::move(temperature));
  const auto fields = Read(file);
  ASSERT_TRUE(fields.ok()) << fields.status();
  ExpectCloud(**fields, triangles_);
}

TEST_F(UnstructuredFiles, MpasHexagonsAreRead) {
  const auto fields = Read(Mpas(hexagons_));
  ASSERT_TRUE(fields.ok()) << fields.status();
  ExpectCloud(**fields, hexagons_);
  EXPECT_THAT(info_.assumptions, Contains(HasSubstr("density is that of dry air")));
  ASSERT_EQ(info_.times.size(), 2U);
  EXPECT_EQ(info_.times[1].valid_time, "2024-06-01T12:10:00Z");
  // Cells that follow one another are no neighbours, so the wind has no deformation.
  const volume::AirMotion& motion = (*fields)->motion;
  EXPECT_NE(motion.source, volume::TurbulenceSource::kDeformation);
  EXPECT_NEAR(motion.steering_m_per_s.x, 7.0, 0.01);
  EXPECT_NEAR(motion.steering_m_per_s.y, -3.0, 0.01);
  EXPECT_FALSE(motion.ascent.empty());
}

TEST_F(UnstructuredFiles, MpasOnAPlaneHasNoPlace) {
  SyntheticCf file = Mpas(hexagons_);
  file.attributes["on_a_sphere"] = "NO";
  ExpectError(file, "no xCell");
  for (const std::size_t axis : {0U, 1U}) {
    CfContent position = Variable(file, "lonCell");
    position.name = axis == 0 ? "xCell" : "yCell";
    position.attributes = {{"units", "m"}};
    position.value = [&, axis](const Index& at) {
      return 1e5 + hexagons_.centres_m[at.at("nCells")][static_cast<int>(axis)];
    };
    file.variables.push_back(std::move(position));
  }
  const auto fields = Read(file);
  ASSERT_TRUE(fields.ok()) << fields.status();
  ExpectCloud(**fields, hexagons_);
  EXPECT_FALSE(info_.latitude_deg.has_value());
}

TEST_F(UnstructuredFiles, WhatIsMissingIsNamed) {
  SyntheticCf mpas = Mpas(hexagons_);
  Remove(mpas, "latCell");
  ExpectError(mpas, "ncks -A -v lonCell,latCell,zgrid");
  mpas = Mpas(hexagons_);
  Remove(mpas, "zgrid");
  ExpectError(mpas, "MPAS writes them to zgrid");
  SyntheticCf icon = Icon(triangles_);
  Remove(icon, "clon");
  ExpectError(icon, "cdo setgrid,GRID_FILE");
  icon = Icon(triangles_);
  Remove(icon, "z_ifc");
  ExpectError(icon, "HHL or z_ifc");
  icon = Icon(triangles_);
  Remove(icon, "rho");
  ExpectError(icon, "lacks the air's density");
  icon = Icon(triangles_);
  Variable(icon, "clat").value = [](const Index&) { return 0.8; };
  ExpectError(icon, "no area");
}

// The dimension is larger than any model's. Nothing of its size is allocated.
TEST_F(UnstructuredFiles, TooManyCellsAreRefused) {
  int id = 0;
  int on[2] = {0, 0};
  int variable = 0;
  ASSERT_EQ(nc_create(path_.c_str(), NC_NETCDF4 | NC_CLOBBER, &id), NC_NOERR);
  ASSERT_EQ(nc_def_dim(id, "height", 10, &on[0]), NC_NOERR);
  ASSERT_EQ(nc_def_dim(id, "ncells", 1'000'000'000, &on[1]), NC_NOERR);
  for (const char* name : {"clon", "clat", "qc"}) {
    const bool field = name[0] == 'q';
    ASSERT_EQ(nc_def_var(id, name, NC_FLOAT, field ? 2 : 1, field ? on : on + 1, &variable),
              NC_NOERR);
    const char* const unit = field ? "kg m-3" : "radian";
    ASSERT_EQ(nc_put_att_text(id, variable, "units", 6, unit), NC_NOERR);
    const std::size_t chunks[2] = {field ? 1U : 100'000U, 100'000U};
    ASSERT_EQ(nc_def_var_chunking(id, variable, NC_CHUNKED, chunks), NC_NOERR);
  }
  ASSERT_EQ(nc_close(id), NC_NOERR);
  const auto store = storm_store::StormStore::Open({path_}, {.read_ahead = 0});
  ASSERT_FALSE(store.ok());
  EXPECT_THAT(std::string(store.status().message()), HasSubstr("1000000000 cells"));
}

}  // namespace
}  // namespace thunderhead::storm_files::unstructured_files_test

// Tests of exported storms, read back by OpenVDB itself.
#include "interchange/storm_export.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <openvdb/io/File.h>
#include <openvdb/openvdb.h>

#include <cmath>
#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "physics/optics.h"
#include "scene/detailed_medium.h"
#include "scene/drawn_fields.h"
#include "storm_store/storm_store.h"
#include "tests/support/temporary_folder.h"

namespace thunderhead::interchange {
namespace {

using physics::Hydrometeor;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using testing::TemporaryFolder;
using volume::HydrometeorField;
using volume::HydrometeorFields;

constexpr double kHalfPrecision = 1.0 / 2048.0;  // relative error: half the spacing of half floats
constexpr double kSmallestHalf =
    1.0 / (1 << 24) / 2.0;  // absolute error of the smallest half floats

HydrometeorField Field(Hydrometeor hydrometeor, const volume::RegularGrid& grid, float peak) {
  HydrometeorField field;
  field.hydrometeor = hydrometeor;
  field.variable = "Q" + std::string(physics::NameOf(hydrometeor));
  field.concentration_kg_per_m3.assign(grid.CellCount(), 0.0F);
  for (std::size_t i = 0; i < grid.CellCount(); ++i) {
    if (i % 3 != 0) field.concentration_kg_per_m3[i] = peak * static_cast<float>(i % 101) / 101.0F;
  }
  return field;
}

// Returns a storm no edge of which is a multiple of a block's edge.
std::shared_ptr<HydrometeorFields> SmallStorm() {
  auto fields = std::make_shared<HydrometeorFields>();
  fields->grid = {{11, 9, 18}, {500.0, 400.0, 300.0}, {-2750.0, -1800.0, 120.0}};
  fields->fields = {Field(Hydrometeor::kCloud, fields->grid, 2e-3F),
                    Field(Hydrometeor::kRain, fields->grid, 4e-3F)};
  fields->condensate = {{0, 0, 0}, fields->grid.cells};
  return fields;
}

storm_store::StormInfo Info() {
  storm_store::StormInfo storm;
  storm.id = "small";
  storm.title = "a small storm";
  storm.files = {"small_1.nc", "small_2.nc"};
  storm.times = {{"2013-05-20T20:00:00Z", 0.0}, {"2013-05-20T20:10:00Z", 600.0}};
  storm.latitude_deg = 35.25;
  storm.longitude_deg = -97.5;
  return storm;
}

scene::Scene SecondTime() {
  scene::Scene scene;
  scene.time_index = 1;
  return scene;
}

struct ReadBack {
  std::map<std::string, openvdb::FloatGrid::Ptr> grids;
  openvdb::MetaMap::Ptr metadata;
};

ReadBack Read(const std::string& path) {
  openvdb::initialize();
  openvdb::io::File file(path);
  file.open();
  ReadBack read;
  const openvdb::GridPtrVecPtr grids = file.getGrids();
  for (const auto& grid : *grids) {
    read.grids[grid->getName()] = openvdb::gridPtrCast<openvdb::FloatGrid>(grid);
  }
  read.metadata = file.getMetadata();
  return read;
}

class StormExportTest : public ::testing::Test {
 protected:
  ReadBack Export(const scene::Scene& scene, const std::shared_ptr<const HydrometeorFields>& fields,
                  const ExportOptions& options = {}) {
    const auto file = ExportOf(scene, fields, Info(), options);
    EXPECT_TRUE(file.ok()) << file.status();
    const absl::Status status = WriteVdb(*file, path_, {}, {});
    EXPECT_TRUE(status.ok()) << status;
    EXPECT_THAT(Names(), ElementsAre("storm.vdb"));
    return Read(path_);
  }

  std::vector<std::string> Names() const {
    std::vector<std::string> names;
    for (const auto& entry : std::filesystem::directory_iterator(folder_.Path())) {
      names.push_back(entry.path().filename());
    }
    return names;
  }

  const TemporaryFolder folder_;
  const std::string path_ = folder_.File("storm.vdb");
};

// Returns the value that the file should hold, computed by eq. 4 of Riley et al. 2003
// (physics/hydrometeors.h) alone.
double ExtinctionOf(const HydrometeorField& field, std::size_t cell) {
  const physics::ParticleOptics& optics = physics::DefaultOptics(field.hydrometeor);
  return 1.5 /
         (static_cast<double>(optics.density_kg_per_m3) * static_cast<double>(optics.radius_m)) *
         static_cast<double>(field.concentration_kg_per_m3[cell]);
}

TEST_F(StormExportTest, ValuesAreExtinctionInMetresWithinHalfPrecision) {
  const auto fields = SmallStorm();
  const ReadBack read = Export(SecondTime(), fields);
  ASSERT_EQ(read.grids.size(), 2U);
  const volume::RegularGrid& grid = fields->grid;
  for (const HydrometeorField& field : fields->fields) {
    const auto values = read.grids.at(std::string(physics::NameOf(field.hydrometeor)));
    ASSERT_NE(values, nullptr);
    const auto accessor = values->getConstAccessor();
    std::size_t filled = 0;
    for (int z = 0; z < grid.cells.z; ++z) {
      for (int y = 0; y < grid.cells.y; ++y) {
        for (int x = 0; x < grid.cells.x; ++x) {
          const double expected = ExtinctionOf(field, grid.Offset(x, y, z));
          const openvdb::Coord voxel(x, y, z);
          ASSERT_NEAR(accessor.getValue(voxel), expected, kHalfPrecision * expected + kSmallestHalf)
              << x << " " << y << " " << z;
          ASSERT_EQ(accessor.isValueOn(voxel), expected > 0.0);
          if (expected > 0.0) ++filled;
        }
      }
    }
    EXPECT_EQ(values->activeVoxelCount(), filled) << "nothing beyond the storm's grid";
    EXPECT_EQ(values->background(), 0.0F);
    EXPECT_TRUE(values->saveFloatAsHalf());
    EXPECT_EQ(values->getGridClass(), openvdb::GRID_FOG_VOLUME);
  }
}

TEST_F(StormExportTest, VoxelsLieAtTheCellsCentres) {
  const ReadBack read = Export(SecondTime(), SmallStorm());
  const openvdb::math::Transform& transform = read.grids.at("rain")->transform();
  EXPECT_TRUE(transform.isLinear());
  const openvdb::Vec3d first = transform.indexToWorld(openvdb::Coord(0, 0, 0));
  EXPECT_NEAR(first.x(), -2500.0, 1e-9);
  EXPECT_NEAR(first.y(), -1600.0, 1e-9);
  EXPECT_NEAR(first.z(), 270.0, 1e-9);
  const openvdb::Vec3d other = transform.indexToWorld(openvdb::Coord(10, 8, 17));
  EXPECT_NEAR(other.x(), 2500.0, 1e-9);
  EXPECT_NEAR(other.y(), 1600.0, 1e-9);
  EXPECT_NEAR(other.z(), 270.0 + 17 * 300.0, 1e-9);
}

TEST_F(StormExportTest, MetadataSaysWhatWhenAndWhere) {
  const ReadBack read = Export(SecondTime(), SmallStorm());
  const openvdb::MetaMap& file = *read.metadata;
  EXPECT_EQ(file.metaValue<std::string>("title"), "a small storm");
  EXPECT_EQ(file.metaValue<std::string>("source_files"), "small_1.nc\nsmall_2.nc");
  EXPECT_EQ(file.metaValue<std::string>("valid_time"), "2013-05-20T20:10:00Z");
  EXPECT_EQ(file.metaValue<double>("elapsed_s"), 600.0);
  EXPECT_EQ(file.metaValue<std::int64_t>("time_index"), 1);
  EXPECT_EQ(file.metaValue<double>("origin_latitude_deg"), 35.25);
  EXPECT_EQ(file.metaValue<double>("origin_longitude_deg"), -97.5);
  EXPECT_THAT(file.metaValue<std::string>("creator"), HasSubstr("thunderhead "));
  const openvdb::FloatGrid& rain = *read.grids.at("rain");
  EXPECT_EQ(rain.metaValue<std::string>("units"), "1/m");
  EXPECT_EQ(rain.metaValue<std::string>("quantity"), "extinction");
  EXPECT_EQ(rain.metaValue<std::string>("source_variable"), "Qrain");
  EXPECT_EQ(rain.metaValue<double>("albedo"), 1.0);
  const physics::ParticleOptics& optics = physics::DefaultOptics(Hydrometeor::kRain);
  EXPECT_FLOAT_EQ(static_cast<float>(rain.metaValue<double>("effective_radius_m")),
                  optics.radius_m);
  EXPECT_EQ(rain.metaValue<std::string>("effective_radius_source"), "default");
  EXPECT_NEAR(rain.metaValue<double>("asymmetry"), physics::MeanCosine(physics::PhaseOf(optics)),
              1e-12);
}

TEST_F(StormExportTest, AnIdealisedStormHasNoPlace) {
  storm_store::StormInfo storm = Info();
  storm.latitude_deg.reset();
  storm.longitude_deg.reset();
  const auto file = ExportOf(SecondTime(), SmallStorm(), storm, {});
  ASSERT_TRUE(file.ok());
  EXPECT_EQ(file->metadata.count("origin_latitude_deg"), 0U);
}

TEST_F(StormExportTest, FieldsAreThoseOfTheScene) {
  const auto fields = SmallStorm();
  scene::Scene scene = SecondTime();
  scene.fields[physics::IndexOf(Hydrometeor::kCloud)].visible = false;
  scene::FieldParameters& rain = scene.fields[physics::IndexOf(Hydrometeor::kRain)];
  rain.scale = 3.0F;
  rain.optics.albedo = 0.75F;
  rain.optics.radius_m = 5e-4F;
  rain.sizes = physics::SizeSource::kGiven;
  rain.optics.phase = {physics::PhaseKind::kHenyeyGreenstein, 0.5F};
  const ReadBack read = Export(scene, fields);
  ASSERT_EQ(read.grids.size(), 1U);
  const openvdb::FloatGrid& grid = *read.grids.at("rain");
  // Extinction is inversely proportional to the radius.
  const double default_m = static_cast<double>(physics::DefaultOptics(Hydrometeor::kRain).radius_m);
  const double expected = 3.0 * ExtinctionOf(fields->fields[1], 50) * default_m / 5e-4;
  EXPECT_NEAR(grid.getConstAccessor().getValue(openvdb::Coord(6, 4, 0)), expected,
              kHalfPrecision * expected);
  EXPECT_EQ(grid.metaValue<double>("albedo"), 0.75);
  EXPECT_NEAR(grid.metaValue<double>("asymmetry"), 0.5, 1e-9);
  EXPECT_FLOAT_EQ(static_cast<float>(grid.metaValue<double>("effective_radius_m")), 5e-4F);
  EXPECT_EQ(grid.metaValue<std::string>("effective_radius_source"), "scene");
}

TEST_F(StormExportTest, AnEmptyStormIsAFileWithoutGrids) {
  auto fields = SmallStorm();
  for (HydrometeorField& field : fields->fields) field.concentration_kg_per_m3.clear();
  EXPECT_THAT(Export(SecondTime(), fields).grids, IsEmpty());
}

TEST_F(StormExportTest, ColumnsOfTheSampleKeepTheirOpticalDepth) {
  const auto store =
      *storm_store::StormStore::Open({THUNDERHEAD_SOURCE_DIR "/samples/supercell.nc"}, {});
  const storm_store::StormInfo& storm = *store->Storms().front();
  const auto fields = *store->Get(storm.id, 1, {});
  const ReadBack read = Export(SecondTime(), fields);
  ASSERT_EQ(read.grids.size(), 5U);
  const openvdb::FloatGrid& cloud = *read.grids.at("cloud");
  EXPECT_EQ(cloud.metaValue<std::string>("effective_radius_source"), "model");
  EXPECT_FLOAT_EQ(static_cast<float>(cloud.metaValue<double>("effective_radius_m")),
                  fields->fields[0].sizes.mean_radius_m);
  scene::Scene shown;
  for (const scene::DrawnField& drawn : scene::DrawnFieldsOf(shown, *fields)) {
    const auto accessor =
        read.grids.at(std::string(physics::NameOf(drawn.hydrometeor)))->getConstAccessor();
    std::vector<float> cell(1);
    for (int y = 0; y < fields->grid.cells.y; ++y) {
      for (int x = 0; x < fields->grid.cells.x; ++x) {
        double expected = 0.0;
        double written = 0.0;
        for (int z = 0; z < fields->grid.cells.z; ++z) {
          cell[0] = 0.0F;
          volume::AddExtinction(fields->fields[drawn.index], drawn.mass_extinction,
                                fields->grid.Offset(x, y, z), 1, cell.data());
          expected += static_cast<double>(cell[0]);
          written += static_cast<double>(accessor.getValue(openvdb::Coord(x, y, z)));
        }
        ASSERT_NEAR(written, expected,
                    kHalfPrecision * expected + fields->grid.cells.z * kSmallestHalf)
            << x << " " << y;
      }
    }
  }
}

TEST_F(StormExportTest, DetailIsThatOfTheDrawnMedium) {
  const auto fields = SmallStorm();
  scene::Scene scene = SecondTime();
  scene::Detail& detail = scene.fields[physics::IndexOf(Hydrometeor::kCloud)].detail;
  detail = {.share = 0.8F, .wavelength_m = 900.0F, .octaves = 3, .seed = 7};
  const ReadBack read = Export(scene, fields, {.detail = true});
  EXPECT_EQ(read.metadata->metaValue<std::int64_t>("turbulent_detail"), 1);
  const auto medium = scene::DetailedMedium::Of(scene, *fields);
  int changed = 0;
  for (std::size_t field = 0; field < 2; ++field) {
    const openvdb::FloatGrid& grid =
        *read.grids.at(std::string(physics::NameOf(fields->fields[field].hydrometeor)));
    EXPECT_EQ(grid.voxelSize(), openvdb::Vec3d(125.0, 100.0, 75.0));
    const auto accessor = grid.getConstAccessor();
    for (int i = 0; i < 44 * 36 * 72; i += 97) {
      const openvdb::Coord voxel(i % 44, i / 44 % 36, i / 44 / 36);
      const openvdb::Vec3d at_m = grid.indexToWorld(voxel);
      const double expected = medium->At_per_m(glm::dvec3(at_m.x(), at_m.y(), at_m.z()))[field];
      ASSERT_NEAR(accessor.getValue(voxel), expected, 2.0 * kHalfPrecision * expected + 1e-6)
          << voxel;
      if (expected > 0.0) ++changed;
    }
  }
  EXPECT_GT(changed, 500);
}

// Sums the storm over fields that are drawn as one group. They share the factors of their columns,
// so graupel alone has 4 % more. Detail keeps the water of single columns only as far as
// volume/water_paths.h says.
TEST_F(StormExportTest, DetailKeepsTheWaterOfTheSample) {
  const auto store =
      *storm_store::StormStore::Open({THUNDERHEAD_SOURCE_DIR "/samples/supercell.nc"}, {});
  const auto fields = *store->Get(store->Storms().front()->id, 0, {});
  scene::Scene scene;
  const ReadBack with = Export(scene, fields, {.detail = true});
  const ReadBack without = Export(scene, fields);
  const auto sum = [](const openvdb::FloatGrid& grid) {
    double total = 0.0;
    for (auto value = grid.cbeginValueOn(); value; ++value) total += static_cast<double>(*value);
    return total;
  };
  const std::vector<std::vector<std::string>> groups = {{"cloud"}, {"rain"}, {"snow", "graupel"}};
  for (const std::vector<std::string>& group : groups) {
    double expected = 0.0;
    double written = 0.0;
    for (const std::string& name : group) {
      expected += sum(*without.grids.at(name));
      written += sum(*with.grids.at(name)) / 64.0;
    }
    EXPECT_NEAR(written, expected, 0.01 * expected) << group.front();
  }
}

TEST_F(StormExportTest, FinerVoxelsAreLinearBetweenCellsAndKeepTheTotal) {
  auto fields = SmallStorm();
  fields->fields.resize(1);
  std::vector<float>& values = fields->fields[0].concentration_kg_per_m3;
  std::fill(values.begin(), values.end(), 0.0F);
  values[fields->grid.Offset(5, 4, 7)] = 1e-3F;
  scene::Scene scene = SecondTime();
  scene.fields[physics::IndexOf(Hydrometeor::kCloud)].detail.share = 0.0F;
  const ReadBack read = Export(scene, fields, {.detail = true});
  const double peak = ExtinctionOf(fields->fields[0], fields->grid.Offset(5, 4, 7));
  const auto accessor = read.grids.at("cloud")->getConstAccessor();
  // The place is three eighths of a cell from the centre along x, and one eighth along y and z.
  const double expected = peak * (5.0 / 8.0) * (7.0 / 8.0) * (7.0 / 8.0);
  EXPECT_NEAR(accessor.getValue(openvdb::Coord(23, 17, 30)), expected, kHalfPrecision * expected);
  double sum = 0.0;
  for (auto value = read.grids.at("cloud")->cbeginValueOn(); value; ++value) {
    sum += static_cast<double>(*value);
  }
  EXPECT_NEAR(sum / 64.0, peak, 2.0 * kHalfPrecision * peak);
}

TEST_F(StormExportTest, FailuresLeaveNoFile) {
  const auto fields = SmallStorm();
  const auto file = ExportOf(SecondTime(), fields, Info(), {});
  ASSERT_TRUE(file.ok());
  const absl::Status nowhere = WriteVdb(*file, folder_.File("no/storm.vdb"), {}, {});
  EXPECT_EQ(nowhere.code(), absl::StatusCode::kFailedPrecondition);
  EXPECT_THAT(nowhere.message(), HasSubstr("no/storm.vdb cannot be written"));
  std::stop_source stop;
  std::vector<double> shares;
  const absl::Status stopped = WriteVdb(
      *file, path_,
      [&](double share) {
        shares.push_back(share);
        stop.request_stop();
      },
      stop.get_token());
  EXPECT_EQ(stopped.code(), absl::StatusCode::kCancelled);
  EXPECT_EQ(shares.size(), 1U) << "stops before the next layer of blocks";
  EXPECT_THAT(Names(), IsEmpty());
}

TEST_F(StormExportTest, StoppedWhileWritingLeavesTheFormerFile) {
  const auto file = ExportOf(SecondTime(), SmallStorm(), Info(), {});
  ASSERT_TRUE(file.ok());
  ASSERT_TRUE(WriteVdb(*file, path_, {}, {}).ok());
  const auto before = std::filesystem::last_write_time(path_);
  std::stop_source stop;
  std::vector<double> shares;
  const absl::Status stopped = WriteVdb(
      *file, path_,
      [&](double share) {
        shares.push_back(share);
        // This is the last report before writing.
        if (shares.size() == 7) stop.request_stop();
      },
      stop.get_token());
  EXPECT_EQ(shares.size(), 7U);
  EXPECT_EQ(stopped.code(), absl::StatusCode::kCancelled);
  EXPECT_THAT(Names(), ElementsAre("storm.vdb"));
  EXPECT_EQ(std::filesystem::last_write_time(path_), before);
}

TEST_F(StormExportTest, MoreThanAHalfFloatHoldsIsAnError) {
  auto fields = SmallStorm();
  fields->fields[0].concentration_kg_per_m3[5] = 1e3F;
  const auto file = ExportOf(SecondTime(), fields, Info(), {});
  EXPECT_EQ(file.status().code(), absl::StatusCode::kInvalidArgument);
  EXPECT_THAT(std::string(file.status().message()), HasSubstr("extinction of cloud reaches"));
}

}  // namespace
}  // namespace thunderhead::interchange

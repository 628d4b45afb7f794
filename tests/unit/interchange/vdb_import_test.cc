// Tests of grids that OpenVDB writes, a confined process reads, and the import turns into storms.
#include "interchange/vdb_import.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <openvdb/io/File.h>
#include <openvdb/io/Stream.h>
#include <openvdb/openvdb.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <numbers>
#include <random>
#include <sstream>
#include <string>
#include <vector>

#include "absl/strings/str_cat.h"
#include "base/error_details.h"
#include "base/machine_memory.h"
#include "glm/geometric.hpp"
#include "interchange/vdb_file.h"
#include "interchange/vdb_file_reader.h"
#include "sandbox/confined_files.h"
#include "storm_files/storm_format.h"
#include "tests/support/temporary_folder.h"

namespace thunderhead::interchange {
namespace {

using openvdb::Coord;
using openvdb::FloatGrid;
using ::testing::AnyOf;
using ::testing::HasSubstr;
using ::testing::Not;
using testing::TemporaryFolder;

constexpr char kOwnProgram[] = "/proc/self/exe";

#ifdef __SANITIZE_ADDRESS__
constexpr bool kNewEndsTheProgram = true;
#else
constexpr bool kNewEndsTheProgram = false;
#endif
constexpr char kWhyNot[] =
    "AddressSanitizer's operator new ends the program where others throw std::bad_alloc";

std::string Contents(const std::string& path) {
  std::ostringstream text;
  text << std::ifstream(path, std::ios::binary).rdbuf();
  return text.str();
}

void Write(const std::string& path, const std::string& bytes) {
  std::ofstream(path, std::ios::binary) << bytes;
}

FloatGrid::Ptr Grid(const std::string& name = "density") {
  openvdb::initialize();
  FloatGrid::Ptr grid = FloatGrid::create(0.0F);
  grid->setName(name);
  grid->setGridClass(openvdb::GRID_FOG_VOLUME);
  return grid;
}

FloatGrid::Ptr OneVoxel(const std::string& name = "density", float value = 1.0F) {
  FloatGrid::Ptr grid = Grid(name);
  grid->tree().setValueOn(Coord(0, 0, 0), value);
  return grid;
}

// A ball whose density falls from 1 at the centre to 0 at the radius, as 1 - (r / radius)^2. The
// integral of this density is 8 pi / 15 times the radius cubed.
struct Ball {
  glm::dvec3 centre;  // in units of the file's world
  double radius = 0.0;

  double Integral() const { return 8.0 * std::numbers::pi / 15.0 * std::pow(radius, 3); }
};

FloatGrid::Ptr GridOf(const Ball& ball, double voxel) {
  FloatGrid::Ptr grid = Grid();
  grid->setTransform(openvdb::math::Transform::createLinearTransform(voxel));
  const auto low = glm::ivec3(glm::floor((ball.centre - ball.radius) / voxel));
  const auto high = glm::ivec3(glm::ceil((ball.centre + ball.radius) / voxel));
  for (int z = low.z; z <= high.z; ++z) {
    for (int y = low.y; y <= high.y; ++y) {
      for (int x = low.x; x <= high.x; ++x) {
        const double r = glm::length(voxel * glm::dvec3(x, y, z) - ball.centre) / ball.radius;
        if (r < 1.0) grid->tree().setValueOn(Coord(x, y, z), static_cast<float>(1.0 - r * r));
      }
    }
  }
  return grid;
}

class VdbImportTest : public ::testing::Test {
 protected:
  void Save(const openvdb::GridPtrVec& grids,
            std::uint32_t compression = openvdb::io::Archive::DEFAULT_COMPRESSION_FLAGS) const {
    openvdb::io::File file(path_);
    file.setCompression(compression);
    file.write(grids);
  }

  absl::StatusOr<VdbVolume> Read(const std::string& grid = "density") const {
    return ReadVdb(path_, grid, {}, {.program = kOwnProgram});
  }

  absl::StatusOr<storm_files::CfCloud> Import(const ImportOptions& options = {
                                                  .base_m = 0.0}) const {
    const auto volume = Read();
    if (!volume.ok()) return volume.status();
    return CloudOf(*volume, options);
  }

  // Expects that the file that was saved last is refused with this text.
  void ExpectRefused(const std::string& why, const std::string& grid = "density") const {
    const auto volume = Read(grid);
    ASSERT_FALSE(volume.ok()) << why;
    EXPECT_EQ(volume.status().code(), absl::StatusCode::kInvalidArgument) << volume.status();
    EXPECT_THAT(std::string(volume.status().message()), HasSubstr(path_ + ": "));
    EXPECT_THAT(std::string(volume.status().message()), HasSubstr(why));
  }

  const TemporaryFolder folder_;
  const std::string path_ = folder_.File("cloud.vdb");
};

// Integral (m2) and centroid (m) of a cloud's extinction.
struct Moments {
  double integral_m2 = 0.0;
  glm::dvec3 centroid_m{0.0};
};

Moments MomentsOf(const volume::RegularGrid& grid, const std::vector<float>& extinction_per_m) {
  Moments moments;
  const double cell_m3 = grid.spacing_m.x * grid.spacing_m.y * grid.spacing_m.z;
  for (int z = 0; z < grid.cells.z; ++z) {
    for (int y = 0; y < grid.cells.y; ++y) {
      for (int x = 0; x < grid.cells.x; ++x) {
        const double amount_m2 = extinction_per_m[grid.Offset(x, y, z)] * cell_m3;
        moments.integral_m2 += amount_m2;
        moments.centroid_m +=
            amount_m2 * (grid.low_corner_m + (glm::dvec3(x, y, z) + 0.5) * grid.spacing_m);
      }
    }
  }
  moments.centroid_m /= moments.integral_m2;
  return moments;
}

TEST_F(VdbImportTest, ABallKeepsItsIntegralPlaceAndScale) {
  const Ball ball = {{3.0, 40.0, -7.0}, 10.0};
  constexpr double kVoxel = 0.5;
  const ImportOptions options = {
      .up = UpAxis::kY, .metres_per_unit = 25.0, .extinction_per_m = 0.06, .base_m = {}};
  const double expected_m2 = 0.06 * ball.Integral() * std::pow(25.0, 3);
  const std::vector<std::uint32_t> compressions = {
      openvdb::io::COMPRESS_NONE, openvdb::io::COMPRESS_ZIP | openvdb::io::COMPRESS_ACTIVE_MASK,
      openvdb::io::COMPRESS_BLOSC | openvdb::io::COMPRESS_ACTIVE_MASK};
  for (const std::uint32_t compression : compressions) {
    Save({GridOf(ball, kVoxel)}, compression);
    const auto cloud = Import(options);
    ASSERT_TRUE(cloud.ok()) << cloud.status();
    EXPECT_EQ(cloud->quantity, volume::Quantity::kExtinction);
    EXPECT_DOUBLE_EQ(cloud->grid.spacing_m.x, 12.5);
    const Moments moments = MomentsOf(cloud->grid, cloud->values);
    EXPECT_NEAR(moments.integral_m2, expected_m2, 2e-3 * expected_m2);
    // The file's x is east, its -z north and its y up.
    EXPECT_NEAR(glm::distance(moments.centroid_m, glm::dvec3(75.0, 175.0, 1000.0)), 0.0, 0.05);
  }
}

TEST_F(VdbImportTest, TheWrittenStormIsReadWithTheSameExtinction) {
  const Ball ball = {{0.0, 0.0, 30.0}, 10.0};
  Save({GridOf(ball, 1.0)});
  const auto cloud = Import(
      {.up = UpAxis::kZ, .metres_per_unit = 50.0, .extinction_per_m = 0.01, .base_m = 800.0});
  ASSERT_TRUE(cloud.ok()) << cloud.status();
  const std::string storm_path = folder_.File("cloud.nc");
  ASSERT_TRUE(storm_files::WriteCfCloud(*cloud, storm_path).ok());
  const auto file = storm_files::StormFormats::BuiltIn().Describe(storm_path);
  ASSERT_TRUE(file.ok()) << file.status();
  const auto fields = file->reader->Read(0, std::nullopt, {});
  ASSERT_TRUE(fields.ok()) << fields.status();
  ASSERT_EQ(fields->fields.size(), 1);
  EXPECT_EQ(fields->fields[0].quantity, volume::Quantity::kExtinction);
  const Moments moments = MomentsOf(fields->grid, fields->fields[0].concentration_kg_per_m3);
  const double expected_m2 = 0.01 * ball.Integral() * std::pow(50.0, 3);
  EXPECT_NEAR(moments.integral_m2, expected_m2, 2e-3 * expected_m2);
  // The outermost voxel with a value is less than a voxel inside the ball.
  EXPECT_NEAR(moments.centroid_m.z, 800.0 + 500.0, 50.0);
}

TEST_F(VdbImportTest, AxesAreTurnedAndNotMirrored) {
  VdbVolume volume;
  volume.grid = "density";
  volume.voxels = {2, 3, 4};
  volume.first = {10.0, 20.0, 30.0};
  volume.steps = {glm::dvec3(1.0, 0.0, 0.0), glm::dvec3(0.0, 2.0, 0.0), glm::dvec3(0.0, 0.0, 3.0)};
  volume.values.assign(volume.VoxelCount(), 0.0F);
  const auto value = [&volume](int i, int j, int k) -> float& {
    return volume.values[static_cast<std::size_t>((k * 3 + j) * 2 + i)];
  };
  value(0, 0, 0) = 1.0F;  // the first voxel, and its neighbours along i, j and k
  value(1, 0, 0) = 2.0F;
  value(0, 1, 0) = 3.0F;
  value(0, 0, 1) = 4.0F;
  struct Case {
    UpAxis up;
    glm::ivec3 cells;
    glm::dvec3 low_corner_m;
    glm::ivec3 first, i, j, k;  // the cells of the voxels above
  };
  const Case cases[] = {
      {UpAxis::kZ, {2, 3, 4}, {9.5, 19, 28.5}, {0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}},
      {UpAxis::kY, {2, 4, 3}, {9.5, -40.5, 19}, {0, 3, 0}, {1, 3, 0}, {0, 3, 1}, {0, 2, 0}},
      {UpAxis::kX, {3, 4, 2}, {19, 28.5, 9.5}, {0, 0, 0}, {0, 0, 1}, {1, 0, 0}, {0, 1, 0}}};
  for (const Case& each : cases) {
    const auto cloud = CloudOf(volume, {.up = each.up, .base_m = {}});
    ASSERT_TRUE(cloud.ok()) << cloud.status();
    const auto at = [&cloud](const glm::ivec3& cell) {
      return cloud->values[cloud->grid.Offset(cell.x, cell.y, cell.z)];
    };
    EXPECT_EQ(cloud->grid.cells, each.cells);
    EXPECT_NEAR(glm::distance(cloud->grid.low_corner_m, each.low_corner_m), 0.0, 1e-12);
    EXPECT_EQ(at(each.first), 1.0F);
    EXPECT_EQ(at(each.i), 2.0F);
    EXPECT_EQ(at(each.j), 3.0F);
    EXPECT_EQ(at(each.k), 4.0F);
  }
}

TEST_F(VdbImportTest, ATransformMayTurnAndMirrorTheIndex) {
  FloatGrid::Ptr grid = OneVoxel();
  grid->tree().setValueOn(Coord(0, 0, 5), 2.0F);
  // The index k points towards -x, i towards y, and j towards z. Each row is the step of an index.
  grid->setTransform(openvdb::math::Transform::createLinearTransform(
      openvdb::Mat4d(0, 2, 0, 0, /**/ 0, 0, 3, 0, /**/ -4, 0, 0, 0, /**/ 100, 200, 300, 1)));
  Save({grid});
  const auto cloud = Import({.base_m = {}});
  ASSERT_TRUE(cloud.ok()) << cloud.status();
  EXPECT_EQ(cloud->grid.cells, glm::ivec3(6, 2, 2));
  EXPECT_NEAR(glm::distance(cloud->grid.spacing_m, glm::dvec3(4.0, 2.0, 3.0)), 0.0, 1e-12);
  EXPECT_NEAR(glm::distance(cloud->grid.low_corner_m, glm::dvec3(78.0, 199.0, 298.5)), 0.0, 1e-12);
  EXPECT_EQ(cloud->values[0], 2.0F);
  EXPECT_EQ(cloud->values[5], 1.0F);
}

TEST_F(VdbImportTest, AnExportedStormComesBack) {
  VdbFile file;
  const volume::RegularGrid grid = {{11, 9, 18}, {500.0, 400.0, 300.0}, {-2750.0, -1800.0, 120.0}};
  const auto value = [](int x, int y, int z) { return 0.01F * static_cast<float>(1 + x + y + z); };
  file.grids.push_back({"cloud", grid, {}, [&](const glm::ivec3& first, VdbBlock& values) {
                          for (int i = 0; i < kVdbBlockCells * kVdbBlockCells * kVdbBlockCells;
                               ++i) {
                            values[static_cast<std::size_t>(i)] =
                                value(first.x + i % 8, first.y + i / 8 % 8, first.z + i / 64);
                          }
                          return true;
                        }});
  ASSERT_TRUE(WriteVdb(file, path_, {}, {}).ok());
  const auto volume = Read("cloud");
  ASSERT_TRUE(volume.ok()) << volume.status();
  const auto cloud = CloudOf(*volume, {.base_m = {}});
  ASSERT_TRUE(cloud.ok()) << cloud.status();
  EXPECT_EQ(cloud->grid.cells, grid.cells);
  EXPECT_NEAR(glm::distance(cloud->grid.spacing_m, grid.spacing_m), 0.0, 1e-9);
  EXPECT_NEAR(glm::distance(cloud->grid.low_corner_m, grid.low_corner_m), 0.0, 1e-9);
  for (int z = 0; z < 18; ++z) {
    for (int y = 0; y < 9; ++y) {
      for (int x = 0; x < 11; ++x) {
        const float expected = value(x, y, z);
        EXPECT_NEAR(cloud->values[grid.Offset(x, y, z)], expected, expected / 2048.0F);
      }
    }
  }
}

TEST_F(VdbImportTest, TilesAndSharedTreesAreRead) {
  const FloatGrid::Ptr grid = Grid();
  grid->fill(openvdb::CoordBBox(Coord(0, 0, 0), Coord(15, 15, 15)), 0.5F);
  ASSERT_EQ(grid->tree().leafCount(), 0);  // the fill makes tiles of blocks
  FloatGrid::Ptr instance = grid->copy();  // shares the tree
  instance->setName("shared");
  instance->setTransform(openvdb::math::Transform::createLinearTransform(2.0));
  Save({grid, instance});
  for (const std::string name : {"density", "shared"}) {
    const auto volume = Read(name);
    ASSERT_TRUE(volume.ok()) << volume.status();
    EXPECT_EQ(volume->voxels, glm::ivec3(16));
    EXPECT_DOUBLE_EQ(volume->steps[0].x, name == "shared" ? 2.0 : 1.0);
    for (const float value : volume->values) ASSERT_EQ(value, 0.5F);
  }
}

TEST_F(VdbImportTest, GridsAreListedForAnUnknownName) {
  const auto wind = openvdb::Vec3SGrid::create();
  wind->setName("vel");
  Save({OneVoxel(), wind});
  ExpectRefused("give --grid", "");
  ExpectRefused("has no grid 'Density'; the file's grids are: density (float), vel (vec3s)",
                "Density");
  ExpectRefused("'vel' has values of the type vec3s", "vel");
  Save({OneVoxel(), OneVoxel("density", 2.0F)});  // two grids with one name
  ExpectRefused("the file's grids are: density[0] (float), density[1] (float)");
  const auto second = Read("density[1]");
  ASSERT_TRUE(second.ok()) << second.status();
  EXPECT_EQ(second->values, std::vector<float>{2.0F});
}

TEST_F(VdbImportTest, WhatIsNoDensityIsRefused) {
  const FloatGrid::Ptr level_set = OneVoxel();
  level_set->setGridClass(openvdb::GRID_LEVEL_SET);
  Save({level_set});
  ExpectRefused("is a level set");
  const FloatGrid::Ptr filled = FloatGrid::create(0.25F);
  filled->setName("density");
  filled->tree().setValueOn(Coord(1, 2, 3), 1.0F);
  Save({filled});
  ExpectRefused("has the value 0.25 outside its voxels");
  Save({Grid()});
  ExpectRefused("has no active voxel");
  const auto doubles = openvdb::DoubleGrid::create(0.0);
  doubles->setName("density");
  Save({doubles});
  ExpectRefused("has values of the type double");
}

TEST_F(VdbImportTest, AGridThatIsTooLargeIsRefusedBeforeItIsFilled) {
  const FloatGrid::Ptr grid = OneVoxel();
  grid->tree().setValueOn(Coord(1 << 20, 1 << 20, 1 << 20), 1.0F);
  Save({grid});
  ExpectRefused("lie in a box of 1048577 x 1048577 x 1048577 voxels, and 536870912 are the most");
}

TEST_F(VdbImportTest, AFrustumIsRefused) {
  const FloatGrid::Ptr grid = OneVoxel();
  grid->setTransform(openvdb::math::Transform::createFrustumTransform(
      openvdb::BBoxd({0, 0, 0}, {10, 10, 10}), 0.5, 10.0));
  Save({grid});
  ExpectRefused("has a frustum as its transform");
}

TEST_F(VdbImportTest, TurnedAndShearedAxesAreRefused) {
  const double c = std::sqrt(0.5);
  const openvdb::Mat4d turned(c, c, 0., 0., -c, c, 0., 0., 0., 0., 1., 0., 0., 0., 0., 1.);
  const openvdb::Mat4d sheared(1., 0., 0., 0., 0., 1., 0., 0., 0., 0.01, 1., 0., 0., 0., 0., 1.);
  for (const openvdb::Mat4d& transform : {turned, sheared}) {
    const FloatGrid::Ptr grid = OneVoxel();
    grid->setTransform(openvdb::math::Transform::createLinearTransform(transform));
    Save({grid});
    const auto cloud = Import();
    ASSERT_FALSE(cloud.ok());
    EXPECT_THAT(std::string(cloud.status().message()), HasSubstr("is rotated or sheared"));
  }
}

TEST_F(VdbImportTest, ValuesAndHeightsAreChecked) {
  const auto expect_refused = [](const VdbVolume& volume, const ImportOptions& options,
                                 const char* why) {
    const auto cloud = CloudOf(volume, options);
    ASSERT_FALSE(cloud.ok()) << why;
    EXPECT_EQ(cloud.status().code(), absl::StatusCode::kInvalidArgument);
    EXPECT_THAT(std::string(cloud.status().message()), HasSubstr(why));
  };
  VdbVolume volume;
  volume.grid = "density";
  volume.voxels = {1, 1, 2};
  volume.steps = {glm::dvec3(1.0, 0.0, 0.0), glm::dvec3(0.0, 1.0, 0.0), glm::dvec3(0.0, 0.0, 1.0)};
  volume.values = {1.0F, 2.0F};
  const ImportOptions on_ground = {.base_m = 0.0};
  EXPECT_TRUE(CloudOf(volume, on_ground).ok());
  expect_refused(volume, {.base_m = {}}, "begins at the height -0.5 m, which is below sea level");
  expect_refused(volume, {.extinction_per_m = 3e38, .base_m = 0.0}, "is finite and not negative");
  volume.values[1] = -0.5F;
  expect_refused(volume, on_ground, "has the value -0.5");
  volume.values[1] = std::numeric_limits<float>::quiet_NaN();
  expect_refused(volume, on_ground, "has the value nan");
  volume.values = {0.0F, 0.0F};
  expect_refused(volume, on_ground, "has no value above 0");
}

TEST_F(VdbImportTest, AFileWithoutAnIndexIsRefused) {
  std::ofstream out(path_, std::ios::binary);
  openvdb::io::Stream(out).write({OneVoxel()});
  out.close();
  ExpectRefused("without an index of its grids");
}

TEST_F(VdbImportTest, AFileOfAnotherKindStartsNoReader) {
  Write(path_, "Once upon a time there was a cloud.");
  ExpectRefused("does not begin like an OpenVDB file");
  const auto missing = ReadVdb(folder_.File("none.vdb"), "density", {}, {.program = kOwnProgram});
  EXPECT_EQ(missing.status().code(), absl::StatusCode::kNotFound) << missing.status();
}

TEST_F(VdbImportTest, AsAStormItIsRefusedWithTheCommandThatConvertsIt) {
  Save({OneVoxel()});
  const auto file = sandbox::ConfinedFormats({.program = kOwnProgram}).Describe(path_);
  EXPECT_EQ(file.status().code(), absl::StatusCode::kFailedPrecondition);
  EXPECT_THAT(std::string(file.status().message()), HasSubstr("thunderhead import-vdb " + path_));
}

TEST_F(VdbImportTest, ProgressGrowsAndItsErrorStopsTheReading) {
  Save({GridOf({{0.0, 0.0, 0.0}, 20.0}, 1.0)});
  double last = 0.0;
  const auto volume = ReadVdb(path_, "density",
                              [&last](double share) {
                                EXPECT_GE(share, last);
                                last = share;
                                return absl::OkStatus();
                              },
                              {.program = kOwnProgram});
  ASSERT_TRUE(volume.ok()) << volume.status();
  EXPECT_GT(last, 0.5);
  const auto stopped =
      ReadVdb(path_, "density", [](double) { return absl::CancelledError("stop"); },
              {.program = kOwnProgram});
  EXPECT_EQ(stopped.status(), absl::CancelledError("stop"));
}

class DamagedVdbTest : public VdbImportTest {
 protected:
  // Expects a grid, or one error that names the file. A damaged value may go unnoticed.
  void ExpectResultOf(const std::string& bytes, bool must_fail) const {
    Write(path_, bytes);
    const auto volume = Read();
    if (volume.ok()) {
      EXPECT_FALSE(must_fail);
      return;
    }
    EXPECT_THAT(volume.status().code(),
                AnyOf(absl::StatusCode::kInvalidArgument, absl::StatusCode::kDataLoss,
                      absl::StatusCode::kResourceExhausted))
        << volume.status();
    const std::string message(volume.status().message());
    EXPECT_THAT(message, HasSubstr(path_ + ": "));
    EXPECT_THAT(message, Not(HasSubstr("\n")));
  }

  std::string Whole() const {
    Save({GridOf({{0.0, 0.0, 0.0}, 9.0}, 1.0), OneVoxel("heat")});
    return Contents(path_);
  }
};

// Expects an error that says what to do for a file that needs more memory than its reader may use.
void ExpectTooLarge(const absl::Status& status, const std::string& limit) {
  EXPECT_EQ(status.code(), absl::StatusCode::kResourceExhausted) << status;
  EXPECT_TRUE(base::DetailsOf(status).permanent) << "the same file needs as much again";
  EXPECT_THAT(std::string(status.message()), HasSubstr("cloud.vdb: the sizes that it states"));
  EXPECT_THAT(std::string(status.message()),
              HasSubstr("(its reader may use " + limit + " MiB; --memory sets that)"));
}

// Returns the file's bytes, in which the 32-bit size before `text` is changed. OpenVDB allocates
// and fills that size before it reads the text.
std::string WithSizeBefore(const std::string& text, std::uint32_t size, std::string bytes) {
  const auto length = static_cast<std::uint32_t>(text.size());
  const std::string sized(reinterpret_cast<const char*>(&length), sizeof(length));
  const std::size_t place = bytes.find(sized + text);
  EXPECT_NE(place, std::string::npos) << text;
  if (place == std::string::npos) return bytes;
  return bytes.replace(place, sizeof(size), reinterpret_cast<const char*>(&size), sizeof(size));
}

TEST_F(DamagedVdbTest, ASmallFileMayNotClaimMuchMemory) {
  const FloatGrid::Ptr grid = OneVoxel();
  grid->insertMeta("comment", openvdb::StringMetadata("0123456789"));
  openvdb::io::File file(path_);
  file.write({grid}, openvdb::MetaMap(*OneVoxel("of the file")));
  file.close();
  const std::string whole = Contents(path_);
  // The texts are the name, type and value of the metadata of the file and of the grid. They also
  // include the name and type of the grid, and the type of its transform.
  for (const std::string text : {"class", "string", "of the file", "density", "Tree_float_5_4_3",
                                 "comment", "0123456789", "vec3i", "UniformScaleMap"}) {
    SCOPED_TRACE(text);
    // The reader may use 512 MiB.
    for (const std::uint32_t size : {std::uint32_t{300} << 20, std::uint32_t{3} << 30}) {
      Write(path_, WithSizeBefore(text, size, whole));
      const auto volume = Read();
      EXPECT_EQ(volume.status().code(), absl::StatusCode::kDataLoss) << volume.status();
      EXPECT_THAT(std::string(volume.status().message()),
                  HasSubstr(absl::StrCat("is said to have ", size, " bytes, but ")));
    }
  }
  // OpenVDB reads 12 bytes of a vec3i, whatever its stated size. So the next size would be read at
  // another place than where it was checked.
  std::string bytes = whole;
  const std::size_t type = bytes.find("vec3i");
  ASSERT_NE(type, std::string::npos);
  bytes[type + 5] = 11;
  Write(path_, bytes);
  EXPECT_THAT(std::string(Read().status().message()),
              HasSubstr("a value of the type vec3i is said to have 11 bytes, but has 12"));
}

TEST_F(DamagedVdbTest, AnOldFormatIsRefused) {
  std::string bytes = Whole();
  constexpr std::size_t kVersionPlace = 8;
  constexpr std::size_t kCompressionPlace = 21;
  bytes[kVersionPlace] = static_cast<char>(221);
  bytes.insert(kCompressionPlace, 1, '\1');  // this format has the compression in its header
  Write(path_, bytes);
  ExpectRefused("has the OpenVDB file format 221, and 222 is the oldest that can be read");
}

// Two nodes of the tree share most of their space, so that their blocks of voxels would be filled
// twice.
TEST_F(DamagedVdbTest, OverlappingBlocksAreRefused) {
  constexpr int kRootNode = 4096;
  const FloatGrid::Ptr grid = Grid();
  for (const int x : {0, kRootNode}) {
    grid->fill(openvdb::CoordBBox(Coord(x, 0, 0), Coord(x + 127, 127, 127)), 0.5F);
  }
  Save({grid}, openvdb::io::COMPRESS_NONE);
  std::string bytes = Contents(path_);
  const Coord second(kRootNode, 0, 0);
  const std::size_t place =
      bytes.rfind(std::string(reinterpret_cast<const char*>(second.asPointer()), 12));
  ASSERT_NE(place, std::string::npos);
  bytes.replace(place, 4, std::string("\1\0\0\0", 4));
  Write(path_, bytes);
  const auto volume = Read();
  EXPECT_EQ(volume.status().code(), absl::StatusCode::kDataLoss) << volume.status();
  EXPECT_THAT(std::string(volume.status().message()),
              HasSubstr("its blocks of equal voxels overlap"));
}

TEST_F(DamagedVdbTest, TheMemoryOfTheReaderCanBeSet) {
  if (kNewEndsTheProgram) GTEST_SKIP() << kWhyNot;
  const FloatGrid::Ptr grid = OneVoxel();
  grid->tree().setValueOn(Coord(255, 255, 511), 1.0F);
  Save({grid});  // its dense array takes 128 MiB
  VdbReaderOptions options = {.memory_flag = "--memory", .program = kOwnProgram};
  EXPECT_TRUE(ReadVdb(path_, "density", {}, options).ok());
  options.memory_bytes = std::uint64_t{64} << 20;
  ExpectTooLarge(ReadVdb(path_, "density", {}, options).status(), "64");
}

TEST(VdbMemory, GrowsWithTheFile) {
  constexpr std::uint64_t kMiB = 1 << 20;
  EXPECT_EQ(DefaultVdbMemory_bytes(0), 512 * kMiB);
  EXPECT_EQ(DefaultVdbMemory_bytes(kMiB), 612 * kMiB);
  EXPECT_EQ(DefaultVdbMemory_bytes(std::uint64_t{1} << 60), base::MachineMemoryBytes());
}

TEST_F(DamagedVdbTest, ATruncatedFileIsAnError) {
  const std::string whole = Whole();
  // All but the end belongs to the grid that is read, or to the index before it.
  constexpr std::size_t kPlaces = 12;
  for (std::size_t i = 0; i < kPlaces; ++i) {
    ExpectResultOf(whole.substr(0, whole.size() * i / (kPlaces + 2)), true);
  }
}

TEST_F(DamagedVdbTest, MutatedBytesAreAnErrorOrAGrid) {
  const std::string whole = Whole();
  std::mt19937 random(20130520);
  constexpr int kMutations = 32;
  for (int i = 0; i < kMutations; ++i) {
    std::string bytes = whole;
    // Most of a file's structure is in its first bytes.
    const std::size_t end = i % 2 == 0 ? 700 : bytes.size();
    constexpr std::size_t kAfterStart = 8;
    for (int change = 0; change <= i % 4; ++change) {
      bytes[kAfterStart + random() % (end - kAfterStart)] = static_cast<char>(random());
    }
    ExpectResultOf(bytes, false);
  }
}

}  // namespace
}  // namespace thunderhead::interchange

// The library that the program loads when it writes an OpenVDB file (vdb_writer.h). Only this file
// and those of thunderhead-vdb-reader include OpenVDB.
#include "interchange/vdb_writer.h"

// These are the parts of OpenVDB that a file of float grids needs. openvdb/openvdb.h would take
// twice as long to compile.
#include <openvdb/io/File.h>
#include <openvdb/openvdb.h>
#include <tbb/parallel_for.h>

#include <exception>
#include <memory>
#include <optional>

#include "base/half_float.h"
#include "glm/common.hpp"
#include "glm/vec2.hpp"

namespace thunderhead::interchange {
namespace {

using openvdb::FloatGrid;
using Leaf = FloatGrid::TreeType::LeafNodeType;
static_assert(Leaf::DIM == kVdbBlockCells);

// The share of the reported progress that filling the blocks takes. The rest is compressing and
// writing them.
constexpr double kShareOfFilling = 0.8;

openvdb::Metadata::Ptr ToVdb(const std::variant<std::string, double, std::int64_t>& value) {
  if (const auto* text = std::get_if<std::string>(&value)) {
    return std::make_shared<openvdb::StringMetadata>(*text);
  }
  if (const auto* number = std::get_if<double>(&value)) {
    return std::make_shared<openvdb::DoubleMetadata>(*number);
  }
  return std::make_shared<openvdb::Int64Metadata>(std::get<std::int64_t>(value));
}

void SetMetadata(const VdbMetadata& metadata, openvdb::MetaMap* map) {
  for (const auto& [name, value] : metadata) map->insertMeta(name, *ToVdb(value));
}

// Returns the transform from voxel (x, y, z) to the world metres of its centre.
openvdb::math::Transform::Ptr WorldFromVoxel(const volume::RegularGrid& grid) {
  const glm::dvec3 first_m = grid.low_corner_m + 0.5 * grid.spacing_m;
  return std::make_shared<openvdb::math::Transform>(
      std::make_shared<openvdb::math::ScaleTranslateMap>(
          openvdb::Vec3d(grid.spacing_m.x, grid.spacing_m.y, grid.spacing_m.z),
          openvdb::Vec3d(first_m.x, first_m.y, first_m.z)));
}

// Returns the block at `first`; null if all of it is empty.
std::unique_ptr<Leaf> FilledLeaf(const VdbGrid& source, const glm::ivec3& first) {
  VdbBlock values{};
  if (!source.fill(first, values)) return nullptr;
  const glm::ivec3 cells = glm::min(source.grid.cells - first, glm::ivec3(kVdbBlockCells));
  auto leaf = std::make_unique<Leaf>(openvdb::Coord(first.x, first.y, first.z), 0.0F);
  for (int z = 0; z < cells.z; ++z) {
    for (int y = 0; y < cells.y; ++y) {
      for (int x = 0; x < cells.x; ++x) {
        const float value =
            values[static_cast<std::size_t>((z * kVdbBlockCells + y) * kVdbBlockCells + x)];
        if (base::HalfFromFloat(value) == 0) continue;
        leaf->setValueOn(openvdb::Coord(first.x + x, first.y + y, first.z + z), value);
      }
    }
  }
  return leaf->isEmpty() ? nullptr : std::move(leaf);
}

// Adds the blocks of one layer, which begins at height `first_z`.
void AddLayer(const VdbGrid& source, int first_z, FloatGrid* grid) {
  const glm::ivec3 blocks = (source.grid.cells + kVdbBlockCells - 1) / kVdbBlockCells;
  const auto count = static_cast<std::size_t>(blocks.x) * static_cast<std::size_t>(blocks.y);
  std::vector<std::unique_ptr<Leaf>> leaves(count);
  tbb::parallel_for(std::size_t{0}, count, [&](std::size_t i) {
    const auto columns = static_cast<std::size_t>(blocks.x);
    const glm::ivec2 block(static_cast<int>(i % columns), static_cast<int>(i / columns));
    leaves[i] = FilledLeaf(source, {block.x * kVdbBlockCells, block.y * kVdbBlockCells, first_z});
  });
  for (std::unique_ptr<Leaf>& leaf : leaves) {
    if (leaf != nullptr) grid->tree().addLeaf(leaf.release());
  }
}

FloatGrid::Ptr EmptyGrid(const VdbGrid& source) {
  FloatGrid::Ptr grid = FloatGrid::create(0.0F);
  grid->setName(source.name);
  grid->setTransform(WorldFromVoxel(source.grid));
  grid->setGridClass(openvdb::GRID_FOG_VOLUME);
  grid->setSaveFloatAsHalf(true);
  SetMetadata(source.metadata, grid.get());
  return grid;
}

// Returns nothing if `stop` is requested.
std::optional<openvdb::GridPtrVec> FilledGrids(const VdbFile& file,
                                               const std::function<void(double)>& progress,
                                               const std::stop_token& stop) {
  openvdb::GridPtrVec grids;
  for (const VdbGrid& source : file.grids) {
    const FloatGrid::Ptr grid = EmptyGrid(source);
    for (int z = 0; z < source.grid.cells.z; z += kVdbBlockCells) {
      if (stop.stop_requested()) return std::nullopt;
      const double of_grid = static_cast<double>(z) / source.grid.cells.z;
      const double done = static_cast<double>(grids.size()) + of_grid;
      if (progress) progress(kShareOfFilling * done / static_cast<double>(file.grids.size()));
      AddLayer(source, z, grid.get());
    }
    grids.push_back(grid);
  }
  if (progress) progress(kShareOfFilling);
  return grids;
}

VdbWritten Write(const VdbFile& file, const std::string& path,
                 const std::function<void(double)>& progress, const std::stop_token& stop) {
  openvdb::initialize();
  const std::optional<openvdb::GridPtrVec> grids = FilledGrids(file, progress, stop);
  if (!grids.has_value()) return VdbWritten::kStopped;
  openvdb::MetaMap metadata;
  SetMetadata(file.metadata, &metadata);
  openvdb::io::File(path).write(*grids, metadata);
  return stop.stop_requested() ? VdbWritten::kStopped : VdbWritten::kWhole;
}

}  // namespace
}  // namespace thunderhead::interchange

extern "C" thunderhead::interchange::VdbWritten ThunderheadWriteVdb(
    const thunderhead::interchange::VdbFile& file, const std::string& path,
    const std::function<void(double share)>& progress, const std::stop_token& stop,
    std::string& why) {
  try {
    return thunderhead::interchange::Write(file, path, progress, stop);
  } catch (const std::exception& error) {
    why = error.what();
    return thunderhead::interchange::VdbWritten::kFailed;
  }
}

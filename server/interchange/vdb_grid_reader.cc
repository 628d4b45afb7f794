#include "interchange/vdb_grid_reader.h"

#include <openvdb/io/Archive.h>
#include <openvdb/io/DelayedLoadMetadata.h>
#include <openvdb/io/GridDescriptor.h>
#include <openvdb/io/io.h>
#include <openvdb/openvdb.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <istream>
#include <memory>
#include <new>
#include <stdexcept>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "base/status.h"
#include "interchange/memory_stream.h"
#include "interchange/vdb_sizes.h"

namespace thunderhead::interchange {
namespace {

using openvdb::FloatGrid;
using openvdb::io::GridDescriptor;

constexpr int kMostGrids = 1000;
// The oldest format that is read. OpenVDB reads older formats with other code, which trusts
// positions and sizes that the file states.
constexpr std::uint32_t kFirstFormat = openvdb::OPENVDB_FILE_VERSION_NODE_MASK_COMPRESSION;
// The share of the reported progress that reading the file takes. The rest is filling the dense
// array.
constexpr double kShareOfReading = 0.8;

struct Entry {
  GridDescriptor descriptor;
  openvdb::GridBase::Ptr grid;

  std::string Name() const { return GridDescriptor::nameAsString(descriptor.uniqueName()); }
};

// Reads chosen grids of a file in memory. OpenVDB's own readers either open a path, which a
// confined process cannot do, or read all grids of a stream.
class MemoryArchive final : public openvdb::io::Archive {
 public:
  explicit MemoryArchive(std::istream& in) : in_(in) {
    // The stream keeps the address of this pointer, so the pointer is a member.
    openvdb::io::setStreamMetadataPtr(in_, metadata_, /*transfer=*/false);
    readHeader(in_);
    setFormatVersion(in_);
    setLibraryVersion(in_);
    setDataCompression(in_);
  }
  ~MemoryArchive() override { openvdb::io::clearStreamMetadataPtr(in_); }

  bool HasIndex() const { return inputHasGridOffsets(); }

  // Reads the names, types and places of the grids, which follow the file's metadata.
  absl::StatusOr<std::vector<Entry>> Entries() {
    CheckStatedMetadata(in_);
    openvdb::MetaMap().readMeta(in_);
    const int count = readGridCount(in_);
    if (count < 0 || count > kMostGrids) {
      return absl::DataLossError(absl::StrCat("is said to have ", count, " grids, and ", kMostGrids,
                                              " are the most: is it damaged?"));
    }
    std::vector<Entry> entries;
    for (int i = 0; i < count; ++i) {
      CheckStatedEntry(in_);
      Entry& entry = entries.emplace_back();
      entry.grid = entry.descriptor.read(in_);
      entry.descriptor.seekToEnd(in_);
    }
    return entries;
  }

  // Reads metadata, transform and voxels of `entry`. An instance has the voxels of its parent grid.
  void Read(Entry& entry, std::vector<Entry>& entries) {
    ReadOwn(entry);
    if (!entry.descriptor.isInstance()) return;
    for (Entry& parent : entries) {
      if (parent.descriptor.uniqueName() != entry.descriptor.instanceParentName()) continue;
      if (parent.descriptor.gridType() != entry.descriptor.gridType()) {
        throw std::runtime_error("a grid has the voxels of a grid of another type");
      }
      ReadOwn(parent);
      entry.grid->setTree(parent.grid->baseTreePtr());
      return;
    }
  }

 private:
  void ReadOwn(Entry& entry) {
    entry.descriptor.seekToGrid(in_);
    CheckStatedGrid(in_);
    readGrid(entry.grid, entry.descriptor, in_);
  }

  std::istream& in_;
  openvdb::io::StreamMetadata::Ptr metadata_ = std::make_shared<openvdb::io::StreamMetadata>();
};

// Returns the file's grids for a message: "density (float), velocity (vec3s)".
std::string ListOf(const std::vector<Entry>& entries) {
  constexpr std::size_t kMostListed = 20;
  if (entries.empty()) return "the file has no grid";
  std::vector<std::string> names;
  for (const Entry& entry : entries) {
    if (names.size() == kMostListed) {
      names.emplace_back("...");
      break;
    }
    names.push_back(absl::StrCat(entry.Name(), " (", entry.grid->valueType(), ")"));
  }
  return absl::StrCat("the file's grids are: ", absl::StrJoin(names, ", "));
}

absl::StatusOr<Entry*> Find(const std::string& name, std::vector<Entry>& entries) {
  if (name.empty()) {
    return absl::InvalidArgumentError(
        absl::StrCat("give --grid, the name of the grid to import; ", ListOf(entries)));
  }
  const auto found =
      std::ranges::find_if(entries, [&](const Entry& entry) { return entry.Name() == name; });
  if (found != entries.end()) return &*found;
  return absl::InvalidArgumentError(absl::StrCat("has no grid '", name, "'; ", ListOf(entries)));
}

template <typename... Texts>
absl::Status Refused(const Entry& entry, const Texts&... why) {
  return absl::InvalidArgumentError(absl::StrCat("its grid '", entry.Name(), "' ", why...));
}

// Returns the grid, or INVALID_ARGUMENT if its values are not of the type float. The voxels need
// not be read yet.
absl::StatusOr<FloatGrid::Ptr> FloatsOf(const Entry& entry) {
  FloatGrid::Ptr grid = openvdb::gridPtrCast<FloatGrid>(entry.grid);
  if (grid != nullptr) return grid;
  return Refused(entry, "has values of the type ", entry.grid->valueType(),
                 "; a density of the type float is needed");
}

absl::StatusOr<FloatGrid::Ptr> DensityOf(const Entry& entry) {
  THUNDERHEAD_ASSIGN_OR_RETURN(FloatGrid::Ptr grid, FloatsOf(entry));
  if (grid->getGridClass() == openvdb::GRID_LEVEL_SET) {
    return Refused(entry, "is a level set, whose values are distances; convert it to a fog volume");
  }
  if (!grid->transform().isLinear()) {
    return Refused(entry, "has a frustum as its transform; resample it to a regular grid");
  }
  if (grid->background() != 0.0F) {
    return Refused(entry, "has the value ", grid->background(),
                   " outside its voxels, and 0 is needed; is it a density?");
  }
  return grid;
}

// Returns the number of voxels of the box along each axis.
absl::StatusOr<glm::ivec3> SizeOf(const std::string& name, const openvdb::CoordBBox& box) {
  std::array<std::int64_t, 3> size{};
  std::int64_t voxels = 1;
  for (int axis = 0; axis < 3; ++axis) {
    std::int64_t& length = size[static_cast<std::size_t>(axis)];
    length = std::int64_t{box.max()[axis]} - box.min()[axis] + 1;
    voxels = length > kMostVdbVoxels / voxels ? kMostVdbVoxels + 1 : voxels * length;
  }
  if (voxels > kMostVdbVoxels) {
    return absl::InvalidArgumentError(absl::StrCat(
        "the active voxels of its grid '", name, "' lie in a box of ", absl::StrJoin(size, " x "),
        " voxels, and ", kMostVdbVoxels, " are the most; cut or resample it"));
  }
  return glm::ivec3(static_cast<int>(size[0]), static_cast<int>(size[1]),
                    static_cast<int>(size[2]));
}

glm::dvec3 Vector(const openvdb::Vec3d& v) { return {v.x(), v.y(), v.z()}; }

// Writes the active values of a tree into the array of a volume.
class Filling {
 public:
  Filling(const openvdb::Coord& first, VdbVolume& volume) : first_(first), volume_(volume) {}

  // Fills a box of voxels that have one value.
  void Box(const openvdb::CoordBBox& box, float value) {
    for (int k = box.min().z(); k <= box.max().z(); ++k) {
      for (int j = box.min().y(); j <= box.max().y(); ++j) {
        float* const row = At(openvdb::Coord(box.min().x(), j, k));
        std::fill(row, row + (box.max().x() - box.min().x() + 1), value);
      }
    }
  }

  void Leaf(const FloatGrid::TreeType::LeafNodeType& leaf) {
    for (auto voxel = leaf.cbeginValueOn(); voxel; ++voxel) *At(voxel.getCoord()) = *voxel;
  }

 private:
  float* At(const openvdb::Coord& at) {
    const openvdb::Coord place = at - first_;
    return volume_.values.data() +
           (static_cast<std::size_t>(place.z()) * static_cast<std::size_t>(volume_.voxels.y) +
            static_cast<std::size_t>(place.y())) *
               static_cast<std::size_t>(volume_.voxels.x) +
           static_cast<std::size_t>(place.x());
  }

  const openvdb::Coord first_;
  VdbVolume& volume_;
};

// Returns the number of voxels in a box. A box of OpenVDB may have up to 2^96.
double VoxelsOf(const openvdb::CoordBBox& box) {
  return static_cast<double>(box.dim().x()) * box.dim().y() * box.dim().z();
}

// Writes the active values of `grid` by `filling` into an array of `voxels` voxels. Throws
// std::runtime_error if blocks of equal voxels overlap.
void Fill(const FloatGrid& grid, double voxels, const std::function<void(double)>& progress,
          Filling filling) {
  double filled = 0.0;
  auto tile = grid.tree().cbeginValueOn();
  tile.setMaxDepth(FloatGrid::TreeType::ValueOnCIter::LEAF_DEPTH - 1);
  for (; tile; ++tile) {
    openvdb::CoordBBox box;
    tile.getBoundingBox(box);
    // Blocks of a damaged file may overlap, so that a small file would take hours to fill.
    filled += VoxelsOf(box);
    if (filled > voxels) throw std::runtime_error("its blocks of equal voxels overlap");
    filling.Box(box, *tile);
  }
  const auto leaves = static_cast<double>(grid.tree().leafCount());
  constexpr int kLeavesPerReport = 1 << 16;
  std::int64_t count = 0;
  for (auto leaf = grid.tree().cbeginLeaf(); leaf; ++leaf, ++count) {
    filling.Leaf(*leaf);
    if (!progress || count % kLeavesPerReport != 0) continue;
    progress(kShareOfReading + (1.0 - kShareOfReading) * static_cast<double>(count) / leaves);
  }
}

absl::StatusOr<VdbVolume> DenseOf(const std::string& name, const FloatGrid& grid,
                                  const std::function<void(double)>& progress) {
  VdbVolume volume;
  volume.grid = name;
  openvdb::CoordBBox box;
  if (!grid.tree().evalActiveVoxelBoundingBox(box)) {
    return absl::InvalidArgumentError(
        absl::StrCat("its grid '", name, "' has no active voxel; give another"));
  }
  THUNDERHEAD_ASSIGN_OR_RETURN(volume.voxels, SizeOf(name, box));
  const openvdb::math::Transform& transform = grid.transform();
  const openvdb::Vec3d first = transform.indexToWorld(box.min());
  volume.first = Vector(first);
  for (int axis = 0; axis < 3; ++axis) {
    openvdb::Vec3d index = box.min().asVec3d();
    index[axis] += 1.0;
    volume.steps[static_cast<std::size_t>(axis)] = Vector(transform.indexToWorld(index) - first);
  }
  volume.values.assign(volume.VoxelCount(), 0.0F);
  Fill(grid, static_cast<double>(volume.VoxelCount()), progress, Filling(box.min(), volume));
  return volume;
}

absl::StatusOr<VdbVolume> Read(std::span<const std::byte> bytes, const std::string& name,
                               const std::function<void(double)>& progress) {
  MemoryBuffer buffer(bytes, [&progress](double share) {
    if (progress) progress(kShareOfReading * share);
  });
  std::istream in(&buffer);
  // The stream throws an exception if a read fails, because OpenVDB does not check that.
  in.exceptions(std::ios::badbit | std::ios::failbit | std::ios::eofbit);
  MemoryArchive archive(in);
  if (archive.fileVersion() < kFirstFormat) {
    return absl::InvalidArgumentError(
        absl::StrCat("has the OpenVDB file format ", archive.fileVersion(), ", and ", kFirstFormat,
                     " is the oldest that can be read; write it again with a newer OpenVDB"));
  }
  if (!archive.HasIndex()) {
    return absl::InvalidArgumentError(
        "was written as a stream, without an index of its grids; write it as a file");
  }
  THUNDERHEAD_ASSIGN_OR_RETURN(std::vector<Entry> entries, archive.Entries());
  THUNDERHEAD_ASSIGN_OR_RETURN(Entry* const entry, Find(name, entries));
  THUNDERHEAD_RETURN_IF_ERROR(FloatsOf(*entry).status());
  archive.Read(*entry, entries);
  THUNDERHEAD_ASSIGN_OR_RETURN(const FloatGrid::Ptr grid, DensityOf(*entry));
  return DenseOf(name, *grid, progress);
}

absl::Status TooLarge(const std::string& path) {
  return absl::ResourceExhaustedError(absl::StrCat(
      path, ": the sizes that it states need more memory than its limit, so it is very large or ",
      "damaged; write it again, or cut or resample its grid"));
}

}  // namespace

void PrepareVdb() {
  openvdb::initialize();
  // Metadata of this type serve to read the voxels of a file later, piece by piece. Their parser
  // trusts sizes that the file states. When the type is not registered, OpenVDB skips such
  // metadata.
  openvdb::io::DelayedLoadMetadata::unregisterType();
}

absl::StatusOr<VdbVolume> ReadVdbGrid(const std::string& path, std::span<const std::byte> bytes,
                                      const std::string& grid,
                                      const std::function<void(double share)>& progress) {
  try {
    absl::StatusOr<VdbVolume> volume = Read(bytes, grid, progress);
    if (!volume.ok()) return base::Annotate(volume.status(), path);
    return volume;
  } catch (const std::bad_alloc&) {
    return TooLarge(path);
  } catch (const std::length_error&) {  // a container larger than any memory
    return TooLarge(path);
  } catch (const std::exception& error) {
    return absl::DataLossError(absl::StrCat(path,
                                            ": is damaged, or is not an OpenVDB file of version ",
                                            "10 or before (", error.what(), "); write it again"));
  }
}

}  // namespace thunderhead::interchange

#include "interchange/storm_export.h"

#include <algorithm>
#include <map>
#include <optional>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_join.h"
#include "base/status.h"
#include "base/version.h"
#include "glm/common.hpp"
#include "physics/optics.h"
#include "physics/turbulence.h"
#include "scene/drawn_fields.h"
#include "scene/view.h"

namespace thunderhead::interchange {
namespace {

using Fields = std::shared_ptr<const volume::HydrometeorFields>;
using Tile = std::shared_ptr<const physics::TurbulenceTile>;

// One field's extinction (1/m) at cells, and between them.
class FieldExtinction {
 public:
  FieldExtinction(Fields fields, const scene::DrawnField& drawn)
      : fields_(std::move(fields)), drawn_(drawn) {}

  // Of `count` cells of a row from cell `first` on.
  void Row(const glm::ivec3& first, int count, float* values) const {
    std::fill_n(values, count, 0.0F);
    volume::AddExtinction(fields_->fields[drawn_.index], drawn_.mass_extinction,
                          fields_->grid.Offset(first.x, first.y, first.z),
                          static_cast<std::size_t>(count), values);
  }

  const volume::RegularGrid& Grid() const { return fields_->grid; }

  float Largest() const {
    float largest = 0.0F;
    std::vector<float> row(static_cast<std::size_t>(Grid().cells.x));
    for (int z = 0; z < Grid().cells.z; ++z) {
      for (int y = 0; y < Grid().cells.y; ++y) {
        Row({0, y, z}, Grid().cells.x, row.data());
        largest = std::max(largest, *std::max_element(row.begin(), row.end()));
      }
    }
    return largest;
  }

 private:
  Fields fields_;
  scene::DrawnField drawn_;
};

// The cells of a block of voxels.
bool FillFromCells(const FieldExtinction& extinction, const glm::ivec3& first, VdbBlock& values) {
  const glm::ivec3 count = glm::min(extinction.Grid().cells - first, glm::ivec3(kVdbBlockCells));
  for (int z = 0; z < count.z; ++z) {
    for (int y = 0; y < count.y; ++y) {
      float* row = values.data() + (z * kVdbBlockCells + y) * kVdbBlockCells;
      extinction.Row(first + glm::ivec3(0, y, z), count.x, row);
    }
  }
  return std::any_of(values.begin(), values.end(), [](float value) { return value > 0.0F; });
}

// Cells that a block of finer voxels reads, with those around it; beyond the grid the nearest.
constexpr int kNearCells = kVdbBlockCells / kDetailVoxelsPerCell + 2;
static_assert(kVdbBlockCells % kDetailVoxelsPerCell == 0);

class NearCells {
 public:
  // `first` is the first cell inside the block.
  NearCells(const FieldExtinction& extinction, const glm::ivec3& first) {
    const glm::ivec3 last = extinction.Grid().cells - 1;
    for (int z = 0; z < kNearCells; ++z) {
      for (int y = 0; y < kNearCells; ++y) {
        for (int x = 0; x < kNearCells; ++x) {
          const glm::ivec3 cell = first + glm::ivec3(x - 1, y - 1, z - 1);
          extinction.Row(glm::clamp(cell, glm::ivec3(0), last), 1, &At(x, y, z));
        }
      }
    }
  }

  bool Empty() const {
    return std::all_of(values_.begin(), values_.end(), [](float value) { return value <= 0.0F; });
  }

  // At the middle of voxel `voxel` of the block, linear between centres.
  float Between(const glm::ivec3& voxel) {
    const glm::vec3 place =
        (glm::vec3(voxel) + 0.5F) / static_cast<float>(kDetailVoxelsPerCell) + 0.5F;
    const glm::vec3 low = glm::floor(place);
    const glm::vec3 share = place - low;
    const glm::ivec3 at(low);
    float sum = 0.0F;
    for (int corner = 0; corner < 8; ++corner) {
      const glm::ivec3 step(corner & 1, (corner >> 1) & 1, corner >> 2);
      const glm::vec3 weight = glm::mix(1.0F - share, share, glm::vec3(step));
      sum += weight.x * weight.y * weight.z * At(at.x + step.x, at.y + step.y, at.z + step.z);
    }
    return sum;
  }

 private:
  float& At(int x, int y, int z) {
    return values_[static_cast<std::size_t>((z * kNearCells + y) * kNearCells + x)];
  }

  std::array<float, std::size_t{kNearCells} * kNearCells * kNearCells> values_{};
};

// A field's noise at places of the world; one tile serves all fields with the same octaves and
// seed.
struct Noise {
  Tile tile;  // null: none
  scene::Detail detail;

  float At(const glm::dvec3& place_m) const {
    if (tile == nullptr) return 1.0F;
    const double tile_m =
        static_cast<double>(detail.wavelength_m) * physics::TurbulenceTile::kWaves;
    const auto noise = static_cast<float>(physics::TurbulenceAt(*tile, place_m / tile_m));
    return 1.0F + detail.share * (noise - 1.0F);
  }

  float Largest() const {
    return tile == nullptr ? 1.0F : 1.0F + detail.share * (tile->value_of_full - 1.0F);
  }
};

bool FillWithDetail(const FieldExtinction& extinction, const Noise& noise,
                    const volume::RegularGrid& grid, const glm::ivec3& first, VdbBlock& values) {
  NearCells cells(extinction, first / kDetailVoxelsPerCell);
  if (cells.Empty()) return false;
  std::size_t i = 0;
  for (int z = 0; z < kVdbBlockCells; ++z) {
    for (int y = 0; y < kVdbBlockCells; ++y) {
      for (int x = 0; x < kVdbBlockCells; ++x, ++i) {
        const glm::ivec3 voxel(x, y, z);
        values[i] = cells.Between(voxel);
        if (values[i] <= 0.0F) continue;
        values[i] *=
            noise.At(grid.low_corner_m + (glm::dvec3(first + voxel) + 0.5) * grid.spacing_m);
      }
    }
  }
  return true;
}

volume::RegularGrid FinerGrid(volume::RegularGrid grid) {
  grid.cells *= kDetailVoxelsPerCell;
  grid.spacing_m /= kDetailVoxelsPerCell;
  return grid;
}

VdbMetadata OpticsOf(const scene::DrawnField& drawn, const scene::Scene& scene,
                     const volume::HydrometeorField& field) {
  VdbMetadata metadata{{"quantity", "extinction"},
                       {"units", "1/m"},
                       {"albedo", static_cast<double>(drawn.albedo)},
                       {"asymmetry", physics::MeanCosine(drawn.phase)},
                       {"source_variable", field.variable}};
  if (field.quantity != volume::Quantity::kExtinction) {
    const scene::FieldParameters& look = scene.fields[physics::IndexOf(drawn.hydrometeor)];
    metadata["effective_radius_m"] =
        static_cast<double>(volume::WithDrawnRadius(field, look.optics, look.sizes).radius_m);
  }
  return metadata;
}

VdbMetadata OriginOf(const scene::Scene& scene, const volume::StormInfo& storm,
                     const ExportOptions& options) {
  const volume::StormTime& time = storm.times[static_cast<std::size_t>(scene.time_index)];
  VdbMetadata metadata{{"creator", absl::StrCat("thunderhead ", base::Version())},
                       {"title", storm.title},
                       {"source_files", absl::StrJoin(storm.files, "\n")},
                       {"time_index", std::int64_t{scene.time_index}},
                       {"valid_time", time.valid_time},
                       {"elapsed_s", time.elapsed_s},
                       {"turbulent_detail", std::int64_t{options.detail ? 1 : 0}},
                       {"world_coordinates",
                        "metres: x east and y north of the domain's middle, z up from sea level"}};
  if (storm.latitude_deg.has_value() && storm.longitude_deg.has_value()) {
    metadata["origin_latitude_deg"] = *storm.latitude_deg;
    metadata["origin_longitude_deg"] = *storm.longitude_deg;
  }
  return metadata;
}

// Tiles of turbulence, each made once.
class Tiles {
 public:
  Noise NoiseOf(const scene::Detail& detail) {
    if (detail.share <= 0.0F) return {};
    Tile& tile = tiles_[{detail.octaves, detail.seed}];
    if (tile == nullptr) {
      tile = std::make_shared<const physics::TurbulenceTile>(
          physics::MakeTurbulence(detail.octaves, detail.seed));
    }
    return {tile, detail};
  }

 private:
  std::map<std::pair<int, std::uint32_t>, Tile> tiles_;
};

std::string Vector(const glm::dvec3& v) {
  return absl::StrFormat("[%.17g, %.17g, %.17g]", v.x, v.y, v.z);
}

absl::Status CheckLargest(const std::string& name, float extinction_per_m) {
  if (extinction_per_m <= kLargestVdbValue) return absl::OkStatus();
  return absl::InvalidArgumentError(absl::StrCat(
      "the extinction of ", name, " reaches ", extinction_per_m, " 1/m, and a half float holds ",
      kLargestVdbValue, " at most; scale the field down in the scene"));
}

double Number(const VdbGrid& grid, const std::string& name) {
  return std::get<double>(grid.metadata.at(name));
}

}  // namespace

absl::StatusOr<VdbFile> ExportOf(const scene::Scene& scene, Fields fields,
                                 const volume::StormInfo& storm, const ExportOptions& options) {
  // The fields as a technique shows them that leaves nothing out.
  scene::Scene shown = scene;
  shown.rendering.technique = scene::LightVolume{};
  VdbFile file;
  file.metadata = OriginOf(scene, storm, options);
  Tiles tiles;
  for (const scene::DrawnField& drawn : scene::DrawnFieldsOf(shown, *fields)) {
    const FieldExtinction extinction(fields, drawn);
    const Noise noise = options.detail ? tiles.NoiseOf(drawn.detail) : Noise{};
    VdbGrid grid;
    grid.name = std::string(physics::NameOf(drawn.hydrometeor));
    THUNDERHEAD_RETURN_IF_ERROR(CheckLargest(grid.name, extinction.Largest() * noise.Largest()));
    grid.metadata = OpticsOf(drawn, shown, fields->fields[drawn.index]);
    if (options.detail) {
      grid.grid = FinerGrid(fields->grid);
      grid.fill = [extinction, noise, finer = grid.grid](const glm::ivec3& first,
                                                         VdbBlock& values) {
        return FillWithDetail(extinction, noise, finer, first, values);
      };
    } else {
      grid.grid = fields->grid;
      grid.fill = [extinction](const glm::ivec3& first, VdbBlock& values) {
        return FillFromCells(extinction, first, values);
      };
    }
    file.grids.push_back(std::move(grid));
  }
  return file;
}

std::string ViewJson(const scene::Scene& scene, const volume::HydrometeorFields& fields,
                     const VdbFile& file) {
  const scene::View view = scene::ViewOf(scene, fields);
  std::string json = absl::StrFormat(
      "{\n  \"camera\": {\"eyeM\": %s, \"right\": %s, \"up\": %s, \"forward\": %s,\n"
      "             \"tanHalfWidth\": %.17g, \"tanHalfHeight\": %.17g,\n"
      "             \"halfWidthM\": %.17g, \"halfHeightM\": %.17g},\n"
      "  \"sun\": {\"towards\": %s, \"irradiance\": %.17g},\n"
      "  \"image\": {\"widthPx\": %d, \"heightPx\": %d},\n  \"grids\": [",
      Vector(view.eye_m), Vector(view.right), Vector(view.up), Vector(view.forward),
      view.tan_half_width, view.tan_half_height, view.half_width_m, view.half_height_m,
      Vector(scene::Direction(scene.sun.azimuth_deg, scene.sun.elevation_deg)),
      scene.sun.irradiance, scene.output.width_px, scene.output.height_px);
  const char* separator = "";
  for (const VdbGrid& grid : file.grids) {
    absl::StrAppendFormat(&json,
                          "%s\n    {\"name\": \"%s\", \"albedo\": %.9g, \"asymmetry\": %.9g, "
                          "\"voxelM\": %s}",
                          separator, grid.name, Number(grid, "albedo"), Number(grid, "asymmetry"),
                          Vector(grid.grid.spacing_m));
    separator = ",";
  }
  return json + "\n  ]\n}\n";
}

}  // namespace thunderhead::interchange

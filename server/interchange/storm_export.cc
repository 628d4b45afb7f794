#include "interchange/storm_export.h"

#include <algorithm>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_join.h"
#include "base/status.h"
#include "base/version.h"
#include "glm/common.hpp"
#include "physics/optics.h"
#include "scene/detailed_medium.h"
#include "scene/drawn_fields.h"
#include "scene/view.h"

namespace thunderhead::interchange {
namespace {

using Fields = std::shared_ptr<const volume::HydrometeorFields>;

// The extinction (1/m) of one field at the grid's cells.
class FieldExtinction {
 public:
  FieldExtinction(Fields fields, const scene::DrawnField& drawn)
      : fields_(std::move(fields)), drawn_(drawn) {}

  // Computes the extinction of `count` cells of a row, beginning at cell `first`.
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

// Fills a block of voxels with the cells' values. Returns false if all are zero.
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

bool FillWithDetail(const scene::DetailedMedium& medium, std::size_t field,
                    const volume::RegularGrid& grid, const glm::ivec3& first, VdbBlock& values) {
  const glm::ivec3 count = glm::min(grid.cells - first, glm::ivec3(kVdbBlockCells));
  bool any = false;
  for (int z = 0; z < count.z; ++z) {
    for (int y = 0; y < count.y; ++y) {
      for (int x = 0; x < count.x; ++x) {
        const glm::dvec3 voxel = glm::dvec3(first + glm::ivec3(x, y, z)) + 0.5;
        const float value = medium.At_per_m(grid.low_corner_m + voxel * grid.spacing_m)[field];
        values[static_cast<std::size_t>((z * kVdbBlockCells + y) * kVdbBlockCells + x)] = value;
        any = any || value > 0.0F;
      }
    }
  }
  return any;
}

volume::RegularGrid FinerGrid(volume::RegularGrid grid) {
  grid.cells *= kDetailVoxelsPerCell;
  grid.spacing_m /= kDetailVoxelsPerCell;
  return grid;
}

std::string SourceOfSizes(const scene::DrawnField& drawn) {
  switch (drawn.sizes) {
    case physics::SizeSource::kPapers:
      return "papers";
    case physics::SizeSource::kGiven:
      return "scene";
    case physics::SizeSource::kModel:
      break;
  }
  return drawn.mass_extinction.by_cell ? "model" : "default";
}

VdbMetadata OpticsOf(const scene::DrawnField& drawn, const volume::HydrometeorField& field) {
  VdbMetadata metadata{{"quantity", "extinction"},
                       {"units", "1/m"},
                       {"albedo", static_cast<double>(drawn.albedo)},
                       {"asymmetry", physics::MeanCosine(drawn.phase)},
                       {"source_variable", field.variable}};
  if (drawn.radius_m.has_value()) {
    metadata["effective_radius_m"] = static_cast<double>(*drawn.radius_m);
    metadata["effective_radius_source"] = SourceOfSizes(drawn);
  }
  return metadata;
}

VdbMetadata OriginOf(const scene::Scene& scene, const storm_store::StormInfo& storm,
                     const ExportOptions& options) {
  const storm_store::StormTime& time = storm.times[static_cast<std::size_t>(scene.time_index)];
  VdbMetadata metadata{{"creator", absl::StrCat("thunderhead ", base::Version())},
                       {"title", storm.title},
                       {"source_files", absl::StrJoin(storm.files, "\n")},
                       {"time_index", std::int64_t{scene.time_index}},
                       {"valid_time", time.valid_time},
                       {"elapsed_s", time.elapsed_s},
                       {"turbulent_detail", std::int64_t{options.detail ? 1 : 0}},
                       {"world_coordinates",
                        "metres: x east and y north of the domain's middle along its grid's axes, "
                        "z up from sea level"}};
  const auto time_index = static_cast<std::size_t>(scene.time_index);
  const auto middle = storm_store::MiddleOf(storm, time_index);
  if (middle.has_value()) {
    metadata["origin_latitude_deg"] = middle->latitude_deg;
    metadata["origin_longitude_deg"] = middle->longitude_deg;
  }
  if (const std::string& projection = storm_store::ProjectionTextOf(storm, time_index);
      !projection.empty()) {
    metadata["projection"] = projection;
    metadata["true_north_deg"] = storm_store::TrueNorthOf_deg(storm, time_index);
  }
  return metadata;
}

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

absl::StatusOr<VdbFile> ExportOf(const scene::Scene& scene, const Fields& fields,
                                 const storm_store::StormInfo& storm,
                                 const ExportOptions& options) {
  // The fields are exported as the light volume shows them, because that technique leaves no field
  // out.
  scene::Scene shown = scene;
  shown.rendering.technique = scene::LightVolume{};
  VdbFile file;
  file.metadata = OriginOf(scene, storm, options);
  const std::shared_ptr<const scene::DetailedMedium> detailed =
      options.detail ? scene::DetailedMedium::Of(shown, *fields) : nullptr;
  const std::vector<scene::DrawnField> drawn_fields = scene::DrawnFieldsOf(shown, *fields);
  for (std::size_t i = 0; i < drawn_fields.size(); ++i) {
    const scene::DrawnField& drawn = drawn_fields[i];
    const FieldExtinction extinction(fields, drawn);
    VdbGrid grid;
    grid.name = std::string(physics::NameOf(drawn.hydrometeor));
    THUNDERHEAD_RETURN_IF_ERROR(CheckLargest(
        grid.name, detailed == nullptr ? extinction.Largest() : detailed->Largest_per_m()[i]));
    grid.metadata = OpticsOf(drawn, fields->fields[drawn.index]);
    if (detailed != nullptr) {
      grid.grid = FinerGrid(fields->grid);
      grid.fill = [detailed, i, finer = grid.grid](const glm::ivec3& first, VdbBlock& values) {
        return FillWithDetail(*detailed, i, finer, first, values);
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

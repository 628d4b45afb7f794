// Exports a storm for other programs. Each visible field becomes an OpenVDB grid of its extinction.
// The scene's camera, sun and optical properties become JSON. This code uses neither GL nor
// messages.
#pragma once

#include <memory>
#include <string>

#include "absl/status/statusor.h"
#include "interchange/vdb_file.h"
#include "scene/scene.h"
#include "storm_store/storm_store.h"
#include "volume/hydrometeor_fields.h"

namespace thunderhead::interchange {

// Number of voxels along the edge of a storm cell if detail is added. The default detail's finest
// octave has a wavelength of 3/8 of a cell. It is then sampled 1.5 times per wavelength, and loses
// only its sharpest creases.
inline constexpr int kDetailVoxelsPerCell = 4;

struct ExportOptions {
  // If false, each voxel is a cell of the storm's grid, so that each column keeps its water path.
  // If true, there are kDetailVoxelsPerCell voxels along each cell edge, with the detailed medium
  // that the light volume draws (scene/detailed_medium.h). Then each group of fields
  // (scene/field_groups.h) keeps its water path within 1 %, and each column as described in
  // volume/water_paths.h.
  bool detail = false;
};

// Returns an OpenVDB file of `storm`'s fields at the time of `scene`. For each visible field it has
// a grid of the extinction (1/m) that the light volume draws. The grids are named "cloud", "rain"
// and so on, and have background 0. A grid's metadata are quantity, units, albedo, asymmetry (the
// phase function's mean cosine), source_variable, and effective_radius_m and its source if the
// field has one. The file's metadata are its subject, time and place. The result keeps `fields`
// alive. Returns INVALID_ARGUMENT if an extinction is too large for a half float.
absl::StatusOr<VdbFile> ExportOf(const scene::Scene& scene,
                                 const std::shared_ptr<const volume::HydrometeorFields>& fields,
                                 const storm_store::StormInfo& storm, const ExportOptions& options);

// Returns as JSON what another program needs to show the grids of `file`: the scene's view
// (scene/view.h), sun and picture size. It also has the albedo and asymmetry of each grid.
// Coordinates are world metres.
std::string ViewJson(const scene::Scene& scene, const volume::HydrometeorFields& fields,
                     const VdbFile& file);

}  // namespace thunderhead::interchange

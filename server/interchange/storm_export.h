// Exports a storm for other programs. Each field that a scene draws becomes a grid of its
// extinction. The scene's view (camera, sun, optics) becomes JSON. Knows no GL and no messages.
#pragma once

#include <memory>
#include <string>

#include "absl/status/statusor.h"
#include "interchange/vdb_file.h"
#include "scene/scene.h"
#include "storm_store/storm_store.h"
#include "volume/hydrometeor_fields.h"

namespace thunderhead::interchange {

// Number of voxels along a cell's edge if detail is added. The default's finest octave, 3/8 of a
// cell, is then sampled 1.5 times per wavelength and loses only its sharpest creases.
inline constexpr int kDetailVoxelsPerCell = 4;

struct ExportOptions {
  // If false, a voxel is a cell of the storm's grid, so that each column keeps its water path. If
  // true, each cell edge has kDetailVoxelsPerCell voxels with the medium that the light volume
  // draws (scene/detailed_medium.h). Then each group of fields keeps its water path within 1 %, and
  // columns as described in volume/water_paths.h.
  bool detail = false;
};

// Returns the file of `storm`'s fields at the time of `scene`. For each visible field it has the
// extinction (1/m) that the light volume draws, named "cloud", "rain" and so on, with background 0.
// A grid's metadata are quantity, units, albedo, asymmetry (the phase function's mean cosine) and,
// if the field has one, effective_radius_m and its source. The file's metadata are its subject,
// time and place. Keeps `fields` alive. INVALID_ARGUMENT if an extinction is too large for a half
// float.
absl::StatusOr<VdbFile> ExportOf(const scene::Scene& scene,
                                 const std::shared_ptr<const volume::HydrometeorFields>& fields,
                                 const storm_store::StormInfo& storm, const ExportOptions& options);

// Returns the scene's settings for showing the grids of `file` in another program, as JSON. They
// are the view as in scene/view.h, the sun, the picture's size, and albedo and asymmetry of each
// grid, in world metres.
std::string ViewJson(const scene::Scene& scene, const volume::HydrometeorFields& fields,
                     const VdbFile& file);

}  // namespace thunderhead::interchange

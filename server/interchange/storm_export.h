// A storm as other programs read it: for each field that a scene draws a grid of its extinction,
// and the scene's view of it (camera, sun, optics) as JSON. Knows no GL and no messages.
#pragma once

#include <memory>
#include <string>

#include "absl/status/statusor.h"
#include "interchange/vdb_file.h"
#include "scene/scene.h"
#include "storm_store/storm_store.h"
#include "volume/hydrometeor_fields.h"

namespace thunderhead::interchange {

// Voxels along an edge of a cell where detail is added: the default's finest octave, 3/8 of a cell,
// is sampled 1.5 times a wavelength, and what it loses there is its sharpest creases.
inline constexpr int kDetailVoxelsPerCell = 4;

struct ExportOptions {
  // False: a voxel is a cell of the storm's grid, so that every column keeps its water path. True:
  // kDetailVoxelsPerCell along each of its edges, and the medium there is the one that the light
  // volume draws (scene/detailed_medium.h): each group of fields keeps its water path within 1 %,
  // columns as in volume/water_paths.h.
  bool detail = false;
};

// The file of `storm`'s fields at the time of `scene`: for each visible field extinction (1/m) as
// the light volume draws it, named "cloud", "rain" and so on; background 0. Metadata of a grid:
// quantity, units, albedo, asymmetry (the phase function's mean cosine) and, for a field that has
// one, effective_radius_m and its source. Of the file: what it is of, when and where. Keeps
// `fields` alive. INVALID_ARGUMENT if an extinction is too large for a half float.
absl::StatusOr<VdbFile> ExportOf(const scene::Scene& scene,
                                 const std::shared_ptr<const volume::HydrometeorFields>& fields,
                                 const storm_store::StormInfo& storm, const ExportOptions& options);

// The scene's settings for showing the grids of `file` in another program, as JSON: the view as in
// scene/view.h, the sun, the picture's size, and albedo and asymmetry of each grid. World metres.
std::string ViewJson(const scene::Scene& scene, const volume::HydrometeorFields& fields,
                     const VdbFile& file);

}  // namespace thunderhead::interchange

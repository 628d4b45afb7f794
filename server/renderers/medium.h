// The part of a storm that a scene draws, on the device: each group of its fields is a channel of
// the extinction textures. Shared by every renderer.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "gl/objects.h"
#include "gl/program.h"
#include "glm/mat3x3.hpp"
#include "physics/hydrometeors.h"
#include "renderers/cover.h"
#include "renderers/detail_noises.h"
#include "renderers/phase_curves.h"
#include "scene/field_groups.h"
#include "scene/scene.h"
#include "scene/view.h"
#include "volume/extinction.h"
#include "volume/hydrometeor_fields.h"
#include "volume/water_paths.h"

namespace thunderhead::renderers {

using MediumGroup = scene::FieldGroup;
using Medium = scene::GroupedFields;

// One noise on the device, and how much of each group it multiplies.
struct DetailLayer : scene::DetailLayer {
  std::shared_ptr<const DetailNoise> noise;
  glm::dvec2 drift_m{0.0};  // Drift_m of the storm's motion
};

// The variant of common/medium.glsl.
struct MediumVariant {
  gl::DefineValue groups;
  gl::DefineValue details;  // noises to be fetched

  gl::Defines Defines() const { return {{"GROUPS", groups}, {"DETAILS", details}}; }
};

// A medium with its extinction on the device.
class ResidentMedium {
 public:
  // Wall time of making it, in milliseconds.
  struct Cost {
    double extinction_ms = 0.0;
    double upload_ms = 0.0;
  };

  ResidentMedium() = default;
  ResidentMedium(const scene::Scene& scene, const volume::HydrometeorFields& fields,
                 DetailNoises* noises, Cost* cost,
                 volume::WaterPathEffort effort = volume::WaterPathEffort::kFull);

  bool Empty() const { return bounds_.Empty(); }
  // Differs from that of any other medium of this process; 0 has no content.
  std::uint64_t Id() const { return id_; }
  const Medium& Content() const { return content_; }
  // With more effort water paths would be kept better.
  bool HasQuickWaterPaths() const { return has_quick_water_paths_; }
  // The volume's place and scale; its texels are on the device only.
  const volume::ExtinctionVolume& Bounds() const { return bounds_; }
  glm::dvec3 Middle_m() const { return (bounds_.low_m + bounds_.high_m) / 2.0; }
  glm::dvec3 HalfExtent_m() const { return (bounds_.high_m - bounds_.low_m) / 2.0; }

  MediumVariant Variant() const {
    return {.groups = static_cast<int>(content_.groups.size()),
            .details = static_cast<int>(details_.size())};
  }

  // Binds the textures and sets the uniforms of common/medium.glsl, and binds the texture of
  // common/phase.glsl. Local coordinates are metres from Middle_m().
  void Bind(const gl::Program& program) const;
  // The same, and those of common/bricks.glsl.
  void BindWithBricks(const gl::Program& program) const;
  // Without the medium's own textures: those of common/medium_box.glsl, and the rest of
  // common/bricks.glsl.
  void BindBox(const gl::Program& program) const;
  void BindBricks(const gl::Program& program) const;
  // After the first or second: detail that is finer than a pixel of a picture of that size fades
  // out. By default what is finer than cells does, as light needs it.
  void BindPixel(const gl::Program& program, const scene::View& view,
                 const glm::ivec2& size_px) const;
  std::size_t Bytes() const;
  // Share of the box that is in bricks that are not empty, 0 to 1.
  double OccupiedShare() const;
  double ShortestBrickSide_m() const;
  // The blocks of cells that a ray may meet (volume::CellBlocks): how many, and their list, bound
  // for light_volume/cell_blocks.glsl.
  int BlockCount() const { return block_count_; }
  void BindBlocks(const gl::Program& program) const;

  // Boxes around the occupied bricks; few, so that going through them costs a picture nothing.
  const Boxes& OccupiedBoxes() const { return occupied_boxes_; }

  // One weight a group as common/medium.glsl takes it: the value at which a texel counts, times the
  // extinction of a texel value of 1.
  std::vector<glm::vec4> Weights(const std::vector<double>& by_group) const;

 private:
  // The width that a sample stands for: at a distance of 0, and what a metre of distance adds.
  struct Footprint {
    double at_start_m;
    double per_m;
  };

  void BindDetails(const gl::Program& program) const;
  void BindNoises(const gl::Program& program, const Footprint& footprint, double nearest_m) const;

  std::uint64_t id_ = 0;
  bool has_quick_water_paths_ = false;
  Medium content_;
  volume::ExtinctionVolume bounds_;
  std::vector<gl::Texture3D> textures_;
  gl::Texture3D bricks_;
  glm::dvec3 brick_m_{0.0};
  glm::dvec3 bricks_low_m_{0.0};  // where the first begins
  int occupied_count_ = 0;
  gl::Buffer blocks_;
  glm::ivec3 cells_per_block_{1};
  int block_count_ = 0;
  Boxes occupied_boxes_;
  std::vector<DetailLayer> details_;
  gl::Texture3D detail_control_;  // volume::DetailControlOf
  glm::mat3 detail_fibres_{1.0F};
  PhaseCurves phase_curves_;
};

}  // namespace thunderhead::renderers

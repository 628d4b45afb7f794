// The part of a storm that a scene draws, on the device. Each group of its fields
// (scene/field_groups.h) is a channel of the extinction textures. All renderers of a medium use
// this class.
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

// One noise texture on the device with, for each group, the share of the extinction that the noise
// multiplies.
struct DetailLayer : scene::DetailLayer {
  std::shared_ptr<const DetailNoise> noise;
  glm::dvec2 drift_m{0.0};  // displacement by the wind, from Drift_m
};

// Shader variant of common/medium.glsl.
struct MediumVariant {
  gl::DefineValue groups;
  gl::DefineValue details;  // number of noises to fetch

  gl::Defines Defines() const { return {{"GROUPS", groups}, {"DETAILS", details}}; }
};

// A medium whose extinction textures are on the device.
class ResidentMedium {
 public:
  // Wall time of creating the medium, in milliseconds.
  struct Cost {
    double extinction_ms = 0.0;
    double upload_ms = 0.0;
  };

  ResidentMedium() = default;
  ResidentMedium(const scene::Scene& scene, const volume::HydrometeorFields& fields,
                 DetailNoises* noises, Cost* cost,
                 volume::WaterPathEffort effort = volume::WaterPathEffort::kFull);

  bool Empty() const { return bounds_.Empty(); }
  // Returns a number that differs from that of any other medium of this process. It is 0 for a
  // medium without content.
  std::uint64_t Id() const { return id_; }
  const Medium& Content() const { return content_; }
  // Returns true if the medium was created with less than full WaterPathEffort, so that a new
  // medium would preserve the columns' water paths (the water in each column) better.
  bool HasQuickWaterPaths() const { return has_quick_water_paths_; }
  // Returns the place and scale of the extinction volume. Its texels are only on the device.
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
  // Does the same as Bind, and sets the uniforms and textures of common/bricks.glsl.
  void BindWithBricks(const gl::Program& program) const;
  // Set parts of what BindWithBricks sets, for programs that do not read the extinction textures.
  // BindBox sets the uniforms of common/medium_box.glsl. BindBricks sets the texture and the other
  // uniforms of common/bricks.glsl.
  void BindBox(const gl::Program& program) const;
  void BindBricks(const gl::Program& program) const;
  // Fades out detail that is finer than a pixel of a picture of `size_px`. Call it after Bind or
  // BindWithBricks. Those functions fade out detail finer than cells, which suits light that is
  // stored by cell.
  void BindPixel(const gl::Program& program, const scene::View& view,
                 const glm::ivec2& size_px) const;
  std::size_t Bytes() const;
  // Returns the share of the box that is in non-empty bricks, 0 to 1.
  double OccupiedShare() const;
  double ShortestBrickSide_m() const;
  // Return the number of cell blocks that a ray may meet (volume::CellBlocks), and bind their list
  // for light_volume/cell_blocks.glsl.
  int BlockCount() const { return block_count_; }
  void BindBlocks(const gl::Program& program) const;

  // Returns boxes around the occupied bricks. There are few of them, so iterating over them takes
  // negligible time.
  const Boxes& OccupiedBoxes() const { return occupied_boxes_; }

  // Returns one weight for each group in the format of common/medium.glsl. Each weight is the given
  // value times the extinction that a texel value of 1 stands for.
  std::vector<glm::vec4> Weights(const std::vector<double>& by_group) const;

 private:
  // The width around a ray that a sample represents, as a function of its distance from the eye:
  // the width at distance 0, and the increase per metre.
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
  glm::dvec3 bricks_low_m_{0.0};  // low corner of the first brick
  int occupied_count_ = 0;
  gl::Buffer blocks_;
  glm::ivec3 cells_per_block_{1};
  int block_count_ = 0;
  Boxes occupied_boxes_;
  std::vector<DetailLayer> details_;
  gl::Texture3D detail_control_;  // texture of volume::DetailControlOf
  glm::mat3 detail_fibres_{1.0F};
  PhaseCurves phase_curves_;
};

}  // namespace thunderhead::renderers

// The ground's cover on the device: a map of the storm's land use or the synthetic pattern of crop
// fields, coasts and borders, and the distance rings. The class owns GL objects, so use it on the
// context's thread.
#pragma once

#include <memory>

#include "gl/objects.h"
#include "gl/program.h"
#include "glm/vec2.hpp"
#include "scene/ground.h"
#include "scene/scene.h"
#include "scene/view.h"
#include "volume/hydrometeor_fields.h"

namespace thunderhead::renderers {

// Shader variant of common/ground_cover.glsl.
struct GroundCoverVariant {
  gl::DefineValue cover;  // the value of scene::GroundCover
  gl::DefineValue borders;
  gl::DefineValue rings;

  gl::Defines Defines() const { return {{"COVER", cover}, {"BORDERS", borders}, {"RINGS", rings}}; }
};

class GroundCover {
 public:
  // Sets the storm whose land use and borders are drawn. They are uploaded when they are first
  // drawn.
  void SetLand(const volume::HydrometeorFields& fields);

  // Uploads the cover that `scene` shows. `fields` must be the same as in the last SetLand.
  void Prepare(const scene::Scene& scene, const volume::HydrometeorFields& fields);

  GroundCoverVariant Variant() const;

  // Sets the uniforms and textures of common/ground_cover.glsl for coordinates relative to the eye.
  // The texture of the reflected sky is not set. `height_px` is the picture's height.
  void Bind(const gl::Program& program, const scene::Scene& scene, const scene::View& view,
            int height_px) const;

  std::size_t Bytes() const { return fields_.Bytes() + land_.Bytes() + borders_.Bytes(); }

 private:
  // Uploads the border map if one is drawn.
  void PrepareBorders(const volume::HydrometeorFields& fields);

  scene::Ground drawn_;
  glm::dvec2 ring_middle_m_{0.0};
  glm::dvec2 ring_north_{0.0, 1.0};
  gl::Texture2D fields_;  // the pattern of crop fields (physics::FieldPattern)
  bool land_is_new_ = false;
  gl::Texture2D land_;
  volume::RegularGrid grid_;
  glm::vec3 land_mean_{0.0F};
  std::shared_ptr<const volume::BorderMap> border_map_;  // null if no borders are drawn
  gl::Texture2D borders_;
};

}  // namespace thunderhead::renderers

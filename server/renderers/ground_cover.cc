#include "renderers/ground_cover.h"

#include <numbers>

#include "physics/field_pattern.h"
#include "shaders/bindings.h"
#include "shaders/uniforms.h"

namespace thunderhead::renderers {
namespace {

static_assert(static_cast<int>(scene::GroundCover::kPlain) == 0 &&
                  static_cast<int>(scene::GroundCover::kFields) == 1 &&
                  static_cast<int>(scene::GroundCover::kLandUse) == 2,
              "the shader's COVER");

}  // namespace

void GroundCover::SetLand(const volume::HydrometeorFields& fields) {
  grid_ = fields.grid;
  land_mean_ = fields.land.mean_reflectance;
  land_is_new_ = true;
  if (fields.land.Empty()) land_ = {};
}

void GroundCover::Prepare(const scene::Scene& scene, const volume::HydrometeorFields& fields) {
  drawn_ = scene::DrawnGround(scene, fields);
  ring_middle_m_ = scene::RingMiddle_m(fields);
  ring_north_ = scene::TrueNorth(fields);
  PrepareBorders(fields);
  if (drawn_.cover == scene::GroundCover::kPlain) return;
  if (fields_.Get() == 0) {
    fields_ = gl::Texture2D::WithMips(GL_RGBA8, glm::ivec2(physics::glsl::kFieldMapCells),
                                      gl::Edge::kRepeat);
    fields_.Upload(GL_RGBA, GL_UNSIGNED_BYTE, physics::FieldPattern::Plains().Texels().data());
  }
  if (drawn_.cover != scene::GroundCover::kLandUse || !land_is_new_) return;
  const glm::ivec2 size(fields.grid.cells);
  if (land_.Size() != size) {
    land_ = gl::Texture2D::WithMips(GL_SRGB8_ALPHA8, size, gl::Edge::kClamp);
  }
  land_.Upload(GL_RGBA, GL_UNSIGNED_BYTE, fields.land.texels.data());
  land_is_new_ = false;
}

void GroundCover::PrepareBorders(const volume::HydrometeorFields& fields) {
  const bool shown = drawn_.borders && !fields.borders->nearest.empty();
  if (!shown || fields.borders == border_map_) {
    if (!shown) border_map_ = nullptr;
    return;
  }
  border_map_ = fields.borders;
  const glm::ivec2 size = border_map_->grid.texels;
  if (borders_.Size() != size) borders_ = gl::Texture2D(GL_RGBA16F, size);
  borders_.Upload(GL_RGBA, GL_HALF_FLOAT, border_map_->nearest.data());
}

GroundCoverVariant GroundCover::Variant() const {
  return {.cover = static_cast<int>(drawn_.cover),
          .borders = border_map_ != nullptr,
          .rings = drawn_.rings};
}

void GroundCover::Bind(const gl::Program& program, const scene::Scene& scene,
                       const scene::View& view, int height_px) const {
  const bool by_land_use = drawn_.cover == scene::GroundCover::kLandUse;
  const glm::vec3 plain = by_land_use ? glm::vec3(1.0F) : scene::PlainReflectance(scene);
  const glm::vec3 mean = by_land_use ? land_mean_ : plain;
  program.Set(uniform::ground_reflectance, plain * std::numbers::inv_pi_v<float>);
  program.Set(uniform::pixel_width,
              glm::vec2(2.0 * glm::dvec2(view.half_height_m, view.tan_half_height) /
                        static_cast<double>(height_px)));
  program.Set(uniform::ring_middle_m, glm::vec2(ring_middle_m_ - glm::dvec2(view.eye_m)));
  program.Set(uniform::ring_north, glm::vec2(ring_north_));
  if (border_map_ != nullptr) {
    const volume::BorderGrid& grid = border_map_->grid;
    const glm::dvec2 size_m = glm::dvec2(grid.texels) * grid.texel_m;
    borders_.Bind(shaders::kGroundBordersUnit);
    program.Set(uniform::borders_scale, glm::vec2(1.0 / size_m));
    program.Set(uniform::borders_offset, glm::vec2((glm::dvec2(view.eye_m) - grid.low_m) / size_m));
    program.Set(uniform::borders_texel_m, static_cast<float>(grid.texel_m));
  }
  if (drawn_.cover == scene::GroundCover::kPlain) return;
  fields_.Bind(shaders::kGroundGrainUnit);
  program.Set(uniform::pattern_origin_m, glm::vec2(view.eye_m));
  program.Set(uniform::ground_contrast, physics::FieldContrast(mean));
  if (!by_land_use) return;
  land_.Bind(shaders::kGroundCoverUnit);
  const glm::dvec2 size_m = glm::dvec2(grid_.cells) * glm::dvec2(grid_.spacing_m);
  program.Set(uniform::land_scale, glm::vec2(1.0 / size_m));
  program.Set(uniform::land_offset,
              glm::vec2((glm::dvec2(view.eye_m) - glm::dvec2(grid_.low_corner_m)) / size_m));
  program.Set(uniform::land_mean, land_mean_);
  program.Set(uniform::land_fades_cells, volume::kLandFades_cells);
  program.Set(uniform::coast_cells, volume::kCoast_cells);
}

}  // namespace thunderhead::renderers

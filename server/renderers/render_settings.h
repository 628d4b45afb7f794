// The inputs of every renderer that draws a medium, except the medium itself.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "gl/objects.h"
#include "glm/vec2.hpp"
#include "glm/vec3.hpp"
#include "renderers/chosen_rays.h"
#include "renderers/cover.h"
#include "renderers/light_correction.h"
#include "scene/scene.h"
#include "scene/view.h"

namespace thunderhead::renderers {

// A light in addition to the sun (scene::DirectionalLight).
struct Beam {
  glm::dvec3 towards{0.0, 0.0, 1.0};
  glm::vec3 irradiance{1.0F};
};

// The light of the sun, the sky and the scene's own lights on the medium.
struct Illumination {
  glm::dvec3 towards_sun{0.0, 0.0, 1.0};
  glm::vec3 sunlight{1.0F};  // irradiance on a plane facing the sun, at the ground
  glm::vec3 ambient{0.0F};   // mean radiance from sky and ground
  // Mean radiance of the upper hemisphere. from_ground is that of the lower hemisphere.
  glm::vec3 from_sky{0.0F};
  glm::vec3 from_ground{0.0F};
  // The scene's own lights; a renderer that cannot show them reports them as not shown.
  std::vector<Beam> beams{};
  // The sky as a sum of two parts, for diffusion transport. `around_sun` is the bright region
  // around the sun, as an irradiance from the sun's direction. The rest of the sky is approximated
  // as linear in the sine of the elevation. The mean radiance of the rest is `rest_of_sky`. Its
  // irradiance on level ground, divided by pi, is `rest_of_sky_level`.
  glm::vec3 around_sun{0.0F};
  glm::vec3 rest_of_sky{0.0F};
  glm::vec3 rest_of_sky_level{0.0F};
  // The share of direct sunlight, by luminance, in the light that open ground receives.
  float ground_sunlit = 1.0F;
  float ground_albedo = 0.0F;  // albedo by luminance
  // Sunlight at shaders::kSunlightLevels heights above sea level, which begin at 0 and are
  // shaders::kSunlightStep_m apart. The vector is empty if sunlight is the same at every height.
  std::vector<glm::vec3> sunlight_levels{};
};

inline constexpr double kLightTolerance = 2e-4;  // default of DrawQuality::light_tolerance

// The quality with which a scene is drawn.
struct DrawQuality {
  // Scale of the width and height of the eye buffer (the picture of the storm alone), (0, 2]. A
  // scale of 2 gives 4 rays a pixel.
  double image_scale = 1.0;
  double slice_share = 1.0;  // share of the scene's slices that are drawn, (0, 1]
  // Frames of sessions have the default `light_detail` and `single_precision`. Only measurements of
  // quality and the fit of the path-traced correction change them. The value of `light_detail` is
  // the number of texels along a side of the light volume, relative to the usual number.
  double light_detail = 1.0;
  // If true, the buffers of the light and the frame have single instead of half precision.
  bool single_precision = false;
  // Correction of the light volume by path tracing, for the scene's light. Null if there is none.
  std::shared_ptr<const LightCorrection> correction{};
  // If true, the sun's disc and its aureole are drawn where they are in view.
  bool sun_seen = true;
  // The size of the linear frame, if it differs from the scene's size. SceneRenderer::DrawChosen
  // then adds the missing rays. The turbulent detail still suits pixels of the scene's size.
  // Techniques and devices that cannot do this (SceneRenderer::DrawsChosen) draw the whole picture.
  std::optional<glm::ivec2> coarse_px{};
  // Relative tolerance of the light from the diffusion equation. Existing light that is more
  // accurate is kept.
  double light_tolerance = kLightTolerance;
  // Length of the light volume's layers relative to the usual length, at least 1. Existing light
  // with shorter layers is kept.
  double light_layer = 1.0;
  // If true, light that changes little with the sun is updated for only a part of the cells in each
  // frame. The other cells keep their light.
  bool light_in_turns = false;
  // If true, turbulent detail preserves the water paths of columns (volume/water_paths.h) less
  // exactly. An existing medium with exact water paths is kept.
  bool quick_water_paths = false;

  bool operator==(const DrawQuality&) const = default;
};

struct RenderSettings {
  scene::Technique technique;
  scene::View view;
  Illumination illumination;
  glm::ivec2 eye_size{1};                    // size of the eye buffer in pixels
  int slices = scene::LightVolume{}.slices;  // number of slices, or of samples along a ray
  DrawQuality quality{};  // the quality; its scales are already applied to `eye_size` and `slices`
  // Distance of the ground along each pixel's ray. Null if the ground hides no part of the medium.
  const gl::Texture2D* ground_distance = nullptr;
  // The part of the eye buffer that may show the medium. Null if the medium may be anywhere.
  const Cover* cover = nullptr;
  // The size of the picture whose pixels determine how fine the detail is, if it differs from the
  // size of the eye buffer.
  std::optional<glm::ivec2> detail_size{};
  // The rays to draw instead of those of the eye buffer's pixels. They belong to a picture of the
  // size `detail_size`. The eye buffer then has the size ChosenRays::Size().
  const ChosenRays* chosen = nullptr;

  // Returns the technique's settings for its medium. The technique must draw a medium.
  const scene::MediumSettings& Medium() const;
};

}  // namespace thunderhead::renderers

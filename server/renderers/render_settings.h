// Inputs of every renderer of a medium, except the medium.
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
  glm::vec3 from_sky{0.0F};  // mean radiance of the upper hemisphere; from_ground: of the lower
  glm::vec3 from_ground{0.0F};
  std::vector<Beam> beams{};  // renderers that cannot show them report so
  // The sky as a sum of two parts, for diffusion transport. Its bright surroundings of the sun are
  // an irradiance from the sun's direction. The rest counts as linear in the sine of the elevation.
  // It is given by its mean radiance and its irradiance from above over pi.
  glm::vec3 around_sun{0.0F};
  glm::vec3 rest_of_sky{0.0F};
  glm::vec3 rest_of_sky_level{0.0F};
  // The share of sunlight, by luminance, in the light that open ground receives.
  float ground_sunlit = 1.0F;
  float ground_albedo = 0.0F;  // albedo by luminance
  // Sunlight at 0, shaders::kSunlightStep_m ... above sea level, shaders::kSunlightLevels values.
  // Empty if it is the same everywhere.
  std::vector<glm::vec3> sunlight_levels{};
};

// The quality with which a scene is drawn.
inline constexpr double kLightTolerance = 2e-4;  // relative tolerance

struct DrawQuality {
  // Scale of the eye buffer's width and height, (0, 2]; 2 is 4 rays a pixel.
  double image_scale = 1.0;
  double slice_share = 1.0;  // share of the scene's slices, (0, 1]
  // Only sweeps vary the next two. Sessions draw with these values.
  // texels of the light volume along a side, relative to the usual number
  double light_detail = 1.0;
  bool single_precision = false;  // in buffers of light and the frame; the usual precision is half
  // Correction of the light volume for the scene's light.
  std::shared_ptr<const LightCorrection> correction{};
  // Draws the sun's disc and its aureole where they are in view.
  bool sun_seen = true;
  // The size of the linear frame, if it differs from the scene's size. SceneRenderer::DrawChosen
  // then adds the missing rays. Detail suits the pixels of the scene's size. Techniques and devices
  // that do not support this (SceneRenderer::DrawsChosen) draw the whole picture.
  std::optional<glm::ivec2> coarse_px{};
  // Tolerance of the light from the diffusion equation. More accurate light is kept.
  double light_tolerance = kLightTolerance;
  // Length of the light volume's layers relative to the usual one, at least 1. Finer light is kept.
  double light_layer = 1.0;
  // Updates light that changes little with the sun for only a part of the cells, and keeps it for
  // the others.
  bool light_in_turns = false;
  // Preserves the water paths of columns less exactly where detail is drawn. Better ones are kept.
  bool quick_water_paths = false;

  bool operator==(const DrawQuality&) const = default;
};

struct RenderSettings {
  scene::Technique technique;
  scene::View view;
  Illumination illumination;
  glm::ivec2 eye_size{1};                    // size of the eye buffer in pixels
  int slices = scene::LightVolume{}.slices;  // also the number of samples along a ray
  DrawQuality quality{};                     // its scales are already applied to the sizes above
  // Distance of the ground along each pixel's ray. Null if no ground hides a part of the medium.
  const gl::Texture2D* ground_distance = nullptr;
  // The part of the eye buffer that may show the medium. Null: all of it.
  const Cover* cover = nullptr;
  // The size of the picture whose pixels determine the detail, if that is not the eye buffer.
  std::optional<glm::ivec2> detail_size{};
  // The rays to draw from a picture of detail_size, instead of those of the eye buffer's pixels.
  // The eye buffer then has the size of these rays.
  const ChosenRays* chosen = nullptr;

  // Returns the settings of a technique that draws a medium.
  const scene::MediumSettings& Medium() const;
};

}  // namespace thunderhead::renderers

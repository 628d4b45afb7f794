// Inputs of every renderer of a medium, besides the medium.
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

// A light besides the sun (scene::DirectionalLight).
struct Beam {
  glm::dvec3 towards{0.0, 0.0, 1.0};
  glm::vec3 irradiance{1.0F};
};

// The light of the sun, the sky and the scene's own lights on the medium.
struct Illumination {
  glm::dvec3 towards_sun{0.0, 0.0, 1.0};
  glm::vec3 sunlight{1.0F};  // irradiance on a plane facing the sun, at the ground
  glm::vec3 ambient{0.0F};   // mean radiance from sky and ground
  glm::vec3 from_sky{0.0F};  // mean radiance of the upper and of the lower half
  glm::vec3 from_ground{0.0F};
  std::vector<Beam> beams{};  // renderers that cannot show them say so
  // The sky as a sum, for diffusion transport: an irradiance from the sun's direction for its
  // bright surroundings, and of the rest, taken for linear in the sine of the elevation, the mean
  // radiance and the irradiance from above over pi.
  glm::vec3 around_sun{0.0F};
  glm::vec3 rest_of_sky{0.0F};
  glm::vec3 rest_of_sky_level{0.0F};
  // The share of sunlight, by luminance, in the light that open ground receives.
  float ground_sunlit = 1.0F;
  float ground_albedo = 0.0F;  // by luminance
  // Sunlight at 0, shaders::kSunlightStep_m ... above sea level, shaders::kSunlightLevels of them;
  // none if it is the same everywhere.
  std::vector<glm::vec3> sunlight_levels{};
};

// How well to draw a scene.
inline constexpr double kLightTolerance = 2e-4;  // relative

struct DrawQuality {
  double image_scale = 1.0;  // of the eye buffer's width and height, (0, 2]; 2 is 4 rays a pixel
  double slice_share = 1.0;  // of the scene's slices, (0, 1]
  // Varied by sweeps only; sessions draw with these.
  double light_detail = 1.0;      // texels of the light volume, over the usual ones, along a side
  bool single_precision = false;  // in buffers of light and the frame; half is usual
  // Correction of the light volume, for the light that the scene has.
  std::shared_ptr<const LightCorrection> correction{};
  // Draws the sun's disc and its aureole where they are in view.
  bool sun_seen = true;
  // The size of the linear frame in place of the scene's, for pictures to which
  // SceneRenderer::DrawChosen adds what they lack: detail suits the pixels of the scene's size. Not
  // all techniques and devices do that (SceneRenderer::DrawsChosen); they draw the whole picture.
  std::optional<glm::ivec2> coarse_px{};
  // Of the light that the diffusion equation gives; light that is known better is kept.
  double light_tolerance = kLightTolerance;
  // Length of the light volume's layers over the usual one, at least 1; finer light is kept.
  double light_layer = 1.0;
  // Light that changes little with the sun is found for a part of the cells, and kept for others.
  bool light_in_turns = false;
  // Water paths of columns are kept less exactly where detail is drawn; those that are kept better
  // stay.
  bool quick_water_paths = false;

  bool operator==(const DrawQuality&) const = default;
};

struct RenderSettings {
  scene::Technique technique;
  scene::View view;
  Illumination illumination;
  glm::ivec2 eye_size{1};                    // of the eye buffer in pixels
  int slices = scene::LightVolume{}.slices;  // or samples along a ray
  DrawQuality quality{};                     // its shares are in the sizes above already
  // Distance of the ground along each pixel's ray; none where nothing hides a part of the medium.
  const gl::Texture2D* ground_distance = nullptr;
  // Where in the eye buffer the medium is; none: it may be anywhere.
  const Cover* cover = nullptr;
  // The picture whose pixels detail is to suit, if that is not the eye buffer.
  std::optional<glm::ivec2> detail_size{};
  // The rays to draw, of a picture of detail_size, if they are not those of the eye buffer's
  // pixels, which then has the size of these.
  const ChosenRays* chosen = nullptr;

  // The settings of a technique that draws a medium.
  const scene::MediumSettings& Medium() const;
};

}  // namespace thunderhead::renderers

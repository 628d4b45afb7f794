// A scene: one plain value that decides what a picture looks like, with every default resolved.
// Knows no files, no GL and no messages. Azimuths are degrees clockwise from north; world
// coordinates as in volume/grid.h.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "glm/vec2.hpp"
#include "glm/vec3.hpp"
#include "physics/hydrometeors.h"
#include "physics/particle_size.h"
#include "scene/stage.h"
#include "scene/technique.h"

namespace thunderhead::scene {

// Structure finer than the grid (shaders/physics/detail.glsl), drifting with the wind, that changes
// `share` of the field where the model's air is turbulent. Shown where the technique's look has
// detail.
struct Detail {
  float share = 0.0F;
  float wavelength_m = 0.0F;  // of the first octave; 0 is kDetailWavelengthInCells of the storm's
  int octaves = 4;
  std::uint32_t seed = 1;

  bool operator==(const Detail&) const = default;
};

// A model's grid carries waves of several cells; where those end, detail begins.
inline constexpr float kDetailWavelengthInCells = 3.0F;

float DefaultDetailWavelength_m(const glm::dvec3& cell_m);

// The detail that suits each hydrometeor.
Detail DefaultDetail(physics::Hydrometeor hydrometeor);

// How one hydrometeor field is drawn.
struct FieldParameters {
  bool visible = true;
  float scale = 1.0F;                // multiplies the mixing ratio
  physics::ParticleOptics optics{};  // whose radius counts if the sizes are given
  physics::SizeSource sizes = physics::SizeSource::kModel;
  Detail detail;

  bool operator==(const FieldParameters&) const;
};

// Looks at `target_m` from `distance_m` away, standing at azimuth and elevation seen from the
// target.
struct OrbitCamera {
  glm::dvec3 target_m{0.0};
  double azimuth_deg = 200.0;
  double elevation_deg = 4.0;
  double distance_m = 1e5;
  double field_of_view_deg = 35.0;  // vertical

  bool operator==(const OrbitCamera&) const = default;
};

// Stands on the ground at `place_m` and looks to azimuth and elevation. The picture is cut out of a
// frame of 36 x 24 mm behind a lens of the given focal length: wider pictures use its whole width,
// narrower ones its whole height.
struct SpotterCamera {
  glm::dvec2 place_m{0.0};
  double eye_height_m = 1.7;  // above the terrain
  double azimuth_deg = 20.0;
  double elevation_deg = 5.0;
  double focal_length_mm = 24.0;

  bool operator==(const SpotterCamera&) const = default;
};

// Looks straight down from above the air, north up, without perspective, as satellite pictures do.
struct TopDownCamera {
  glm::dvec2 center_m{0.0};
  double width_m = 1e5;  // that the picture shows

  bool operator==(const TopDownCamera&) const = default;
};

using Camera = std::variant<OrbitCamera, SpotterCamera, TopDownCamera>;

struct Sun {
  double azimuth_deg = 275.0;
  double elevation_deg = 18.0;
  double irradiance =
      1.0;  // on a plane facing the sun above the atmosphere; radiance is in this unit

  bool operator==(const Sun&) const = default;
};

// A light besides the sun, all of it from one direction. It lights the storm alone: neither ground
// nor sky, and through no air. Shown by metaballs and by the reference.
struct DirectionalLight {
  double azimuth_deg = 75.0;
  double elevation_deg = 20.0;
  glm::dvec3 color{1.0};    // linear sRGB, up to 1
  double irradiance = 1.0;  // of white, on a plane facing it, in the unit of the sun's

  bool operator==(const DirectionalLight&) const = default;
};

struct Sky {
  double brightness = 1.0;
  double ground_albedo = 0.2;
  double turbidity = 1.5;  // of the air: 1 without haze, 10 very hazy

  bool operator==(const Sky&) const = default;
};

enum class GroundCover {
  kPlain,    // of one colour
  kFields,   // crops on a one-mile grid, made up (physics/field_pattern.h)
  kLandUse,  // the file's; plain if it has none
};

// The look of the ground. Which cover is the default depends on the storm.
struct Ground {
  GroundCover cover = GroundCover::kPlain;
  bool borders = false;  // and coasts, where fields have them
  bool rings = false;  // of distance, every 10 km around the storm's middle, and an arrow to north

  bool operator==(const Ground&) const = default;
};

// An accuracy or a speed to reach, by the setting that the server's tables say is best; neither
// leaves the rendering as it is.
struct MaxError {
  double relative_rmse = 0.0;  // of linear radiance, against the reference

  bool operator==(const MaxError&) const = default;
};
struct MaxMilliseconds {
  double milliseconds = 0.0;  // a frame of a moved camera

  bool operator==(const MaxMilliseconds&) const = default;
};
using Accuracy = std::variant<std::monostate, MaxError, MaxMilliseconds>;

// How a picture is computed: the technique with its settings.
struct Rendering {
  Technique technique;
  double image_scale = 1.0;  // of the eye buffer at full quality, (0, 2]; pictures keep their size

  bool operator==(const Rendering&) const = default;
};

enum class ToneMap { kLinear, kFilmic };

struct Display {
  // In stops; without one, such that the storm's brightest hundredth is just below white.
  std::optional<double> exposure_ev{};
  ToneMap tone_map = ToneMap::kFilmic;
  bool white_balance = true;  // to the scene's sun and sky

  bool operator==(const Display&) const = default;
};

struct Output {
  int width_px = 1280;
  int height_px = 720;
  int jpeg_quality = 88;

  bool operator==(const Output&) const = default;
};

struct Scene {
  std::string storm_id;
  int time_index = 0;
  Camera camera;
  Sun sun;
  Sky sky;
  Ground ground;
  std::vector<DirectionalLight> lights;
  std::array<FieldParameters, physics::kHydrometeorCount> fields;  // by physics::IndexOf
  Rendering rendering;
  Display display;
  Output output;
  Accuracy accuracy;  // decides much of `rendering`, which renderers are given decided

  // A scene with the default optics of every field.
  Scene();

  bool operator==(const Scene&) const = default;
};

// A field's detail as it is drawn on a grid of such cells, its wavelength given; a share of 0 if
// none.
Detail DrawnDetail(const Scene& scene, physics::Hydrometeor hydrometeor, const glm::dvec3& cell_m);

// The first stage that must rerun when `before` becomes `after`.
Stage FirstDirtyStage(const Scene& before, const Scene& after);

}  // namespace thunderhead::scene

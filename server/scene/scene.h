// A scene: a plain value that determines what a picture looks like, with every default resolved. It
// does not depend on files, GL or messages. Azimuths are degrees clockwise from north. World
// coordinates are defined in volume/grid.h.
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

// Turbulent structure finer than the grid (shaders/physics/detail.glsl), which drifts with the
// wind. It is drawn if FieldLook::detail of the technique is set. Metaballs have rough surfaces
// instead. Their roughness is the largest `share` among the drawn fields.
struct Detail {
  // How much of the field's extinction the structure changes where the model's air is turbulent,
  // from 0 (none) to 1 (all).
  float share = 0.0F;
  // Wavelength of the first octave. The value 0 stands for kDetailWavelengthInCells cells of the
  // storm's grid.
  float wavelength_m = 0.0F;
  int octaves = 4;
  std::uint32_t seed = 1;

  bool operator==(const Detail&) const = default;
};

// The wavelength at which detail begins, in grid cells. A model's grid resolves waves of several
// cells, and detail adds the shorter waves.
inline constexpr float kDetailWavelengthInCells = 3.0F;

float DefaultDetailWavelength_m(const glm::dvec3& cell_m);

// Returns the default detail of a hydrometeor.
Detail DefaultDetail(physics::Hydrometeor hydrometeor);

// Drawing parameters of one hydrometeor field.
struct FieldParameters {
  bool visible = true;
  float scale = 1.0F;                // multiplies the mixing ratio
  physics::ParticleOptics optics{};  // `optics.radius_m` applies only if `sizes` is kGiven
  physics::SizeSource sizes = physics::SizeSource::kModel;
  Detail detail;

  bool operator==(const FieldParameters&) const;
};

// A camera that looks at `target_m` from `distance_m` away. Azimuth and elevation give the camera's
// direction as seen from the target.
struct OrbitCamera {
  glm::dvec3 target_m{0.0};
  double azimuth_deg = 200.0;
  double elevation_deg = 4.0;
  double distance_m = 1e5;
  double field_of_view_deg = 35.0;  // vertical angle

  bool operator==(const OrbitCamera&) const = default;
};

// A camera on the ground at `place_m` that looks towards azimuth and elevation. The picture is cut
// out of a frame of 36 x 24 mm behind a lens of the given focal length. Wider pictures use the
// frame's whole width, narrower ones its whole height.
struct SpotterCamera {
  glm::dvec2 place_m{0.0};
  double eye_height_m = 1.7;  // height above the terrain
  double azimuth_deg = 20.0;
  double elevation_deg = 5.0;
  double focal_length_mm = 24.0;

  bool operator==(const SpotterCamera&) const = default;
};

// A camera above the air that looks straight down without perspective, with north up, like a
// satellite.
struct TopDownCamera {
  glm::dvec2 center_m{0.0};
  double width_m = 1e5;  // width of the shown area

  bool operator==(const TopDownCamera&) const = default;
};

using Camera = std::variant<OrbitCamera, SpotterCamera, TopDownCamera>;

struct Sun {
  double azimuth_deg = 275.0;
  double elevation_deg = 18.0;
  // Irradiance on a plane facing the sun, above the atmosphere. Radiance is in the same unit.
  double irradiance = 1.0;

  bool operator==(const Sun&) const = default;
};

// A light in addition to the sun, with all of its light from one direction. It lights only the
// storm, not the ground or the sky, and the air does not attenuate it. Only the metaball technique
// and the path-traced reference show it.
struct DirectionalLight {
  double azimuth_deg = 75.0;
  double elevation_deg = 20.0;
  glm::dvec3 color{1.0};  // linear sRGB, up to 1
  // Irradiance of white light on a plane that faces the light, in the unit of the sun's irradiance.
  double irradiance = 1.0;

  bool operator==(const DirectionalLight&) const = default;
};

struct Sky {
  double brightness = 1.0;
  double ground_albedo = 0.2;
  double turbidity = 1.5;  // turbidity of the air: 1 is without haze, 10 is very hazy

  bool operator==(const Sky&) const = default;
};

enum class GroundCover {
  kPlain,    // one colour
  kFields,   // synthetic crops on a one-mile grid (physics/field_pattern.h)
  kLandUse,  // the file's land use; plain if the file has none
};

// The appearance of the ground. The default cover depends on the storm.
struct Ground {
  GroundCover cover = GroundCover::kPlain;
  bool borders = false;  // draws borders and coasts if the fields have them
  // Draws distance rings every 10 km around the storm's middle and an arrow to north.
  bool rings = false;

  bool operator==(const Ground&) const = default;
};

// A target accuracy or speed. The server reaches it with the best setting of its tables. Without a
// target the rendering stays unchanged.
struct MaxError {
  double relative_rmse = 0.0;  // error of linear radiance relative to the path-traced reference

  bool operator==(const MaxError&) const = default;
};
struct MaxMilliseconds {
  double milliseconds = 0.0;  // time in milliseconds to a frame after the camera moved

  bool operator==(const MaxMilliseconds&) const = default;
};
using Accuracy = std::variant<std::monostate, MaxError, MaxMilliseconds>;

// How a picture is computed: the technique with its settings.
struct Rendering {
  Technique technique;
  // Scale of the eye buffer (the picture of the storm alone) at full quality, (0, 2]. The size of
  // the final picture does not change.
  double image_scale = 1.0;

  bool operator==(const Rendering&) const = default;
};

enum class ToneMap { kLinear, kFilmic };

struct Display {
  // Exposure in stops. Without a value, the brightest hundredth of the storm is just below white.
  std::optional<double> exposure_ev{};
  ToneMap tone_map = ToneMap::kFilmic;
  bool white_balance = true;  // adjusts to the scene's sun and sky

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
  std::array<FieldParameters, physics::kHydrometeorCount> fields;  // indexed by physics::IndexOf
  Rendering rendering;
  Display display;
  Output output;
  // Determines most of `rendering`. Renderers receive a scene in which that has been done.
  Accuracy accuracy;

  // Creates a scene with the default optics of every field.
  Scene();

  bool operator==(const Scene&) const = default;
};

// Returns a field's detail as it is drawn on a grid with cells of this size. A wavelength of 0 is
// replaced by the length for which it stands. The share is 0 if no detail is drawn.
Detail DrawnDetail(const Scene& scene, physics::Hydrometeor hydrometeor, const glm::dvec3& cell_m);

// Returns the first stage that must rerun when `before` becomes `after`.
Stage FirstDirtyStage(const Scene& before, const Scene& after);

}  // namespace thunderhead::scene

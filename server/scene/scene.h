// A scene: one plain value that decides what a picture looks like, with every default resolved.
// Knows no files, no GL and no messages. Azimuths are degrees clockwise from north; world
// coordinates as in volume/grid.h.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <variant>
#include <vector>

#include "glm/vec2.hpp"
#include "glm/vec3.hpp"
#include "physics/hydrometeors.h"

namespace thunderhead::scene {

// Turbulent structure finer than the grid (physics/turbulence.h), at rest in the world: noise with
// a mean of 1 multiplies `share` of the field. Modes without detail ignore it.
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
  float scale = 1.0F;  // multiplies the mixing ratio
  physics::ParticleOptics optics{};
  bool size_from_file =
      true;  // radii of each cell in place of optics.radius_m, if the file has any
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
  double azimuth_deg = 255.0;
  double elevation_deg = 35.0;
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

// The modes of Riley et al. 2003 (AMS), Table IV.
enum class Mode {
  kUniformPhaseLowAlbedo,
  kUniformPhaseTranslucent,
  kPerFieldPhaseTranslucent,
  kPerFieldPhaseDetailTranslucent
};

bool HasPerFieldPhase(Mode mode);
bool HasDetail(Mode mode);

// The renderer: slices halfway between sun and eye; light carried once into a volume, which view
// rays march through; metaballs fitted to the fields, lit and splatted (Man); the shading of a
// cumulus' surface (Neyret); or the Monte Carlo reference, which is traced on the CPU, ever finer.
enum class Renderer { kHalfAngle, kLightVolume, kReference, kMetaball, kCumulus };
inline constexpr std::size_t kRendererCount = 5;

// Whether it shows lights besides the sun.
bool ShowsLights(Renderer renderer);

// What becomes of scattered light: the papers' slices; an exact exponential with a closed form for
// light scattered many times; or that light from the diffusion equation (light volume only: slices
// draw it as consistent).
enum class Transport { kPaper, kConsistent, kDiffusion };

// How a storm is drawn by metaballs; other renderers ignore it.
struct Metaballs {
  int count = 1200;  // at most; the paper's first scene
  bool isotropic = false;
  double albedo = 0.9;         // a of Man's eq. 26; Transport::kPaper only
  double optical_depth = 8.0;  // tau of the same

  bool operator==(const Metaballs&) const = default;
};

// What the cumulus renderer draws: the storm's cloud water and ice, a heap of heaps of bubbles, the
// ellipsoids of one of the generator's presets, or one ellipsoid. What is not the storm fills its
// place.
enum class CumulusSource {
  kStorm,
  kCauliflower,
  kFairWeatherCumulus,
  kCongestus,
  kCumulusField,
  kEllipsoid
};

// Which part of a cumulus' light is shown; balls are Lambert's law on bare ellipsoids, what the
// shading's cost is compared with.
enum class CumulusComponent { kAll, kDirect, kInterReflection, kAmbient, kCorona, kBalls };

// Neyret 2000; used by the cumulus renderer alone.
struct Cumulus {
  CumulusSource source = CumulusSource::kStorm;
  std::uint32_t seed = 1;
  int scales = 3;                        // of ellipsoids
  float least_extinction_per_m = 2e-3F;  // of a storm, inside the surface
  float corona = 0.3F;                   // thickness over the radius of the finest ellipsoids
  float trap = 0.45F;                    // share of the sky that the deepest valley hides
  float transmission = 0.05F;            // share of sunlight that comes through
  float roughness = 0.6F;
  CumulusComponent component = CumulusComponent::kAll;

  bool operator==(const Cumulus&) const = default;
};

// What the server is to reach, by whichever setting its tables say is best; neither leaves the
// rendering as it is.
struct MaxError {
  double relative_rmse = 0.0;  // of linear radiance, against the reference

  bool operator==(const MaxError&) const = default;
};
struct MaxMilliseconds {
  double milliseconds = 0.0;  // a frame of a moved camera

  bool operator==(const MaxMilliseconds&) const = default;
};
using Accuracy = std::variant<std::monostate, MaxError, MaxMilliseconds>;

struct Rendering {
  Renderer renderer = Renderer::kLightVolume;
  Mode mode = Mode::kPerFieldPhaseTranslucent;
  Transport transport = Transport::kConsistent;
  int slices = 128;
  double theta_f_deg = 20.0;
  bool false_colors = false;
  // While light and storm rest, traced paths correct what a light volume by diffusion shows of
  // them.
  bool traced_light = false;
  Metaballs metaballs;
  Cumulus cumulus;
  double image_scale = 1.0;  // of the eye buffer at full quality, (0, 2]; pictures keep their size

  bool operator==(const Rendering&) const = default;
};

// Whether traced light changes the picture: a light volume by diffusion whose light is scattered
// on.
bool ShowsTracedLight(const Rendering& rendering);

enum class ToneMap { kLinear, kFilmic };

struct Display {
  double exposure_ev = 0.0;
  ToneMap tone_map = ToneMap::kFilmic;

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

// The stages of rendering in order; a change reruns the first stage it dirties and every later one.
enum class Stage { kStorm, kExtinction, kLight, kView, kTone, kNothing };

// The first stage that must rerun when `before` becomes `after`.
Stage FirstDirtyStage(const Scene& before, const Scene& after);

}  // namespace thunderhead::scene

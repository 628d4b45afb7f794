// A fixture that draws a homogeneous slab in a narrow field of view, for comparison with closed
// forms. Any technique that draws a medium can be used.
#pragma once

#include <cmath>
#include <memory>
#include <numbers>
#include <vector>

#include "frame/tone_map.h"
#include "gl/context.h"
#include "gtest/gtest.h"
#include "physics/optics.h"
#include "renderers/half_angle/half_angle_renderer.h"
#include "renderers/light_volume/light_volume_renderer.h"
#include "tests/support/gl_context.h"
#include "tests/support/slab.h"
#include "tests/support/techniques.h"

namespace thunderhead::renderers {

// Extinction is stored in half floats, with an error of at most 2^-12.
inline constexpr double kTextureError = 1e-3;

class SlabView : public testing::Test {
 protected:
  static constexpr double kWidth_m = 4000.0;
  static constexpr double kHeight_m = 1000.0;
  static constexpr double kViewAzimuth_deg = 200.0;
  static constexpr double kSunAzimuth_deg = 70.0;

  static void SetUpTestSuite() {
    auto context = test_support::OpenContext();
    ASSERT_TRUE(context.ok()) << context.status();
    context_ = *std::move(context);
  }
  static void TearDownTestSuite() { context_.reset(); }

  struct Seen {
    double radiance;       // radiance of the middle pixel in the red channel
    double transmittance;  // transmittance along the middle pixel's ray
    std::vector<float> eye;
    std::vector<float> light;  // the light buffer, only from half-angle slicing
  };

  // Draws scene_.rendering, looking straight at the middle of the slab from `elevation_deg`.
  Seen Look(double optical_depth, double elevation_deg, double sun_elevation_deg) {
    scene::OrbitCamera camera;
    camera.target_m = {0.0, 0.0, kHeight_m / 2};
    camera.azimuth_deg = kViewAzimuth_deg;
    camera.elevation_deg = elevation_deg;
    camera.distance_m = 5000.0;
    camera.field_of_view_deg = 2.0;
    return Look(optical_depth, scene::ViewOf(camera, 1.0), sun_elevation_deg);
  }

  Seen Look(double optical_depth, const scene::View& view, double sun_elevation_deg) {
    const volume::HydrometeorFields fields = Fields(optical_depth);
    ResidentMedium::Cost cost;
    DetailNoises noises;
    const ResidentMedium medium(scene_, fields, &noises, &cost);
    RenderSettings settings;
    settings.technique = scene_.rendering.technique;
    settings.view = view;
    settings.illumination = {scene::Direction(kSunAzimuth_deg, sun_elevation_deg), glm::vec3(1.0F),
                             glm::vec3(0.0F)};
    if (even_light_) {
      settings.illumination = {settings.illumination.towards_sun, glm::vec3(0.0F), glm::vec3(1.0F),
                               glm::vec3(1.0F), glm::vec3(1.0F)};
      settings.illumination.rest_of_sky = settings.illumination.rest_of_sky_level = glm::vec3(1.0F);
    }
    settings.eye_size = {9, 9};
    settings.slices = *scene::SlicesOf(scene_.rendering.technique);
    Seen seen;
    if (test_support::PlainTechniqueOf(scene_.rendering.technique) == test_support::kHalfAngle) {
      HalfAngleRenderer renderer(std::make_shared<gl::ProgramCache>());
      EXPECT_TRUE(renderer.Render(medium, settings, true).ok());
      seen.eye = frame::ReadLinear(renderer.Eye());
      seen.light = renderer.Light();
    } else {
      LightVolumeRenderer renderer(std::make_shared<gl::ProgramCache>());
      EXPECT_TRUE(renderer.CarryLight(medium, settings).ok());
      EXPECT_TRUE(renderer.DrawView(medium, settings).ok());
      seen.eye = frame::ReadLinear(renderer.Eye());
    }
    seen.radiance = seen.eye[4 * 40];
    seen.transmittance = seen.eye[4 * 40 + 3];
    return seen;
  }

  volume::HydrometeorFields Fields(double optical_depth) const {
    volume::HydrometeorFields fields =
        in_air_ ? *support::MakeLayerInAir(width_m_, kHeight_m, 8, optical_depth)
                : *support::MakeSlab(width_m_, kHeight_m, optical_depth / kHeight_m);
    if (with_gap_) MakeGap(&fields);
    if (haze_per_m_ > 0.0) AddHaze(&fields);
    if (stirred_) Stir(&fields);
    return fields;
  }

  // A turbulence so weak that ice has fibres.
  static constexpr std::uint8_t kTurbulence = 76;
  static void Stir(volume::HydrometeorFields* fields) {
    fields->fields[0].hydrometeor = physics::Hydrometeor::kIce;
    fields->motion.source = volume::TurbulenceSource::kEnergy;
    fields->motion.turbulence.assign(fields->grid.CellCount(), kTurbulence);
  }

  static void MakeGap(volume::HydrometeorFields* fields) {
    const int width = fields->grid.cells.x;
    std::vector<float>& concentration = fields->fields[0].concentration_kg_per_m3;
    for (std::size_t i = 0; i < concentration.size(); ++i) {
      const int x = static_cast<int>(i) % width;
      if (x >= width / 4 && x < width - width / 4) concentration[i] = 0.0F;
    }
  }

  void AddHaze(volume::HydrometeorFields* fields) const {
    const physics::ParticleOptics& cloud = physics::DefaultOptics(physics::Hydrometeor::kCloud);
    const float mass_extinction =
        physics::MassExtinction_m2_per_kg(cloud.density_kg_per_m3, cloud.radius_m);
    for (float& concentration : fields->fields[0].concentration_kg_per_m3) {
      if (concentration == 0.0F) concentration = static_cast<float>(haze_per_m_) / mass_extinction;
    }
    fields->condensate = {glm::ivec3(0), fields->grid.cells};
  }

  void SetPhase(physics::PhaseKind kind, float asymmetry) {
    for (scene::FieldParameters& field : scene_.fields) field.optics.phase = {kind, asymmetry};
  }

  // Returns the phase function divided by 4 pi, at the angle between the view and the sun.
  double PhaseTerm(double elevation_deg, double sun_elevation_deg) {
    const double mu = -glm::dot(scene::Direction(kViewAzimuth_deg, elevation_deg),
                                scene::Direction(kSunAzimuth_deg, sun_elevation_deg));
    return physics::PhaseValue(
               physics::PhaseOf(
                   scene_.fields[physics::IndexOf(physics::Hydrometeor::kCloud)].optics),
               mu) /
           (4 * std::numbers::pi);
  }

  scene::Scene scene_ = test_support::PlainScene();
  bool in_air_ = false;  // draws a layer with soft faces instead of the slab
  double width_m_ = kWidth_m;
  bool stirred_ = false;
  bool with_gap_ = false;    // the slab has no cloud in the middle half of its width
  double haze_per_m_ = 0.0;  // extinction of the otherwise empty cells
  bool even_light_ = false;  // radiance 1 from everywhere instead of sunlight

 private:
  inline static std::unique_ptr<gl::Context> context_;
};

}  // namespace thunderhead::renderers

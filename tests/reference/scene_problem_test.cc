#include "reference/scene_problem.h"

#include <bit>
#include <cmath>
#include <numbers>

#include "base/half_float.h"
#include "comparisons.h"
#include "glm/geometric.hpp"
#include "glm/vector_relational.hpp"
#include "physics/optics.h"
#include "physics/sky.h"
#include "reference/path_tracer.h"
#include "scene/detailed_medium.h"
#include "storm_store/storm_store.h"
#include "tests/support/techniques.h"
#include "volume/extinction.h"
#include "volume/visible_box.h"

namespace thunderhead::reference {
namespace {

using picture::LinearPicture;

using physics::Hydrometeor;

// Returns a storm of 8 x 7 x 6 cells, with cloud water in cells 2..4 of each axis and rain in the
// lowest layer under it.
volume::HydrometeorFields SmallStorm() {
  volume::HydrometeorFields fields;
  fields.grid = {{8, 7, 6}, {500.0, 400.0, 300.0}, {-2000.0, -1400.0, 100.0}};
  for (const Hydrometeor hydrometeor : {Hydrometeor::kCloud, Hydrometeor::kRain}) {
    volume::HydrometeorField field;
    field.hydrometeor = hydrometeor;
    field.concentration_kg_per_m3.assign(fields.grid.CellCount(), 0.0F);
    fields.fields.push_back(std::move(field));
  }
  for (int z = 0; z < 5; ++z) {
    for (int y = 2; y < 5; ++y) {
      for (int x = 2; x < 5; ++x) {
        const std::size_t offset = fields.grid.Offset(x, y, z);
        const auto amount = 1e-4F * static_cast<float>(1 + x + 2 * y + 3 * z);
        fields.fields[z < 2 ? 1 : 0].concentration_kg_per_m3[offset] = amount;
      }
    }
  }
  fields.condensate = {{2, 2, 0}, {5, 5, 5}};
  return fields;
}

TEST(MediumOf, HasTheDetailThatIsDrawn) {
  const volume::HydrometeorFields fields = SmallStorm();
  const scene::Scene scene;
  const auto medium = *MediumOf(scene, fields, MediumOptions{.detail_voxels_per_cell = 2});
  const auto coarse = *MediumOf(scene, fields, Sides::kOpen);
  const auto detailed = scene::DetailedMedium::Of(scene, fields);
  bool differs = false;
  for (int z = 0; z < 8; ++z) {
    // Compares at the middles of voxels.
    const glm::dvec3 at_m(-875.0, -300.0, 100.0 + 75.0 + 150.0 * z);
    double expected = 0.0;
    for (const float value : detailed->At_per_m(at_m)) expected += static_cast<double>(value);
    EXPECT_NEAR(medium->Extinction_per_m(at_m), expected, 1e-5 * expected) << z;
    differs = differs || std::abs(coarse->Extinction_per_m(at_m) - expected) > 0.01 * expected;
  }
  EXPECT_TRUE(differs);
  EXPECT_FALSE(
      MediumOf(scene, fields, MediumOptions{.sides = Sides::kPeriodic, .detail_voxels_per_cell = 2})
          .ok());
}

TEST(MediumOf, HasTheBoxAndExtinctionThatTheRenderersDraw) {
  const volume::HydrometeorFields fields = SmallStorm();
  const scene::Scene scene;
  std::vector<volume::ExtinctionTerm> terms;
  for (int i = 0; i < 2; ++i) {
    const auto& optics =
        physics::DefaultOptics(fields.fields[static_cast<std::size_t>(i)].hydrometeor);
    terms.push_back(
        {i, physics::MassExtinction_m2_per_kg(optics.density_kg_per_m3, optics.radius_m), 0});
  }
  const volume::ExtinctionVolume drawn = volume::ComputeExtinction(fields, terms, 1);
  const auto medium = *MediumOf(scene, fields, Sides::kOpen);
  EXPECT_EQ(medium->Low_m(), drawn.low_m);
  EXPECT_EQ(medium->High_m(), drawn.high_m);
  for (int z = 0; z < drawn.grid.cells.z; ++z) {
    for (int y = 0; y < drawn.grid.cells.y; ++y) {
      for (int x = 0; x < drawn.grid.cells.x; ++x) {
        const glm::dvec3 centre_m =
            drawn.grid.low_corner_m + (glm::dvec3(x, y, z) + 0.5) * drawn.grid.spacing_m;
        const float here = static_cast<float>(medium->Extinction_per_m(centre_m));
        const std::uint16_t texel = drawn.planes[0].texels[drawn.grid.Offset(x, y, z)];
        // Half floats round to 2^-11, and interpolation in double precision may round to the
        // neighbouring value.
        EXPECT_NEAR(base::HalfFromFloat(here / drawn.extinction_per_m), texel, 1);
      }
    }
  }
}

TEST(MediumOf, PeriodicSpansTheDomain) {
  const volume::HydrometeorFields fields = SmallStorm();
  const auto medium = *MediumOf(scene::Scene(), fields, Sides::kPeriodic);
  EXPECT_TRUE(medium->Periodic());
  EXPECT_EQ(medium->Low_m().x, fields.grid.low_corner_m.x);
  EXPECT_EQ(medium->High_m().y, fields.grid.HighCorner_m().y);
  const glm::dvec3 centre_m =
      fields.grid.low_corner_m + glm::dvec3(3.5, 2.5, 3.5) * fields.grid.spacing_m;
  const auto open = *MediumOf(scene::Scene(), fields, Sides::kOpen);
  EXPECT_DOUBLE_EQ(medium->Extinction_per_m(centre_m), open->Extinction_per_m(centre_m));
  EXPECT_GT(medium->Extinction_per_m(centre_m), 0.0);
}

TEST(MediumOf, FollowsTheScenesFields) {
  const volume::HydrometeorFields fields = SmallStorm();
  scene::Scene scene = test_support::PlainScene();
  const glm::dvec3 cloud_m =
      fields.grid.low_corner_m + glm::dvec3(3.5, 3.5, 3.5) * fields.grid.spacing_m;
  const double whole = (*MediumOf(scene, fields, Sides::kOpen))->Extinction_per_m(cloud_m);
  auto& cloud = scene.fields[physics::IndexOf(Hydrometeor::kCloud)];
  cloud.scale = 0.5F;
  cloud.sizes = physics::SizeSource::kGiven;
  cloud.optics.radius_m *= 2.0F;
  EXPECT_NEAR((*MediumOf(scene, fields, Sides::kOpen))->Extinction_per_m(cloud_m), 0.25 * whole,
              1e-6 * whole);
  cloud.visible = false;
  EXPECT_EQ((*MediumOf(scene, fields, Sides::kOpen))->Extinction_per_m(cloud_m), 0.0);
  scene.fields[physics::IndexOf(Hydrometeor::kRain)].visible = false;
  EXPECT_TRUE(MediumOf(scene, fields, Sides::kOpen).ok());
  EXPECT_TRUE(
      MediumOf(scene, volume::HydrometeorFields{fields.grid, {}, {}, {}}, Sides::kOpen).ok());
}

TEST(MediumOf, TakesTheModelsSizesUnlessToldNotTo) {
  volume::HydrometeorFields fields = SmallStorm();
  const glm::dvec3 cloud_m =
      fields.grid.low_corner_m + glm::dvec3(3.5, 3.5, 3.5) * fields.grid.spacing_m;
  scene::Scene scene = test_support::PlainScene();
  const double plain = (*MediumOf(scene, fields, Sides::kOpen))->Extinction_per_m(cloud_m);
  volume::HydrometeorField& cloud = fields.fields[0];
  std::vector<float> per_radius = cloud.concentration_kg_per_m3;
  for (float& value : per_radius) value /= 5e-6F;  // half the constant radius
  cloud.sizes = volume::SizesOf({volume::SizeOrigin::kEffectiveRadius, "RE_CLOUD"},
                                cloud.concentration_kg_per_m3, per_radius);
  const auto sized = *MediumOf(scene, fields, Sides::kOpen);
  EXPECT_NEAR(sized->Extinction_per_m(cloud_m) / plain, 2.0, 1e-3);
  const double small =
      physics::PhaseColors({physics::PhaseKind::kWaterDroplets, 0.0F, 5e-6F}, 0.9).r;
  EXPECT_NEAR(sized->ScatteringAt(cloud_m, 0.5).phase->Value(0.9).r, small, 1e-3 * small);
  const std::vector<volume::ExtinctionTerm> terms = {
      {0,
       volume::MassExtinctionOf(cloud, scene.fields[0].optics, physics::SizeSource::kModel)
           .m2_per_kg,
       0, true}};
  const volume::ExtinctionVolume drawn = volume::ComputeExtinction(fields, terms, 1);
  EXPECT_NEAR(drawn.maximum_per_m / (1e-4 * 25.0 * 300.0), 1.0, 1e-3) << "of the densest cell";
  scene.fields[0].sizes = physics::SizeSource::kGiven;
  EXPECT_NEAR((*MediumOf(scene, fields, Sides::kOpen))->Extinction_per_m(cloud_m) / plain, 1.0,
              1e-6);
}

TEST(MediumOf, ModesChoosePhaseAndColor) {
  const volume::HydrometeorFields fields = SmallStorm();
  const glm::dvec3 cloud_m =
      fields.grid.low_corner_m + glm::dvec3(3.5, 3.5, 3.5) * fields.grid.spacing_m;
  const glm::dvec3 rain_m =
      fields.grid.low_corner_m + glm::dvec3(3.5, 3.5, 0.4) * fields.grid.spacing_m;
  scene::Scene scene = test_support::PlainScene();
  auto& rain = scene.fields[physics::IndexOf(Hydrometeor::kRain)].optics;
  rain.phase = {physics::PhaseKind::kHenyeyGreenstein, 0.3F};
  rain.albedo = 0.5F;
  scene::MediumSettingsOf(&scene.rendering.technique)->look.false_colors = true;
  auto medium = *MediumOf(scene, fields, Sides::kOpen);
  EXPECT_NEAR(medium->ScatteringAt(rain_m, 0.5).phase->Value(0.2).x,
              physics::PhaseValue(rain.phase, 0.2), 1e-5);
  EXPECT_EQ(medium->ScatteringAt(rain_m, 0.5).weight, 0.5 * glm::dvec3(rain.false_color));
  test_support::SetMode(&scene.rendering.technique, test_support::kUniformPhase);
  medium = *MediumOf(scene, fields, Sides::kOpen);
  const auto& cloud = scene.fields[physics::IndexOf(Hydrometeor::kCloud)].optics;
  const double expected = physics::PhaseColors(physics::PhaseOf(cloud), 0.2).r;
  // The tolerance covers that tables are sampled at 8193 angles.
  EXPECT_NEAR(medium->ScatteringAt(rain_m, 0.5).phase->Value(0.2).x, expected, 1e-3 * expected);
  EXPECT_EQ(medium->ScatteringAt(cloud_m, 0.5).weight, glm::dvec3(cloud.false_color));
}

// MediumOptions::peak_cut_deg cuts off the forward peak of the phase function within this angle,
// and the light of the peak counts as unscattered. Away from the sun the picture stays the same.
// The extinction decreases by the share of the light that is cut off.
TEST(MediumOf, ACutPeakLeavesThePicture) {
  const volume::HydrometeorFields fields = SmallStorm();
  scene::Scene scene = test_support::PlainScene();
  for (scene::FieldParameters& field : scene.fields) {
    field.optics.phase = {physics::PhaseKind::kHenyeyGreenstein, 0.9F};
    field.scale = 0.05F;  // some optical depths
  }
  scene.sun.elevation_deg = 50.0;
  const auto look = [&](double peak_cut_deg, double* extinction_per_m) {
    MediumOptions options;
    options.peak_cut_deg = peak_cut_deg;
    const auto medium = MediumOf(scene, fields, options);
    EXPECT_TRUE(medium.ok()) << medium.status();
    const glm::dvec3 middle_m = 0.5 * ((*medium)->Low_m() + (*medium)->High_m());
    *extinction_per_m = (*medium)->Extinction_per_m(middle_m);
    Surroundings around;
    around.towards_sun = {0.6, 0.0, 0.8};
    around.sun_irradiance = glm::dvec3(1.0);
    const Camera camera = Camera::Parallel(middle_m + glm::dvec3(0.0, 0.0, 5000.0),
                                           {400.0, 0.0, 0.0}, {0.0, 400.0, 0.0}, {0.0, 0.0, -1.0});
    PathTracer tracer(*medium, around, camera, {16, 16}, {});
    RefineLimits limits;
    limits.samples_per_pixel = 2000;
    tracer.Refine(limits, {}, {});
    const LinearPicture image = tracer.Snapshot();
    FluxShare mean;
    for (std::size_t i = 0; i < image.radiance.size(); ++i) {
      mean.value += image.radiance[i].y / 256.0;
      mean.standard_error += std::pow(image.standard_error[i].y / 256.0, 2);
    }
    mean.standard_error = std::sqrt(mean.standard_error);
    return mean;
  };
  double whole_per_m = 0.0;
  double cut_per_m = 0.0;
  const FluxShare whole = look(0.0, &whole_per_m);
  const FluxShare cut = look(3.0, &cut_per_m);
  const double share = physics::CutForwardPeak({physics::PhaseKind::kHenyeyGreenstein, 0.9F},
                                               3.0 * std::numbers::pi / 180)
                           .forward_share;
  EXPECT_GT(share, 0.01);
  EXPECT_NEAR(cut_per_m / whole_per_m, 1.0 - share, 1e-5);
  ExpectAgrees({cut.value - whole.value, std::hypot(cut.standard_error, whole.standard_error)}, 0.0,
               0.005 * whole.value, 0.02 * whole.value);
}

// Without a medium, the shaded ground is as bright as the uniform ground that the renderers draw.
// Both are seen through the same air. The tolerance is 0.3 %, because the skylight on the uniform
// ground is a sum over 1152 directions.
TEST(SurroundingsOf, ShadedGroundWithoutCloudsIsUniform) {
  volume::HydrometeorFields fields = SmallStorm();
  fields.fields.clear();
  scene::Scene scene = test_support::PlainScene();
  scene.sky.brightness = 1.7;
  scene.sun.irradiance = 2.0;
  // The ground is seen from the height of this camera, so the parallel camera below is as high.
  scene.camera = scene::OrbitCamera{{0.0, 0.0, 0.0}, 200.0, 30.0, 4e4, 35.0};
  const auto medium = *MediumOf(scene, fields, Sides::kOpen);
  const Camera camera =
      Camera::Parallel({0.0, 0.0, 2e4}, {}, {}, glm::normalize(glm::dvec3(0.5, 0.3, -0.6)));
  const auto trace = [&](GroundLight light, int samples) {
    PathTracer tracer(medium, SurroundingsOf(scene, fields, light), camera, {8, 8}, {});
    RefineLimits limits;
    limits.samples_per_pixel = samples;
    tracer.Refine(limits, {}, {});
    return tracer.Snapshot();
  };
  const LinearPicture uniform = trace(GroundLight::kUniform, 2);
  const LinearPicture shaded = trace(GroundLight::kShaded, 2000);
  for (int color = 0; color < 3; ++color) {
    double sum = 0.0;
    double squares = 0.0;
    for (std::size_t i = 0; i < shaded.radiance.size(); ++i) {
      sum += shaded.radiance[i][color] / 64.0;
      squares += std::pow(shaded.standard_error[i][color] / 64.0, 2);
    }
    const double expected = uniform.radiance[0][color];
    EXPECT_GT(expected, 0.05);
    ExpectAgrees({sum, std::sqrt(squares)}, expected, 3e-3 * expected, 2e-3 * expected);
  }
}

TEST(SurroundingsOf, SunBelowTheHorizonGivesNoSunlight) {
  scene::Scene scene = test_support::PlainScene();
  scene.sun.elevation_deg = -5.0;
  const Surroundings around = SurroundingsOf(scene, SmallStorm(), GroundLight::kShaded);
  EXPECT_EQ(around.sun_irradiance, glm::dvec3(0.0));
  const glm::dvec3 sky = around.sky(glm::normalize(glm::dvec3(0.3, 0.2, 0.1)));
  EXPECT_TRUE(glm::all(glm::greaterThan(sky, glm::dvec3(0.0))));
}

// In the sample storm under sunlight alone, all values must be finite. The middle of its optically
// thick sunlit side must be brighter than that of the other side.
TEST(Scene, SampleStorm) {
  const auto store =
      storm_store::StormStore::Open({THUNDERHEAD_SOURCE_DIR "/samples/supercell.nc"}, {});
  ASSERT_TRUE(store.ok()) << store.status();
  const auto fields = (*store)->Get((*store)->Storms().front()->id, 1, {});
  ASSERT_TRUE(fields.ok()) << fields.status();
  scene::Scene scene = test_support::PlainScene();
  scene.output = {16, 9, 88};
  scene.sky = {0.0, 0.0};
  const volume::WorldBox box = volume::VisibleBox(**fields);
  const auto mean_from = [&](double azimuth_deg) {
    scene::OrbitCamera camera;
    camera.azimuth_deg = azimuth_deg;
    camera = scene::Framing(camera, box.low_m, box.high_m, 16.0 / 9.0);
    camera.field_of_view_deg = 4.0;
    scene.camera = camera;
    PathTracer tracer(*MediumOf(scene, **fields, Sides::kOpen),
                      SurroundingsOf(scene, **fields, GroundLight::kShaded),
                      CameraOf(scene, **fields), {16, 9}, {});
    RefineLimits limits;
    limits.samples_per_pixel = 64;
    tracer.Refine(limits, {}, {});
    double sum = 0.0;
    for (const glm::vec3& radiance : tracer.Snapshot().radiance) {
      EXPECT_TRUE(std::isfinite(radiance.x) && radiance.x >= 0.0F);
      sum += radiance.y;
    }
    return sum / 144.0;
  };
  EXPECT_GT(mean_from(scene.sun.azimuth_deg), 1.1 * mean_from(scene.sun.azimuth_deg + 180.0));
}

}  // namespace
}  // namespace thunderhead::reference

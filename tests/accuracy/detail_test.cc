// Tests of turbulent detail as every renderer draws it, compared with the noise evaluated on the
// CPU.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "gtest/gtest.h"
#include "physics/detail_tile.h"
#include "tests/accuracy/slab_view.h"
#include "tests/support/techniques.h"
#include "volume/detail_control.h"
#include "volume/water_paths.h"

namespace thunderhead::renderers {
namespace {

class DetailInSlab : public SlabView, public testing::WithParamInterface<accuracy::PlainTechnique> {
 protected:
  void SetUp() override {
    test_support::SetTechnique(&scene_.rendering.technique, GetParam());
    test_support::SetMode(&scene_.rendering.technique, test_support::kWithDetail);
    test_support::SetTransport(&scene_.rendering.technique,
                               scene::Transport::kPaper);  // does not scale the extinction
    scene::SetSlices(&scene_.rendering.technique, 512);
  }

  // The medium in the form in which it is uploaded to the device: the extinction of each cell
  // relative to the slab's, and a factor for each column.
  struct Kept {
    volume::RegularGrid grid;
    std::vector<float> factors;
    std::vector<float> columns;

    // Interpolates the values horizontally. They are the same at all levels, except that columns
    // are rounded to bytes.
    double Of(const std::vector<float>& values, const glm::dvec3& world_m) const {
      const glm::dvec3 from_middle = (world_m - grid.low_corner_m) / grid.spacing_m - 0.5;
      const glm::dvec3 low = glm::floor(from_middle);
      const glm::dvec3 share = from_middle - low;
      const auto cell = [&](int x, int y) {
        return double{values[grid.Offset(int(low.x) + x, int(low.y) + y, 0)]};
      };
      return glm::mix(glm::mix(cell(0, 0), cell(1, 0), share.x),
                      glm::mix(cell(0, 1), cell(1, 1), share.x), share.y);
    }
  };

  Kept KeptBy(const scene::Detail& detail) const {
    const volume::HydrometeorFields fields = Fields(kDepth);
    const Medium medium = scene::GroupedFieldsOf(scene_, fields);
    volume::ExtinctionVolume volume = volume::ComputeExtinction(fields, medium.terms, 1);
    volume::DetailControl control = volume::DetailControlOf(fields, medium.terms, volume);
    const std::uint16_t before = volume.planes[0].texels[0];
    const physics::DetailTile tile = physics::MakeDetailTile(detail.octaves, detail.seed);
    volume::PlacedDetail placed;
    placed.layers = {
        {&tile, detail.wavelength_m * double{physics::DetailTile::kWaves}, {detail.share}}};
    placed.warp_m = physics::DetailWarp_m(volume.grid.spacing_m, detail.wavelength_m);
    placed.fibres = physics::FibresAlong({0.0, 0.0});
    volume::KeepWaterPaths(placed, &control, &volume);
    Kept kept{volume.grid, {}, {}};
    for (const volume::DetailTexel& texel : control) {
      kept.columns.push_back(
          physics::glsl::detail_column_factor(static_cast<float>(texel.column) / 255.0F));
    }
    for (const std::uint16_t after : volume.planes[0].texels) {
      kept.factors.push_back(FloatOf(after) / FloatOf(before));
    }
    return kept;
  }

  static float FloatOf(std::uint16_t half) {  // for normal numbers only
    return std::ldexp(static_cast<float>(1024 + (half & 1023)), (half >> 10) - 25);
  }

  // Returns the mean factor of the medium along the middle ray, by the midpoint rule.
  double MeanFactor(const scene::Detail& detail, double elevation_deg) const {
    const Kept kept = KeptBy(detail);
    const physics::DetailTile tile = physics::MakeDetailTile(detail.octaves, detail.seed);
    const double tile_m = detail.wavelength_m * double{physics::DetailTile::kWaves};
    const glm::dmat3 fibres = physics::FibresAlong({0.0, 0.0});
    const glm::vec2 control(1.0F, Amplitude());
    const glm::dvec3 warp_m = double{physics::glsl::detail_warp_share(1.0F, Amplitude())} *
                              physics::DetailWarp_m(kept.grid.spacing_m, detail.wavelength_m);
    const glm::dvec3 direction = scene::Direction(kViewAzimuth_deg, elevation_deg);
    const double half_m = kHeight_m / 2 / direction.z;
    constexpr int kPoints = 4000;
    double sum = 0.0;
    for (int i = 0; i < kPoints; ++i) {
      const double way_m = ((i + 0.5) / kPoints * 2.0 - 1.0) * half_m;
      const glm::dvec3 world_m = glm::dvec3(0.0, 0.0, kHeight_m / 2) + way_m * direction;
      const glm::dvec4 noise = physics::DetailNoiseAt(tile, fibres * (world_m / tile_m));
      const double change =
          double{physics::glsl::detail_factor(control, static_cast<float>(noise.x), 0.0F)} - 1.0;
      const glm::dvec3 displaced_m = world_m + warp_m * glm::dvec3(noise.y, noise.z, noise.w);
      sum += (1.0 + double{detail.share} * change) * kept.Of(kept.factors, displaced_m) *
             kept.Of(kept.columns, world_m);
    }
    return sum / kPoints;
  }

  static constexpr double kDepth = 3.0;

  // Returns the stored amplitude of the detail. Over 200 m the slab's optical depth is 0.6, and the
  // amplitude is then 0.435 of the turbulence, which is 76 of 255.
  static float Amplitude() { return -16.0F / 127.0F; }
};

TEST_P(DetailInSlab, IsAtRestInTheWorld) {
  // In every view the optical depth must match the noise at the ray's points in world coordinates.
  stirred_ = true;
  scene::FieldParameters& ice = scene_.fields[physics::IndexOf(physics::Hydrometeor::kIce)];
  ice.optics = scene_.fields[0].optics;
  ice.sizes = physics::SizeSource::kGiven;
  double least = 1e9;
  double largest = 0.0;
  for (const float share : {1.0F, 0.3F}) {
    for (const double elevation_deg : {89.9, 60.0, 45.0}) {
      ice.detail = {.share = share, .wavelength_m = 700.0F, .octaves = 2, .seed = 5};
      const double path = 1.0 / std::sin(elevation_deg * std::numbers::pi / 180);
      const double seen =
          -std::log(Look(kDepth, elevation_deg, 80.0).transmittance) / path / kDepth;
      least = std::min(least, seen);
      largest = std::max(largest, seen);
      // The tolerance has three causes. The middle pixel is 0.2 degrees wide, or 20 m of the
      // wavelength's 700 m. Half-angle slices count in full at the slab's faces. llvmpipe
      // interpolates 8-bit textures with 8 bits.
      EXPECT_NEAR(seen, MeanFactor(ice.detail, elevation_deg), 0.006)
          << share << " " << elevation_deg;
      // The column's water path is kept, except for what moves to neighbouring columns.
      if (elevation_deg > 89.0) {
        EXPECT_NEAR(seen, 1.0, 0.02) << share;
      }
    }
  }
  EXPECT_GT(largest - least, 0.02);
}

TEST_P(DetailInSlab, OtherModesDoNotHaveIt) {
  stirred_ = true;
  scene::FieldParameters& ice = scene_.fields[physics::IndexOf(physics::Hydrometeor::kIce)];
  ice.optics = scene_.fields[0].optics;
  ice.sizes = physics::SizeSource::kGiven;
  test_support::SetMode(&scene_.rendering.technique, test_support::kPerFieldPhase);
  ice.detail = {.share = 1.0F, .wavelength_m = 700.0F, .octaves = 2, .seed = 5};
  EXPECT_NEAR(-std::log(Look(1.0, 89.9, 80.0).transmittance), 1.0, 0.01);
}

INSTANTIATE_TEST_SUITE_P(Renderers, DetailInSlab,
                         testing::Values(test_support::kHalfAngle, test_support::kLightVolume),
                         [](const auto& renderer) {
                           return renderer.param == test_support::kHalfAngle ? "HalfAngle"
                                                                             : "LightVolume";
                         });

}  // namespace
}  // namespace thunderhead::renderers

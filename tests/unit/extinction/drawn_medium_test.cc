#include "volume/drawn_medium.h"

#include <cmath>

#include "gtest/gtest.h"
#include "volume/hydrometeor_fields.h"

namespace thunderhead::volume {
namespace {

// The noise moves with the wind: each place now has the noise that was upwind of this place before.
TEST(DrawnMedium, DetailMovesWithTheWind) {
  HydrometeorFields fields;
  fields.grid.cells = glm::ivec3(24, 24, 8);
  fields.grid.spacing_m = glm::dvec3(500.0, 500.0, 200.0);
  fields.condensate = {glm::ivec3(0), fields.grid.cells};
  fields.fields.resize(1);
  fields.fields[0].concentration_kg_per_m3.assign(fields.grid.CellCount(), 1e-3F);
  const ExtinctionVolume volume = ComputeExtinction(fields, {{0, 100.0F, 0, false}}, 1);
  // Every cell is at the surface of billows.
  const DetailControl control(volume.grid.CellCount(),
                              {.profile = 128, .amplitude = 255, .occupied = 255});
  const physics::DetailTile tile = physics::MakeDetailTile(4, 1);
  PlacedDetail detail;
  detail.layers = {{&tile, 12e3, {1.0F}}};
  detail.warp_m = glm::dvec3(200.0, 200.0, 100.0);
  const DrawnMedium still(control, detail, volume);
  detail.layers[0].drift_m = {1000.0, -500.0};
  const DrawnMedium drifted(control, detail, volume);
  int differ = 0;
  for (int x = 3; x < 18; ++x) {
    for (int z = 1; z < 7; ++z) {
      const glm::vec3 place = glm::vec3(x, 0.5F * static_cast<float>(x) + 5.0F, z) + 0.25F;
      const float before = still.At(place)[0];
      EXPECT_NEAR(drifted.At(place + glm::vec3(2.0F, -1.0F, 0.0F))[0], before,
                  1e-3F * (before + 1.0F));
      if (std::abs(drifted.At(place)[0] - before) > 0.05F * before) ++differ;
    }
  }
  EXPECT_GT(differ, 20);
}

// The result must not depend on the processor's instructions.
TEST(DrawnMedium, EightPlacesHaveWhatEachHas) {
  for (const int channels : {1, 2, 3, 5}) {
    HydrometeorFields fields;
    fields.grid.cells = glm::ivec3(9, 7, 5);
    fields.grid.spacing_m = glm::dvec3(500.0, 400.0, 300.0);
    fields.condensate = {glm::ivec3(0), fields.grid.cells};
    std::vector<ExtinctionTerm> terms;
    for (int channel = 0; channel < channels; ++channel) {
      HydrometeorField& field = fields.fields.emplace_back();
      for (std::size_t i = 0; i < fields.grid.CellCount(); ++i) {
        field.concentration_kg_per_m3.push_back(static_cast<float>((7 * i + 3) % 11) * 1e-4F);
      }
      terms.push_back({channel, 50.0F + 10.0F * static_cast<float>(channel), channel, false});
    }
    const ExtinctionVolume volume = ComputeExtinction(fields, terms, channels);
    DetailControl control(volume.grid.CellCount());
    for (std::size_t i = 0; i < control.size(); ++i) {
      control[i].profile = static_cast<std::uint8_t>((31 * i) % 256);
      control[i].occupied = i % 3 == 0 ? 0 : 255;
      control[i].amplitude = static_cast<std::uint8_t>((57 * i) % 255 + 1);
      control[i].column = static_cast<std::uint8_t>((13 * i) % 256);
    }
    const physics::DetailTile tile = physics::MakeDetailTile(2, 1);
    PlacedDetail detail;
    detail.layers = {{&tile, 12e3, {1.0F, 0.5F, 0.0F, 1.0F, 0.25F}},
                     {&tile, 5e3, {0.0F, 0.5F, 1.0F, 0.0F, 0.75F}}};
    detail.warp_m = glm::dvec3(200.0, 200.0, 100.0);
    detail.fibres = physics::FibresAlong({20.0, -10.0});
    const DrawnMedium medium(control, detail, volume);
    double sum = 0.0;
    for (int batch = 0; batch < 50; ++batch) {
      DrawnMedium::Places places;
      for (std::size_t place = 0; place < base::kSimdWidth; ++place) {
        const auto k = static_cast<float>(batch * 8 + static_cast<int>(place));
        // Some places are beyond the grid.
        places.x[place] = std::fmod(0.755F * k, 10.0F) - 0.5F;
        places.y[place] = std::fmod(0.57F * k, 8.0F) - 0.5F;
        places.z[place] = std::fmod(0.31F * k, 6.0F) - 0.5F;
      }
      DrawnMedium::ChannelsAt together;
      medium.At(places, &together);
      for (std::size_t place = 0; place < base::kSimdWidth; ++place) {
        const DrawnMedium::Channels alone =
            medium.At({places.x[place], places.y[place], places.z[place]});
        for (std::size_t channel = 0; channel < alone.size(); ++channel) {
          EXPECT_FLOAT_EQ(together[channel][place], alone[channel]) << channels;
          sum += double{alone[channel]};
        }
      }
    }
    EXPECT_GT(sum, 1.0);
  }
}

}  // namespace
}  // namespace thunderhead::volume

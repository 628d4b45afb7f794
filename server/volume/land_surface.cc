#include "volume/land_surface.h"

#include <algorithm>
#include <cmath>

#include "base/srgb.h"
#include "base/status.h"
#include "glm/common.hpp"
#include "glm/geometric.hpp"

namespace thunderhead::volume {
namespace {

constexpr glm::vec3 kLuminance(0.2126F, 0.7152F, 0.0722F);  // ITU-R BT.709
constexpr int kShoreCells = 2;  // number of cells by which the land's colour extends over water

float Decoded(std::uint8_t byte) { return static_cast<float>(base::LinearOfSrgbByte(byte)); }

std::uint8_t Encoded(float linear) {
  const double coded = base::SrgbOfLinear(std::clamp(linear, 0.0F, 1.0F));
  return static_cast<std::uint8_t>(std::lround(255.0 * coded));
}

float ValueOf(const std::vector<float>& values, std::size_t i) {
  return values.empty() ? std::nanf("") : values[i];
}

// Gives water next to land the mean colour of the land around it. Each pass reaches one cell
// further.
void SpreadColors(const glm::ivec2& cells, std::vector<glm::vec3>& colors,
                  std::vector<bool>& known) {
  for (int pass = 0; pass < kShoreCells; ++pass) {
    const std::vector<bool> before = known;
    for (int y = 0; y < cells.y; ++y) {
      for (int x = 0; x < cells.x; ++x) {
        const auto at = [&](int i, int j) { return static_cast<std::size_t>(j * cells.x + i); };
        if (before[at(x, y)]) continue;
        glm::vec3 sum(0.0F);
        float count = 0.0F;
        for (int j = std::max(y - 1, 0); j <= std::min(y + 1, cells.y - 1); ++j) {
          for (int i = std::max(x - 1, 0); i <= std::min(x + 1, cells.x - 1); ++i) {
            if (!before[at(i, j)]) continue;
            sum += colors[at(i, j)];
            count += 1.0F;
          }
        }
        if (count == 0.0F) continue;
        colors[at(x, y)] = sum / count;
        known[at(x, y)] = true;
      }
    }
  }
}

}  // namespace

LandSurface MakeLandSurface(const LandColumns& columns, const glm::ivec2& cells) {
  const auto count = static_cast<std::size_t>(cells.x) * static_cast<std::size_t>(cells.y);
  THUNDERHEAD_CHECK(columns.land_use.size() == count, "one class a column");
  std::vector<glm::vec3> colors(count);
  std::vector<bool> is_land(count);
  double albedo = 0.0;
  glm::dvec3 sum(0.0);
  double land_cells = 0.0;
  for (std::size_t i = 0; i < count; ++i) {
    const float index = columns.land_use[i];
    const physics::LandUse use = physics::LandUseOf(
        columns.scheme, std::isfinite(index) ? static_cast<int>(std::lround(index)) : 0);
    const float water = ValueOf(columns.water, i);
    is_land[i] = std::isfinite(water) ? water <= 0.5F : !use.water;
    if (is_land[i]) {
      // If the file's water variable says land but the class says water, the column is a shore or
      // sea ice. Class 0 (unknown) then replaces the class.
      const physics::LandUse dry = use.water ? physics::LandUseOf(columns.scheme, 0) : use;
      colors[i] = physics::LandReflectance(
          dry, {ValueOf(columns.albedo, i), ValueOf(columns.green_percent, i),
                ValueOf(columns.snow_share, i)});
      albedo += glm::dot(colors[i], kLuminance);
      sum += glm::dvec3(colors[i]);
      land_cells += 1.0;
    } else {
      const float known = ValueOf(columns.albedo, i);
      const float of_water = physics::LandUseOf(physics::LandUseScheme::kUsgs, 16).albedo;
      albedo += known > 0.0F && known <= 1.0F ? known : of_water;
    }
  }
  LandSurface land;
  land.mean_albedo = albedo / static_cast<double>(std::max<std::size_t>(count, 1));
  land.mean_reflectance = land_cells > 0.0 ? glm::vec3(sum / land_cells) : glm::vec3(0.1F);
  std::vector<bool> known = is_land;
  SpreadColors(cells, colors, known);
  land.texels.reserve(count);
  for (std::size_t i = 0; i < count; ++i) {
    const glm::vec3 color = known[i] ? colors[i] : land.mean_reflectance;
    land.texels.emplace_back(Encoded(color.x), Encoded(color.y), Encoded(color.z),
                             is_land[i] ? 0 : 255);
  }
  return land;
}

LandSample LandAt(const LandSurface& land, const RegularGrid& grid, const glm::dvec2& place_m) {
  const glm::ivec2 cells(grid.cells);
  const glm::dvec2 place = (place_m - glm::dvec2(grid.low_corner_m)) / glm::dvec2(grid.spacing_m);
  const glm::dvec2 held = glm::clamp(place - 0.5, glm::dvec2(0.0), glm::dvec2(cells - 1));
  const glm::ivec2 low(glm::floor(held));
  const glm::ivec2 high = glm::min(low + 1, cells - 1);
  const glm::vec2 share(held - glm::dvec2(low));
  const auto texel = [&](int x, int y) {
    const glm::u8vec4& bytes = land.texels[static_cast<std::size_t>(y * cells.x + x)];
    return glm::vec4(Decoded(bytes.x), Decoded(bytes.y), Decoded(bytes.z),
                     static_cast<float>(bytes.w) / 255.0F);
  };
  const glm::vec4 mixed =
      glm::mix(glm::mix(texel(low.x, low.y), texel(high.x, low.y), share.x),
               glm::mix(texel(low.x, high.y), texel(high.x, high.y), share.x), share.y);
  const glm::dvec2 outside = glm::max(glm::max(-place, place - glm::dvec2(cells)), 0.0);
  const float faded =
      1.0F - std::exp(-static_cast<float>(std::max(outside.x, outside.y)) / kLandFades_cells);
  return {glm::mix(glm::vec3(mixed), land.mean_reflectance, faded),
          std::clamp((mixed.w - 0.5F) / kCoast_cells + 0.5F, 0.0F, 1.0F)};
}

}  // namespace thunderhead::volume

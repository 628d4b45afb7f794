#include "physics/land_use.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>

#include "glm/common.hpp"
#include "glm/geometric.hpp"
#include "physics/optics.h"

namespace thunderhead::physics {
namespace {

constexpr float kSnowAlbedo = 0.7F;  // albedo of settled snow
constexpr float kAllGreen_percent = 70.0F;
constexpr glm::vec3 kDry(1.25F, 0.98F, 0.62F);
constexpr glm::vec3 kSnow(0.99F, 1.0F, 1.03F);

enum Look {
  kUrban,
  kCrops,
  kIrrigated,
  kGrass,
  kShrub,
  kDeciduous,
  kEvergreen,
  kWetland,
  kBarren,
  kTundra,
  kIce,
  kWater
};

struct Appearance {
  glm::vec3 color;
  bool ripens;
};

constexpr std::array<Appearance, 12> kLooks = {{
    {{1.03F, 0.99F, 0.96F}, false},  // urban
    {{0.95F, 1.02F, 0.58F}, true},   // crops
    {{0.70F, 1.10F, 0.50F}, true},   // irrigated crops
    {{1.00F, 1.02F, 0.62F}, true},   // grass
    {{1.12F, 0.99F, 0.72F}, true},   // shrub, savanna
    {{0.66F, 1.12F, 0.48F}, true},   // deciduous forest
    {{0.62F, 1.12F, 0.62F}, false},  // evergreen forest
    {{0.78F, 1.07F, 0.70F}, false},  // wetland
    {{1.28F, 0.97F, 0.66F}, false},  // barren
    {{1.05F, 1.00F, 0.80F}, false},  // tundra
    {kSnow, false},
    {{0.30F, 1.00F, 2.00F}, false},  // water
}};

struct LandUseRow {
  Look look;
  float albedo;
};

constexpr std::array<LandUseRow, 24> kUsgs = {{
    {kUrban, 0.15F},     {kCrops, 0.17F},     {kIrrigated, 0.18F}, {kCrops, 0.18F},
    {kCrops, 0.18F},     {kCrops, 0.16F},     {kGrass, 0.19F},     {kShrub, 0.22F},
    {kShrub, 0.20F},     {kShrub, 0.20F},     {kDeciduous, 0.16F}, {kDeciduous, 0.14F},
    {kEvergreen, 0.12F}, {kEvergreen, 0.12F}, {kEvergreen, 0.13F}, {kWater, 0.08F},
    {kWetland, 0.14F},   {kWetland, 0.14F},   {kBarren, 0.25F},    {kTundra, 0.15F},
    {kTundra, 0.15F},    {kTundra, 0.15F},    {kBarren, 0.25F},    {kIce, 0.55F},
}};

constexpr std::array<LandUseRow, 21> kModis = {{
    {kEvergreen, 0.12F}, {kEvergreen, 0.12F}, {kDeciduous, 0.14F}, {kDeciduous, 0.16F},
    {kEvergreen, 0.13F}, {kShrub, 0.22F},     {kShrub, 0.20F},     {kShrub, 0.20F},
    {kShrub, 0.20F},     {kGrass, 0.19F},     {kWetland, 0.14F},   {kCrops, 0.17F},
    {kUrban, 0.15F},     {kCrops, 0.18F},     {kIce, 0.55F},       {kBarren, 0.25F},
    {kWater, 0.08F},     {kTundra, 0.15F},    {kTundra, 0.15F},    {kBarren, 0.25F},
    {kWater, 0.08F},
}};

constexpr LandUseRow kUnknown = {kGrass, 0.19F};

glm::vec3 OfLuminanceOne(const glm::vec3& color) {
  return color / glm::dot(color, glm::vec3(kLuminance));
}

}  // namespace

LandUse LandUseOf(LandUseScheme scheme, int index) {
  const std::span<const LandUseRow> rows = scheme == LandUseScheme::kUsgs
                                               ? std::span<const LandUseRow>(kUsgs)
                                               : std::span<const LandUseRow>(kModis);
  const bool known = index >= 1 && index <= static_cast<int>(rows.size());
  const LandUseRow& row = known ? rows[static_cast<std::size_t>(index) - 1] : kUnknown;
  const Appearance& look = kLooks[row.look];
  return {OfLuminanceOne(look.color), row.albedo, row.look == kWater, look.ripens};
}

glm::vec3 LandReflectance(const LandUse& use, const LandState& state) {
  glm::vec3 hue = use.hue;
  if (use.ripens && std::isfinite(state.green_percent)) {
    const float green = std::clamp(state.green_percent / kAllGreen_percent, 0.0F, 1.0F);
    hue = OfLuminanceOne(glm::mix(kDry, hue, green));
  }
  const float snow =
      std::isfinite(state.snow_share) ? std::clamp(state.snow_share, 0.0F, 1.0F) : 0.0F;
  const bool known = std::isfinite(state.albedo) && state.albedo > 0.0F && state.albedo <= 1.0F;
  const float albedo = known ? state.albedo : glm::mix(use.albedo, kSnowAlbedo, snow);
  // The hue is weighted by reflected light, because snow reflects more than the uncovered ground.
  const float of_snow = snow * kSnowAlbedo;
  const float of_rest = (1.0F - snow) * use.albedo;
  const glm::vec3 mixed = (of_snow * OfLuminanceOne(kSnow) + of_rest * hue) / (of_snow + of_rest);
  return glm::min(albedo * mixed, glm::vec3(1.0F));
}

}  // namespace thunderhead::physics

#include "volume/drawn_medium.h"

#include <algorithm>

#include "base/half_float.h"
#include "glm/common.hpp"
#include "glm/vec2.hpp"
#include "glm/vector_relational.hpp"

namespace thunderhead::volume {
namespace {

// Rounded down. Faster than floor, which is a call without SSE 4.1.
glm::ivec3 Floor(const glm::vec3& value) {
  const glm::ivec3 towards_zero(value);
  return towards_zero - glm::ivec3(glm::lessThan(value, glm::vec3(towards_zero)));
}

// Weights of a linear interpolation between the corners of a cube; along x, then y, then z.
std::array<float, 8> Weights(const glm::vec3& share) {
  const glm::vec3 rest = 1.0F - share;
  std::array<float, 8> weights;
  for (std::size_t i = 0; i < weights.size(); ++i) {
    weights[i] = ((i & 1U) != 0 ? share.x : rest.x) * ((i & 2U) != 0 ? share.y : rest.y) *
                 ((i & 4U) != 0 ? share.z : rest.z);
  }
  return weights;
}

}  // namespace

DrawnMedium::DrawnMedium(const DetailControl& control, const PlacedDetail& detail,
                         const ExtinctionVolume& volume)
    : control_(control),
      volume_(volume),
      warp_(detail.warp_m / volume.grid.spacing_m),
      fibres_(detail.fibres) {
  const glm::ivec3 last = volume.grid.cells - 1;
  for (int i = 0; i < static_cast<int>(kCorners); ++i) {
    const glm::ivec3 corner = glm::min(glm::ivec3(i & 1, i >> 1 & 1, i >> 2), last);
    corners_[static_cast<std::size_t>(i)] = volume.grid.Offset(corner.x, corner.y, corner.z);
  }
  for (const PlacedDetail::Layer& layer : detail.layers) {
    Channels shares{};
    std::copy(layer.shares.begin(), layer.shares.end(), shares.begin());
    layers_.push_back(
        {layer.tile->texels.data(),
         glm::vec3((volume.grid.low_corner_m - glm::dvec3(layer.drift_m, 0.0)) / layer.tile_m),
         glm::vec3(volume.grid.spacing_m / layer.tile_m), shares});
  }
}

DrawnMedium::Place DrawnMedium::PlaceAt(const glm::vec3& in_cells) const {
  const glm::ivec3& size = volume_.grid.cells;
  const glm::vec3 from_middle = glm::clamp(in_cells - 0.5F, glm::vec3(0.0F), glm::vec3(size - 1));
  const glm::ivec3 low = glm::clamp(glm::ivec3(from_middle), glm::ivec3(0), glm::max(size - 2, 0));
  return {volume_.grid.Offset(low.x, low.y, low.z), Weights(from_middle - glm::vec3(low))};
}

DrawnMedium::Channels DrawnMedium::At(const glm::vec3& in_cells) const {
  Channels values{};
  const Place here = PlaceAt(in_cells);
  glm::vec3 displaced = in_cells;
  Channels factors;
  factors.fill(1.0F);
  if (!layers_.empty()) {
    glm::vec3 bytes(0.0F);
    for (std::size_t i = 0; i < kCorners; ++i) {
      const DetailTexel& texel = control_[here.cell + corners_[i]];
      bytes += here.weights[i] * glm::vec3(texel.profile, texel.amplitude, texel.column);
    }
    // Empty, and nothing is displaced to where it is.
    if (bytes.x <= 0.0F) return values;
    factors.fill(physics::glsl::detail_column_factor(bytes.z / 255.0F));
    const glm::vec2 control(bytes.x / 255.0F, (bytes.y - 128.0F) / 127.0F);
    for (const Layer& layer : layers_) {
      const glm::vec4 noise = NoiseAt(layer, in_cells, control.y < 0.0F);
      if (&layer == layers_.data()) {
        displaced += physics::glsl::detail_warp_share(control) * warp_ *
                     (2.0F * glm::vec3(noise.y, noise.z, noise.w) - 1.0F);
      }
      const float change = physics::glsl::detail_factor(control, noise.x, 0.0F) - 1.0F;
      for (std::size_t i = 0; i < factors.size(); ++i) {
        factors[i] *= 1.0F + change * layer.shares[i];
      }
    }
  }
  const Place from = PlaceAt(displaced);
  std::size_t first = 0;
  for (const ExtinctionPlane& plane : volume_.planes) {
    const float* of_plane = factors.data() + first;
    if (plane.channels == 1) AddPlane<1>(plane, from, of_plane, values.data() + first);
    if (plane.channels == 2) AddPlane<2>(plane, from, of_plane, values.data() + first);
    if (plane.channels == 4) AddPlane<4>(plane, from, of_plane, values.data() + first);
    first += static_cast<std::size_t>(plane.channels);
  }
  return values;
}

template <std::size_t kPlaneChannels>
void DrawnMedium::AddPlane(const ExtinctionPlane& plane, const Place& from, const float* factors,
                           float* values) const {
  std::array<float, kPlaneChannels> sums{};
  for (std::size_t i = 0; i < kCorners; ++i) {
    const std::uint16_t* texel = plane.texels.data() + kPlaneChannels * (from.cell + corners_[i]);
    for (std::size_t channel = 0; channel < kPlaneChannels; ++channel) {
      sums[channel] += from.weights[i] * base::FloatFromHalf(texel[channel]);
    }
  }
  for (std::size_t channel = 0; channel < kPlaneChannels; ++channel) {
    values[channel] = factors[channel] * sums[channel];
  }
}

glm::vec4 DrawnMedium::NoiseAt(const Layer& layer, const glm::vec3& in_cells, bool fibres) const {
  constexpr int kSide = physics::DetailTile::kSide;
  glm::vec3 tile = layer.corner + in_cells * layer.cell;
  if (fibres) tile = fibres_ * tile;
  const glm::vec3 texel = tile * static_cast<float>(kSide) - 0.5F;
  const glm::ivec3 low = Floor(texel);
  const std::array<float, kCorners> weights = Weights(texel - glm::vec3(low));
  const std::array<glm::ivec3, 2> at = {low & (kSide - 1), (low + 1) & (kSide - 1)};
  glm::vec4 sum(0.0F);
  for (std::size_t i = 0; i < kCorners; ++i) {
    const int row = at[i >> 2U].z * kSide + at[i >> 1U & 1U].y;
    const std::uint8_t* bytes = layer.texels + 4 * (row * kSide + at[i & 1U].x);
    sum += weights[i] * glm::vec4(bytes[0], bytes[1], bytes[2], bytes[3]);
  }
  return sum / 255.0F;
}

}  // namespace thunderhead::volume

#include "volume/drawn_medium.h"

#include <algorithm>
#include <cstring>
#include <type_traits>

#include "base/simd.h"
#include "glm/common.hpp"
#include "glm/vec2.hpp"

namespace thunderhead::volume {
namespace {

using base::AnyAbove;
using base::Convert;
using base::EightFloats;
using base::ForEach;
using base::Integers;
using base::Load;
using base::SetAll;

template <typename Floats>
THUNDERHEAD_SIMD void RoundDown(const Floats& value, Integers<Floats>* down, Floats* rest) {
  Floats towards_zero;
  Convert(value, down);
  Convert(*down, &towards_zero);
  const Floats over = value < towards_zero ? Floats{} + 1.0F : Floats{};
  Integers<Floats> less;
  Convert(over, &less);
  *down -= less;
  *rest = value - (towards_zero - over);
}

// Extracts byte `kByte` of each word; byte 0 is the least significant.
template <int kByte, typename Floats>
THUNDERHEAD_SIMD void ByteOf(const Integers<Floats>& word, Floats* value) {
  Convert((word >> (8 * kByte)) & 255, value);
}

// Does the same as base::FloatFromHalf.
template <typename Floats>
THUNDERHEAD_SIMD void FromHalf(const Integers<Floats>& half, Floats* value) {
  *value = __builtin_bit_cast(Floats, half << 13) * 0x1p112F;
}

template <typename Floats>
THUNDERHEAD_SIMD void Limit(float low, float high, Floats* value) {
  *value = *value < low ? Floats{} + low : *value;
  *value = *value > high ? Floats{} + high : *value;
}

}  // namespace

// Evaluates the medium at several places, one per SIMD element.
template <typename Floats>
struct DrawnMedium::Simd {
  using Whole = Integers<Floats>;
  using Weights = std::array<Floats, kCorners>;

  struct Point {
    Floats x, y, z;
  };

  // A linear interpolation between cells.
  struct Place {
    Whole cell;  // the cell with the lowest index
    Weights weights;
  };

  struct Noise {
    Floats billows, x, y, z;
  };

  // Computes the corners' weights, in the order along x, then y, then z.
  THUNDERHEAD_SIMD static void FindWeights(const Point& share, Weights* weights) {
    for (std::size_t i = 0; i < kCorners; ++i) {
      (*weights)[i] = ((i & 1U) != 0 ? share.x : 1.0F - share.x) *
                      ((i & 2U) != 0 ? share.y : 1.0F - share.y) *
                      ((i & 4U) != 0 ? share.z : 1.0F - share.z);
    }
  }

  THUNDERHEAD_SIMD static void FindAlong(const Floats& in_cells, int size, Whole* low,
                                         Floats* share) {
    Floats from_middle = in_cells - 0.5F;
    Limit(0.0F, static_cast<float>(size - 1), &from_middle);
    Convert(from_middle, low);
    const int last = std::max(size - 2, 0);
    *low = *low > last ? Whole{} + last : *low;
    Floats whole;
    Convert(*low, &whole);
    *share = from_middle - whole;
  }

  THUNDERHEAD_SIMD static void FindPlace(const DrawnMedium& medium, const Point& in_cells,
                                         Place* place) {
    const glm::ivec3& size = medium.volume_.grid.cells;
    Point share;
    Whole x, y, z;
    FindAlong(in_cells.x, size.x, &x, &share.x);
    FindAlong(in_cells.y, size.y, &y, &share.y);
    FindAlong(in_cells.z, size.z, &z, &share.z);
    place->cell = (z * size.y + y) * size.x + x;
    FindWeights(share, &place->weights);
  }

  THUNDERHEAD_SIMD static void FindNoise(const DrawnMedium& medium, const Layer& layer,
                                         const Point& in_cells, const Whole& fibres, Noise* noise) {
    constexpr int kSide = physics::DetailTile::kSide;
    Point tile = {layer.corner.x + in_cells.x * layer.cell.x,
                  layer.corner.y + in_cells.y * layer.cell.y,
                  layer.corner.z + in_cells.z * layer.cell.z};
    const glm::mat3& m = medium.fibres_;
    const Point along = {m[0].x * tile.x + m[1].x * tile.y + m[2].x * tile.z,
                         m[0].y * tile.x + m[1].y * tile.y + m[2].y * tile.z,
                         m[0].z * tile.x + m[1].z * tile.y + m[2].z * tile.z};
    tile.x = fibres ? along.x : tile.x;
    tile.y = fibres ? along.y : tile.y;
    tile.z = fibres ? along.z : tile.z;
    Whole x, y, z;
    Point share;
    RoundDown(tile.x * static_cast<float>(kSide) - 0.5F, &x, &share.x);
    RoundDown(tile.y * static_cast<float>(kSide) - 0.5F, &y, &share.y);
    RoundDown(tile.z * static_cast<float>(kSide) - 0.5F, &z, &share.z);
    Weights weights;
    FindWeights(share, &weights);
    for (int i = 0; i < static_cast<int>(kCorners); ++i) {
      const Whole row = ((z + (i >> 2)) & (kSide - 1)) * kSide + ((y + (i >> 1 & 1)) & (kSide - 1));
      const Whole texel = row * kSide + ((x + (i & 1)) & (kSide - 1));
      Whole word;
      Load<std::uint32_t>(layer.texels, 4, texel, &word);
      Add(word, weights[static_cast<std::size_t>(i)] / 255.0F, noise);
    }
  }

  THUNDERHEAD_SIMD static void Add(const Whole& word, const Floats& weight, Noise* noise) {
    Noise bytes;
    ByteOf<0>(word, &bytes.billows);
    ByteOf<1>(word, &bytes.x);
    ByteOf<2>(word, &bytes.y);
    ByteOf<3>(word, &bytes.z);
    noise->billows += weight * bytes.billows;
    noise->x += weight * bytes.x;
    noise->y += weight * bytes.y;
    noise->z += weight * bytes.z;
  }

  // Multiplies `values` by the plane's values.
  template <int kPlaneChannels>
  THUNDERHEAD_SIMD static void Multiply(const DrawnMedium& medium, const ExtinctionPlane& plane,
                                        const Place& from, Floats* values) {
    constexpr int kTogether = kPlaneChannels == 1 ? 1 : 2;  // number of channels that one load
                                                            // reads
    using Number = std::conditional_t<kTogether == 1, std::uint16_t, std::uint32_t>;
    for (int first = 0; first < kPlaneChannels; first += kTogether) {
      Floats low{};
      Floats high{};
      for (std::size_t i = 0; i < kCorners; ++i) {
        Whole number;
        Load<Number>(plane.texels.data() + first, 2 * kPlaneChannels,
                     from.cell + static_cast<std::int32_t>(medium.corners_[i]), &number);
        Floats value;
        FromHalf(number & 0xFFFF, &value);
        low += from.weights[i] * value;
        if constexpr (kTogether == 2) {
          FromHalf(number >> 16, &value);
          high += from.weights[i] * value;
        }
      }
      values[first] *= low;
      if constexpr (kTogether == 2) values[first + 1] *= high;
    }
  }

  // Evaluates the medium. All `values` must be 1 before the call.
  THUNDERHEAD_SIMD static void Evaluate(const DrawnMedium& medium, const Point& in_cells,
                                        std::array<Floats, kMaxChannels>* values) {
    Place here;
    FindPlace(medium, in_cells, &here);
    Point displaced = in_cells;
    if (!medium.layers_.empty()) {
      Floats profile{};
      Floats amplitude{};
      Floats column{};
      Floats occupied{};
      for (std::size_t i = 0; i < kCorners; ++i) {
        Whole word;
        static_assert(sizeof(DetailTexel) == 4);
        Load<std::uint32_t>(medium.control_.data(), 4,
                            here.cell + static_cast<std::int32_t>(medium.corners_[i]), &word);
        Floats byte;
        ByteOf<0>(word, &byte);
        profile += here.weights[i] * byte;
        ByteOf<1>(word, &byte);
        amplitude += here.weights[i] * byte;
        ByteOf<2>(word, &byte);
        column += here.weights[i] * byte;
        ByteOf<3>(word, &byte);
        occupied += here.weights[i] * byte;
      }
      // Nothing is drawn at an empty place, and no medium is displaced into it.
      if (!AnyAbove(0.0F, occupied)) {
        for (Floats& value : *values) value = Floats{};
        return;
      }
      profile /= 255.0F;
      occupied /= 255.0F;
      amplitude = (amplitude - 128.0F) / 127.0F;
      Floats factor = occupied > 0.0F ? column : Floats{};
      ForEach([](float texel) { return physics::glsl::detail_column_factor(texel / 255.0F); },
              &factor, factor);
      for (Floats& value : *values) value *= factor;
      const Whole fibres = amplitude < 0.0F;
      for (const Layer& layer : medium.layers_) {
        Noise noise{};
        FindNoise(medium, layer, in_cells, fibres, &noise);
        if (&layer == medium.layers_.data()) {
          Floats share;
          ForEach([](float o, float a) { return physics::glsl::detail_warp_share(o, a); }, &share,
                  occupied, amplitude);
          displaced.x += share * medium.warp_.x * (2.0F * noise.x - 1.0F);
          displaced.y += share * medium.warp_.y * (2.0F * noise.y - 1.0F);
          displaced.z += share * medium.warp_.z * (2.0F * noise.z - 1.0F);
        }
        Floats change;
        ForEach(
            [](float p, float a, float n) {
              return physics::glsl::detail_factor({p, a}, n, 0.0F) - 1.0F;
            },
            &change, profile, amplitude, noise.billows);
        for (std::size_t i = 0; i < values->size(); ++i) {
          (*values)[i] *= 1.0F + change * layer.shares[i];
        }
      }
    }
    Place from;
    FindPlace(medium, displaced, &from);
    Floats* of_plane = values->data();
    for (const ExtinctionPlane& plane : medium.volume_.planes) {
      if (plane.channels == 1) Multiply<1>(medium, plane, from, of_plane);
      if (plane.channels == 2) Multiply<2>(medium, plane, from, of_plane);
      if (plane.channels == 4) Multiply<4>(medium, plane, from, of_plane);
      of_plane += plane.channels;
    }
    for (; of_plane < values->data() + values->size(); ++of_plane) *of_plane = Floats{};
  }

  // Evaluates places in arrays, one per SIMD element.
  THUNDERHEAD_SIMD static void EvaluateAll(const DrawnMedium& medium, const Places& in_cells,
                                           ChannelsAt* values) {
    Point places;
    static_assert(sizeof(places) == sizeof(in_cells));
    std::memcpy(&places, &in_cells, sizeof(places));
    std::array<Floats, kMaxChannels> all;
    for (Floats& value : all) SetAll(1.0F, &value);
    Evaluate(medium, places, &all);
    std::memcpy(values, all.data(), sizeof(*values));
  }
};

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

DrawnMedium::Channels DrawnMedium::At(const glm::vec3& in_cells) const {
  Channels values;
  values.fill(1.0F);
  Simd<float>::Evaluate(*this, {in_cells.x, in_cells.y, in_cells.z}, &values);
  return values;
}

#if defined(__x86_64__)
[[gnu::target("avx2")]] void DrawnMedium::AtWithAvx2(const Places& in_cells,
                                                     ChannelsAt* values) const {
  Simd<EightFloats>::EvaluateAll(*this, in_cells, values);
}
#endif

void DrawnMedium::At(const Places& in_cells, ChannelsAt* values) const {
#if defined(__x86_64__)
  static const bool kHasAvx2 = __builtin_cpu_supports("avx2") != 0;
  if (kHasAvx2) return AtWithAvx2(in_cells, values);
#endif
  Simd<EightFloats>::EvaluateAll(*this, in_cells, values);
}

}  // namespace thunderhead::volume

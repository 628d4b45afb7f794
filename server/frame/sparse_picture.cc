#include "frame/sparse_picture.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdlib>
#include <string>
#include <utility>

#include "base/status.h"
#include "glm/common.hpp"
#include "glm/vec4.hpp"

namespace thunderhead::frame {
namespace {

constexpr std::size_t kSparseChannels = 3;
constexpr int kRowsInShare = 48;
constexpr int kFineSteps = 257;  // number of FineImage steps in one step of 8 bits

constexpr std::size_t kTaps = 4;

// For each column or row of a finer picture, its position in the previous (coarser) picture.
struct Places {
  std::vector<int> parent;  // column or row of the previous picture that contains it
  // The columns or rows of the previous picture from which it is interpolated, and their weights.
  // The interpolation is cubic convolution with a = -1/2 (Keys 1981, "Cubic convolution
  // interpolation for digital image processing", eq. 15).
  std::vector<std::array<int, kTaps>> taps;
  std::vector<std::array<float, kTaps>> weights;

  Places(int count, int parents) {
    for (int i = 0; i < count; ++i) {
      const double place = (i + 0.5) * parents / count;
      parent.push_back(std::min(static_cast<int>(place), parents - 1));
      const double from = std::clamp(place - 0.5, 0.0, parents - 1.0);
      const int before = static_cast<int>(from);
      const auto t = static_cast<float>(from - before);
      std::array<float, kTaps> weight{
          t * (-0.5F + t * (1.0F - 0.5F * t)), 1.0F + t * t * (-2.5F + 1.5F * t),
          t * (0.5F + t * (2.0F - 1.5F * t)), t * t * (0.5F * t - 0.5F)};
      // Beyond its edges, the picture is extrapolated linearly.
      if (before == 0) Extend(&weight[0], &weight[1], &weight[2]);
      if (before == parents - 2) Extend(&weight[3], &weight[2], &weight[1]);
      weights.push_back(weight);
      std::array<int, kTaps>& tap = taps.emplace_back();
      for (int k = 0; k < static_cast<int>(kTaps); ++k) {
        tap[static_cast<std::size_t>(k)] = std::clamp(before - 1 + k, 0, parents - 1);
      }
    }
  }

 private:
  static void Extend(float* beyond, float* last, float* last_but_one) {
    *last += 2.0F * *beyond;
    *last_but_one -= *beyond;
    *beyond = 0.0F;
  }
};

std::size_t Offset(const glm::ivec2& size_px, int x, int y) {
  return static_cast<std::size_t>(y) * static_cast<std::size_t>(size_px.x) +
         static_cast<std::size_t>(x);
}

// Divides rows into ranges and calls `work` in parallel with the first row of each range and the
// row after its last.
template <typename Work>
void ForShares(int rows, const Work& work) {
  tbb::parallel_for(0, (rows + kRowsInShare - 1) / kRowsInShare, [&](int share) {
    work(share * kRowsInShare, std::min((share + 1) * kRowsInShare, rows));
  });
}

template <typename Work>
void ForRows(int rows, const Work& work) {
  ForShares(rows, [&](int begin, int end) {
    for (int y = begin; y < end; ++y) work(y);
  });
}

const std::uint16_t* RowOf(const FineImage& picture, int y) {
  return picture.rgb.data() + kSparseChannels * Offset({picture.width_px, picture.height_px}, 0, y);
}

// Copies a row of pixels and repeats its first and last pixel at the ends.
void CopyPadded(const FineImage& picture, int y, std::vector<int>* padded) {
  const std::size_t width = kSparseChannels * static_cast<std::size_t>(picture.width_px);
  const std::uint16_t* const row = RowOf(picture, std::clamp(y, 0, picture.height_px - 1));
  padded->resize(width + 2 * kSparseChannels);
  std::copy_n(row, kSparseChannels, padded->begin());
  std::copy_n(row, width, padded->begin() + kSparseChannels);
  std::copy_n(row + width - kSparseChannels, kSparseChannels,
              padded->begin() + static_cast<std::ptrdiff_t>(width + kSparseChannels));
}

// Returns 1 for each rough pixel, and 0 for the others. A pixel is rough if it differs too much
// from the interpolation of its neighbours. The finer picture cannot be interpolated there, so its
// pixels in that place get their own rays.
std::vector<std::uint8_t> Rough(const FineImage& picture, double contrast) {
  const int most = static_cast<int>(std::lround(contrast * kFineSteps));
  const std::size_t width = kSparseChannels * static_cast<std::size_t>(picture.width_px);
  std::vector<std::uint8_t> rough(picture.rgb.size() / kSparseChannels, 0);
  ForShares(picture.height_px, [&](int begin, int end) {
    std::array<std::vector<int>, 3> rows;
    std::vector<int> off(width);
    CopyPadded(picture, begin - 1, &rows[0]);
    CopyPadded(picture, begin, &rows[1]);
    for (int y = begin; y < end; ++y) {
      CopyPadded(picture, y + 1, &rows[2]);
      const int* const above = rows[0].data();
      const int* const here = rows[1].data();
      const int* const below = rows[2].data();
      int* const apart = off.data();
      // The loop is simple enough for the compiler to vectorize it.
      for (std::size_t i = 0; i < width; ++i) {
        const std::size_t middle = i + kSparseChannels;
        const std::size_t right = middle + kSparseChannels;
        const int twice = 2 * here[middle];
        const int across = std::abs(here[i] + here[right] - twice);
        const int up = std::abs(above[middle] + below[middle] - twice);
        const int falling = std::abs(above[i] + below[right] - twice);
        const int rising = std::abs(above[right] + below[i] - twice);
        const int straight = across > up ? across : up;
        const int slanted = falling > rising ? falling : rising;
        apart[i] = straight > slanted ? straight : slanted;
      }
      for (int x = 0; x < picture.width_px; ++x) {
        const int* const pixel = apart + kSparseChannels * static_cast<std::size_t>(x);
        rough[Offset({picture.width_px, picture.height_px}, x, y)] =
            std::max({pixel[0], pixel[1], pixel[2]}) > most ? 1 : 0;
      }
      std::swap(rows[0], rows[1]);
      std::swap(rows[1], rows[2]);
    }
  });
  return rough;
}

// Clamps an interpolated value to the range of its two neighbours. Next to an edge, the
// interpolation would overshoot.
inline float Limited(float value, float before, float after) {
  const float low = before < after ? before : after;
  const float high = before < after ? after : before;
  const float above = value > low ? value : low;
  return above < high ? above : high;
}

// Interpolates row `y` of a picture to the columns of a finer picture. Pixels are stored as four
// values, so that the compiler can vectorize the loop.
void Widen(const FineImage& from, int y, const Places& columns, float* out) {
  thread_local std::vector<glm::vec4> pixels;
  pixels.resize(static_cast<std::size_t>(from.width_px));
  const std::uint16_t* row = RowOf(from, y);
  for (glm::vec4& pixel : pixels) {
    pixel = glm::vec4(row[0], row[1], row[2], 0.0F);
    row += kSparseChannels;
  }
  const glm::vec4* const in = pixels.data();
  for (std::size_t x = 0; x < columns.taps.size(); ++x, out += kSparseChannels) {
    const auto [of_a, of_b, of_c, of_d] = columns.weights[x];
    const auto [a, b, c, d] = columns.taps[x];
    const glm::vec4 sum = (of_a * in[a] + of_b * in[b]) + (of_c * in[c] + of_d * in[d]);
    for (int i = 0; i < static_cast<int>(kSparseChannels); ++i) {
      out[i] = Limited(sum[i], in[b][i], in[c][i]);
    }
  }
}

// Interpolates a finer picture from the pixels of the previous picture.
FineImage Spread(const FineImage& from, const Places& columns, const Places& rows) {
  const std::size_t width = kSparseChannels * columns.taps.size();
  FineImage to{static_cast<int>(columns.taps.size()), static_cast<int>(rows.taps.size()), {}};
  to.rgb.resize(width * rows.taps.size());
  ForShares(to.height_px, [&](int begin, int end) {
    const int first = rows.taps[static_cast<std::size_t>(begin)].front();
    const int last = rows.taps[static_cast<std::size_t>(end) - 1].back();
    thread_local std::vector<float> widened;
    widened.resize(width * static_cast<std::size_t>(last - first + 1));
    const auto wide = [&](int y) {
      return widened.data() + width * static_cast<std::size_t>(y - first);
    };
    for (int y = first; y <= last; ++y) Widen(from, y, columns, wide(y));
    for (int y = begin; y < end; ++y) {
      const auto row = static_cast<std::size_t>(y);
      const auto [a, b, c, d] = rows.taps[row];
      const auto [of_a, of_b, of_c, of_d] = rows.weights[row];
      const std::array<const float*, kTaps> in{wide(a), wide(b), wide(c), wide(d)};
      std::uint16_t* const out = to.rgb.data() + width * row;
      for (std::size_t i = 0; i < width; ++i) {
        const float value =
            Limited((of_a * in[0][i] + of_b * in[1][i]) + (of_c * in[2][i] + of_d * in[3][i]),
                    in[1][i], in[2][i]) +
            0.5F;
        out[i] = static_cast<std::uint16_t>(static_cast<int>(value));
      }
    }
  });
  return to;
}

// Returns the pixels of the finer picture that lie in rough pixels. In the list, neighbouring
// pixels stay close together: squares of two by two pixels, within squares of four by four.
std::vector<glm::ivec2> ChildrenOf(const std::vector<std::uint8_t>& rough,
                                   const glm::ivec2& rough_px, const Places& columns,
                                   const Places& rows) {
  constexpr int kSide = 4;
  std::vector<glm::ivec2> chosen;
  const auto ranges = [](const Places& places, int parents) {
    std::vector<int> first(static_cast<std::size_t>(parents) + 1, 0);
    for (const int parent : places.parent) ++first[static_cast<std::size_t>(parent) + 1];
    for (std::size_t i = 1; i < first.size(); ++i) first[i] += first[i - 1];
    return first;
  };
  const std::vector<int> x_of = ranges(columns, rough_px.x);
  const std::vector<int> y_of = ranges(rows, rough_px.y);
  const auto add = [&](const glm::ivec2& parent) {
    if (parent.x >= rough_px.x || parent.y >= rough_px.y) return;
    if (rough[Offset(rough_px, parent.x, parent.y)] == 0) return;
    const auto i = static_cast<std::size_t>(parent.x);
    const auto j = static_cast<std::size_t>(parent.y);
    for (int y = y_of[j]; y < y_of[j + 1]; ++y) {
      for (int x = x_of[i]; x < x_of[i + 1]; ++x) chosen.emplace_back(x, y);
    }
  };
  for (int square_y = 0; square_y < rough_px.y; square_y += kSide) {
    for (int square_x = 0; square_x < rough_px.x; square_x += kSide) {
      for (int i = 0; i < kSide * kSide; ++i) {
        add({square_x + 2 * (i / 4 % 2) + i % 2, square_y + 2 * (i / 8) + i / 2 % 2});
      }
    }
  }
  return chosen;
}

}  // namespace

glm::ivec2 CoarsestOf(const glm::ivec2& size_px) { return (size_px + 3) / 4; }

absl::StatusOr<FineImage> CompletePicture(FineImage coarsest, const glm::ivec2& size_px,
                                          double contrast, const DrawPlaces& draw) {
  FineImage picture = std::move(coarsest);
  struct Finer {
    glm::ivec2 size_px;
    double contrast;
  };
  for (const auto& [finer_px, most] :
       {Finer{(size_px + 1) / 2, contrast}, Finer{size_px, kLastContrast * contrast}}) {
    const glm::ivec2 before_px(picture.width_px, picture.height_px);
    const Places columns(finer_px.x, before_px.x);
    const Places rows(finer_px.y, before_px.y);
    const std::vector<glm::ivec2> chosen =
        ChildrenOf(Rough(picture, most), before_px, columns, rows);
    picture = Spread(picture, columns, rows);
    if (chosen.empty()) continue;
    std::vector<glm::vec2> places;
    places.reserve(chosen.size());
    for (const glm::ivec2& pixel : chosen) {
      const glm::vec2 place = 2.0F * (glm::vec2(pixel) + 0.5F) / glm::vec2(finer_px) - 1.0F;
      places.emplace_back(place.x, -place.y);
    }
    THUNDERHEAD_ASSIGN_OR_RETURN(const std::vector<std::uint16_t> colors, draw(places));
    THUNDERHEAD_CHECK(colors.size() == kSparseChannels * places.size(),
                      std::to_string(colors.size()));
    for (std::size_t i = 0; i < chosen.size(); ++i) {
      const std::size_t at = Offset(finer_px, chosen[i].x, chosen[i].y);
      std::copy_n(colors.begin() + static_cast<std::ptrdiff_t>(kSparseChannels * i),
                  kSparseChannels,
                  picture.rgb.begin() + static_cast<std::ptrdiff_t>(kSparseChannels * at));
    }
  }
  return picture;
}

// The dither noise is fract(52.9829189 fract(0.06711056 x + 0.00583715 y)), computed in units of
// 2^-32.
std::vector<std::uint8_t> Dithered(const FineImage& picture) {
  constexpr double kWhole = 4294967296.0;
  constexpr auto kByColumn = static_cast<std::uint32_t>(0.06711056 * kWhole);
  constexpr auto kByRow = static_cast<std::uint32_t>(0.00583715 * kWhole);
  constexpr auto kFactor = static_cast<std::uint64_t>(52.9829189 * 16777216.0);
  const std::size_t width = kSparseChannels * static_cast<std::size_t>(picture.width_px);
  std::vector<std::uint8_t> rgb(picture.rgb.size());
  ForRows(picture.height_px, [&](int y) {
    const std::size_t begin = width * static_cast<std::size_t>(y);
    const std::uint16_t* in = picture.rgb.data() + begin;
    std::uint8_t* out = rgb.data() + begin;
    std::uint32_t inner = kByRow * static_cast<std::uint32_t>(y);
    for (int x = 0; x < picture.width_px; ++x, inner += kByColumn) {
      const auto outer = static_cast<std::uint32_t>((inner * kFactor) >> 24U);
      // The noise ranges from 0 to just below a step of 8 bits.
      const std::uint32_t noise = (outer >> 16U) * kFineSteps >> 16U;
      for (std::size_t c = 0; c < kSparseChannels; ++c) {
        *out++ = static_cast<std::uint8_t>((*in++ + noise) / kFineSteps);
      }
    }
  });
  return rgb;
}

}  // namespace thunderhead::frame

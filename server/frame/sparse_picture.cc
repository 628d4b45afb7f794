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

namespace thunderhead::frame {
namespace {

constexpr std::size_t kSparseChannels = 3;
constexpr int kRowsInShare = 16;
constexpr int kOne = 64;         // of weights of interpolation
constexpr int kFineSteps = 257;  // of a FineImage in one of 8 bits

// Where a finer picture's columns or rows are in the one before it.
struct Places {
  std::vector<int> parent;  // in whose place each is
  std::vector<int> before;  // the nearer of the two that it is interpolated from on the low side
  std::vector<int> after;
  std::vector<int> weight;  // of `after`, out of kOne

  Places(int count, int parents) {
    for (int i = 0; i < count; ++i) {
      const double place = (i + 0.5) * parents / count;
      const double from = std::max(place - 0.5, 0.0);
      const int low = static_cast<int>(from);
      parent.push_back(std::min(static_cast<int>(place), parents - 1));
      before.push_back(low);
      after.push_back(std::min(low + 1, parents - 1));
      weight.push_back(static_cast<int>(std::lround((from - low) * kOne)));
    }
  }
};

std::size_t Offset(const glm::ivec2& size_px, int x, int y) {
  return static_cast<std::size_t>(y) * static_cast<std::size_t>(size_px.x) +
         static_cast<std::size_t>(x);
}

template <typename Work>
void ForRows(int rows, const Work& work) {
  tbb::parallel_for(0, (rows + kRowsInShare - 1) / kRowsInShare, [&](int share) {
    const int end = std::min((share + 1) * kRowsInShare, rows);
    for (int y = share * kRowsInShare; y < end; ++y) work(y);
  });
}

// 1 for each pixel whose place in the next picture needs rays of its own.
std::vector<std::uint8_t> Rough(const FineImage& picture, int contrast) {
  const glm::ivec2 size(picture.width_px, picture.height_px);
  const int most = contrast * kFineSteps;
  std::vector<std::uint8_t> rough(picture.rgb.size() / kSparseChannels, 0);
  ForRows(size.y, [&](int y) {
    const auto row = [&](int of) {
      return picture.rgb.data() + kSparseChannels * Offset(size, 0, std::clamp(of, 0, size.y - 1));
    };
    const std::uint16_t* const above = row(y - 1);
    const std::uint16_t* const here = row(y);
    const std::uint16_t* const below = row(y + 1);
    for (int x = 0; x < size.x; ++x) {
      const std::size_t middle = kSparseChannels * static_cast<std::size_t>(x);
      const std::size_t left = x > 0 ? middle - kSparseChannels : middle;
      const std::size_t right = x + 1 < size.x ? middle + kSparseChannels : middle;
      int off = 0;
      for (std::size_t c = 0; c < kSparseChannels; ++c) {
        const int twice = 2 * here[middle + c];
        off = std::max({off, std::abs(here[left + c] + here[right + c] - twice),
                        std::abs(above[middle + c] + below[middle + c] - twice),
                        std::abs(above[left + c] + below[right + c] - twice),
                        std::abs(above[right + c] + below[left + c] - twice)});
      }
      rough[Offset(size, x, y)] = off > most ? 1 : 0;
    }
  });
  return rough;
}

// Interpolated between the pixels of the picture before.
FineImage Spread(const FineImage& from, const glm::ivec2& size_px, const Places& columns,
                 const Places& rows) {
  FineImage to{size_px.x, size_px.y, {}};
  const std::size_t width = kSparseChannels * static_cast<std::size_t>(size_px.x);
  const std::size_t from_width = kSparseChannels * static_cast<std::size_t>(from.width_px);
  to.rgb.resize(width * static_cast<std::size_t>(size_px.y));
  ForRows(size_px.y, [&](int y) {
    const auto row = static_cast<std::size_t>(y);
    const std::uint16_t* const low =
        from.rgb.data() + from_width * static_cast<std::size_t>(rows.before[row]);
    const std::uint16_t* const high =
        from.rgb.data() + from_width * static_cast<std::size_t>(rows.after[row]);
    const int up = rows.weight[row];
    thread_local std::vector<int> blended;
    blended.resize(from_width);
    int* const mixed = blended.data();
    for (std::size_t i = 0; i < from_width; ++i) {
      mixed[i] = ((kOne - up) * low[i] + up * high[i]) / kOne;
    }
    std::uint16_t* out = to.rgb.data() + width * row;
    for (int x = 0; x < size_px.x; ++x, out += kSparseChannels) {
      const auto column = static_cast<std::size_t>(x);
      const int* const a =
          mixed + kSparseChannels * static_cast<std::size_t>(columns.before[column]);
      const int* const b =
          mixed + kSparseChannels * static_cast<std::size_t>(columns.after[column]);
      const int right = columns.weight[column];
      for (std::size_t c = 0; c < kSparseChannels; ++c) {
        out[c] = static_cast<std::uint16_t>(((kOne - right) * a[c] + right * b[c]) / kOne);
      }
    }
  });
  return to;
}

// The pixels in the places of rough ones, so that neighbours in the list are neighbours in the
// picture.
std::vector<glm::ivec2> ChildrenOf(const std::vector<std::uint8_t>& rough,
                                   const glm::ivec2& rough_px, const Places& columns,
                                   const Places& rows) {
  std::vector<glm::ivec2> chosen;
  const auto ranges = [](const Places& places, int parents) {
    std::vector<int> first(static_cast<std::size_t>(parents) + 1, 0);
    for (const int parent : places.parent) ++first[static_cast<std::size_t>(parent) + 1];
    for (std::size_t i = 1; i < first.size(); ++i) first[i] += first[i - 1];
    return first;
  };
  const std::vector<int> x_of = ranges(columns, rough_px.x);
  const std::vector<int> y_of = ranges(rows, rough_px.y);
  for (int parent_y = 0; parent_y < rough_px.y; ++parent_y) {
    for (int parent_x = 0; parent_x < rough_px.x; ++parent_x) {
      if (rough[Offset(rough_px, parent_x, parent_y)] == 0) continue;
      const auto i = static_cast<std::size_t>(parent_x);
      const auto j = static_cast<std::size_t>(parent_y);
      for (int y = y_of[j]; y < y_of[j + 1]; ++y) {
        for (int x = x_of[i]; x < x_of[i + 1]; ++x) chosen.emplace_back(x, y);
      }
    }
  }
  return chosen;
}

}  // namespace

glm::ivec2 CoarsestOf(const glm::ivec2& size_px) { return (size_px + 3) / 4; }

absl::StatusOr<FineImage> CompletePicture(FineImage coarsest, const glm::ivec2& size_px,
                                          int contrast, const DrawPlaces& draw) {
  FineImage picture = std::move(coarsest);
  for (const glm::ivec2& finer_px : {(size_px + 1) / 2, size_px}) {
    const glm::ivec2 before_px(picture.width_px, picture.height_px);
    const Places columns(finer_px.x, before_px.x);
    const Places rows(finer_px.y, before_px.y);
    const std::vector<glm::ivec2> chosen =
        ChildrenOf(Rough(picture, contrast), before_px, columns, rows);
    picture = Spread(picture, finer_px, columns, rows);
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

// The noise is fract(52.9829189 fract(0.06711056 x + 0.00583715 y)), in shares of 2^32.
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
      // From 0 to just below a step of 8 bits.
      const std::uint32_t noise = (outer >> 16U) * kFineSteps >> 16U;
      for (std::size_t c = 0; c < kSparseChannels; ++c) {
        *out++ = static_cast<std::uint8_t>((*in++ + noise) / kFineSteps);
      }
    }
  });
  return rgb;
}

}  // namespace thunderhead::frame

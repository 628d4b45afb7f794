#include "renderers/cover.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "base/status.h"
#include "glm/common.hpp"
#include "glm/geometric.hpp"

namespace thunderhead::renderers {
namespace {

constexpr int kMinCoverTile_px = 8;
constexpr int kMaxTiles = 256;  // maximum number of tiles along each side
constexpr float kNowhere = 0.0F;
// Depth at which passes limited by a cover are drawn. The cover's depth is 1 inside and 0 outside.
constexpr double kBetween = 0.5;

int Pixel(double place_px, int size_px) {
  return static_cast<int>(std::clamp(place_px, 0.0, static_cast<double>(size_px)));
}

// The tiles of a picture, each of which can be marked.
struct Tiles {
  int side_px;
  glm::ivec2 count;
  std::vector<std::uint8_t> marked;

  explicit Tiles(const glm::ivec2& size_px)
      : side_px(
            std::max(kMinCoverTile_px, (std::max(size_px.x, size_px.y) / kMaxTiles + 3) / 4 * 4)),
        count((size_px + side_px - 1) / side_px),
        marked(static_cast<std::size_t>(count.x) * static_cast<std::size_t>(count.y)) {}

  std::uint8_t* Row(int y) {
    return marked.data() + static_cast<std::ptrdiff_t>(y) * static_cast<std::ptrdiff_t>(count.x);
  }

  void Mark(const PixelRect& rect) {
    if (rect.Empty()) return;
    const glm::ivec2 low = rect.low / side_px;
    const glm::ivec2 high = (rect.high - 1) / side_px;
    for (int y = low.y; y <= high.y; ++y) std::fill(Row(y) + low.x, Row(y) + high.x + 1, 1);
  }

  // Returns the runs of consecutive marked tiles in each row, as rectangles of pixels.
  std::vector<PixelRect> Runs(const glm::ivec2& size_px) {
    std::vector<PixelRect> runs;
    for (int y = 0; y < count.y; ++y) {
      const std::uint8_t* row = Row(y);
      const std::uint8_t* end = row + count.x;
      for (const std::uint8_t* first = std::find(row, end, 1); first != end;) {
        const std::uint8_t* last = std::find(first, end, 0);
        runs.push_back({glm::ivec2(first - row, y) * side_px,
                        glm::min(glm::ivec2(last - row, y + 1) * side_px, size_px)});
        first = std::find(last, end, 1);
      }
    }
    return runs;
  }
};

}  // namespace

BoxProjection::BoxProjection(const glm::dvec3& half_extent_m, const scene::View& view,
                             const glm::ivec2& size_px, double margin_px)
    : view_(view),
      size_px_(size_px),
      margin_px_(margin_px),
      half_m_(glm::dot(glm::abs(view.right), half_extent_m),
              glm::dot(glm::abs(view.up), half_extent_m),
              glm::dot(glm::abs(view.forward), half_extent_m)) {}

std::optional<PixelRect> BoxProjection::Of(const glm::dvec3& middle_m) const {
  const glm::dvec3 off_m = middle_m - view_.eye_m;
  const double forward_m = glm::dot(off_m, view_.forward);
  if (!view_.Orthographic()) {
    if (forward_m + half_m_.z <= 0.0) return std::nullopt;
    if (forward_m - half_m_.z <= 0.0) return PixelRect{glm::ivec2(0), size_px_};
  }
  const Interval x = Across(glm::dot(off_m, view_.right), half_m_.x, forward_m, view_.half_width_m,
                            view_.tan_half_width, size_px_.x);
  const Interval y = Across(glm::dot(off_m, view_.up), half_m_.y, forward_m, view_.half_height_m,
                            view_.tan_half_height, size_px_.y);
  return PixelRect{{Pixel(std::floor(x.low), size_px_.x), Pixel(std::floor(y.low), size_px_.y)},
                   {Pixel(std::ceil(x.high), size_px_.x), Pixel(std::ceil(y.high), size_px_.y)}};
}

BoxProjection::Interval BoxProjection::Across(double middle_m, double half_m, double forward_m,
                                              double half_width_m, double tan_half_width,
                                              int size_px) const {
  const double near_m = half_width_m + tan_half_width * (forward_m - half_m_.z);
  const double far_m = half_width_m + tan_half_width * (forward_m + half_m_.z);
  const double low_m = middle_m - half_m;
  const double high_m = middle_m + half_m;
  // The projection magnifies near points more than far points. If the box's low side has a negative
  // coordinate, its lowest projected point is therefore at the near distance, and otherwise at the
  // far distance. For the highest projected point of the high side it is the other way round.
  const double low = low_m / (low_m < 0.0 ? near_m : far_m);
  const double high = high_m / (high_m < 0.0 ? far_m : near_m);
  return {(0.5 * low + 0.5) * size_px - margin_px_, (0.5 * high + 0.5) * size_px + margin_px_};
}

std::vector<PixelRect> CoveredRects(const Boxes& boxes, const scene::View& view,
                                    const glm::ivec2& size_px, double margin_px) {
  const BoxProjection projection(boxes.half_extent_m, view, size_px, margin_px);
  Tiles tiles(size_px);
  for (const glm::dvec3& middle_m : boxes.middles_m) {
    if (const std::optional<PixelRect> rect = projection.Of(middle_m)) tiles.Mark(*rect);
  }
  return tiles.Runs(size_px);
}

absl::Status Cover::Draw(const Boxes& boxes, const scene::View& view, const glm::ivec2& size_px,
                         double margin_px) {
  if (depth_.Size() != size_px) {
    depth_ = gl::Texture2D(GL_DEPTH_COMPONENT32F, size_px);
    target_ = gl::Framebuffer({}, &depth_);
  }
  target_.ClearDepth(kNowhere);
  std::vector<glm::vec3> corners;
  for (const PixelRect& rect : CoveredRects(boxes, view, size_px, margin_px)) {
    const glm::vec2 low = 2.0F * glm::vec2(rect.low) / glm::vec2(size_px) - 1.0F;
    const glm::vec2 high = 2.0F * glm::vec2(rect.high) / glm::vec2(size_px) - 1.0F;
    for (const glm::vec2& corner : {low, {high.x, low.y}, high, low, high, {low.x, high.y}}) {
      corners.emplace_back(corner, 1.0F);
    }
  }
  if (corners.empty()) return absl::OkStatus();
  THUNDERHEAD_ASSIGN_OR_RETURN(
      const gl::Program* program,
      programs_->Get(gl::ProgramSource::Of("common/cover.vert", "common/cover.frag")));
  const gl::Buffer buffer(corners.size() * sizeof(glm::vec3), corners.data(), 0);
  const gl::VertexArray array = gl::VertexArray::OfPositions(buffer);
  target_.Bind();
  program->Use();
  array.Bind();
  glEnable(GL_DEPTH_TEST);
  glDepthFunc(GL_ALWAYS);
  glDrawArrays(GL_TRIANGLES, 0, static_cast<GLsizei>(corners.size()));
  glDepthFunc(GL_LESS);
  glDisable(GL_DEPTH_TEST);
  return absl::OkStatus();
}

void CoveredTarget::Resize(GLenum format, const glm::ivec2& size_px, const Cover* cover,
                           bool with_distances) {
  const GLuint depth = cover == nullptr ? 0 : cover->Depth().Get();
  const bool same_texture =
      texture_.Size() == size_px && format_ == format && with_distances == (distances_.Get() != 0);
  if (same_texture && depth_ == depth) return;
  if (!same_texture) {
    texture_ = gl::Texture2D(format, size_px);
    distances_ = with_distances ? gl::Texture2D(GL_R32F, size_px) : gl::Texture2D();
  }
  format_ = format;
  depth_ = depth;
  const gl::Texture2D* limit = cover == nullptr ? nullptr : &cover->Depth();
  target_ = with_distances ? gl::Framebuffer({&texture_, &distances_}, limit)
                           : gl::Framebuffer({&texture_}, limit);
}

LimitedTo::LimitedTo(Where where, const Cover* cover) : limited_(cover != nullptr) {
  if (!limited_) return;
  glEnable(GL_DEPTH_TEST);
  glDepthMask(GL_FALSE);
  glDepthFunc(where == Where::kCovered ? GL_LESS : GL_GREATER);
  glDepthRange(kBetween, kBetween);
}

LimitedTo::~LimitedTo() {
  if (!limited_) return;
  glDepthRange(0.0, 1.0);
  glDepthFunc(GL_LESS);
  glDepthMask(GL_TRUE);
  glDisable(GL_DEPTH_TEST);
}

}  // namespace thunderhead::renderers

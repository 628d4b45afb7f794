#include "desktop/mark_strokes.h"

#include <cmath>
#include <utility>

namespace thunderhead::desktop {
namespace {

using Stroke = std::vector<client::PicturePoint>;

// A mark of a single stroke with more corners than this was drawn by hand.
constexpr std::size_t kMaxStraightCorners = 4;

bool IsSame(const client::PicturePoint& a, const client::PicturePoint& b) {
  constexpr double kRounding = 1e-6;
  return std::abs(a.x - b.x) < kRounding && std::abs(a.y - b.y) < kRounding;
}

void AddStrokes(const Stroke& line, std::vector<Stroke>& strokes) {
  Stroke stroke;
  const auto lift = [&] {
    if (stroke.size() > 1) strokes.push_back(stroke);
    stroke.clear();
  };
  for (std::size_t i = 0; i < line.size(); ++i) {
    if (i > 0 && IsSame(line[i - 1], line[i])) {
      lift();
    } else {
      stroke.push_back(line[i]);
    }
  }
  lift();
}

}  // namespace

std::vector<MarkStroke> StrokesOf(const v1::Mark& mark, const v1::View& view) {
  std::vector<Stroke> strokes;
  for (const Stroke& part : client::ProjectLine(view, mark.positions())) AddStrokes(part, strokes);
  const bool ink = strokes.size() == 1 && strokes.front().size() > kMaxStraightCorners;
  std::vector<MarkStroke> marked;
  marked.reserve(strokes.size());
  for (Stroke& stroke : strokes) marked.push_back({ink, std::move(stroke)});
  return marked;
}

}  // namespace thunderhead::desktop

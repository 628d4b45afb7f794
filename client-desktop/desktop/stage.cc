#include "desktop/stage.h"

#include <imgui.h>

#include <algorithm>
#include <cmath>

#include "desktop/field_colors.h"
#include "desktop/mark_strokes.h"
#include "desktop/style.h"
#include "thunderhead_client/projection.h"

namespace thunderhead::desktop {
namespace {

// A corner of a hand-drawn line is left out if its distance to the last corner is less than this
// many units of the window.
constexpr float kNear = 3.0F;
constexpr std::size_t kMaxCorners = 256;

ImU32 ColorOf(const v1::Color& color) {
  const auto [red, green, blue] = ScreenColorOf(color);
  return ImGui::GetColorU32({red, green, blue, 1.0F});
}

// Width of a line and of its dark edge, which makes the line visible over bright clouds. These are
// the page's widths, but the page's ink also varies in width.
struct Pen {
  float thickness;
  float with_edge;
};
constexpr Pen kStraight{2.5F, 5.0F};
constexpr Pen kInk{3.5F, 5.5F};

void DrawLine(const std::vector<ImVec2>& line, ImU32 color, const Pen& pen, float scale) {
  ImDrawList& list = *ImGui::GetBackgroundDrawList();
  const auto draw = [&](ImU32 paint, float thickness) {
    list.AddPolyline(line.data(), static_cast<int>(line.size()), paint, 0, thickness * scale);
  };
  draw(ImGui::GetColorU32({0.0F, 0.0F, 0.0F, 0.45F}), pen.with_edge);
  draw(color, pen.thickness);
}

}  // namespace

Stage::Stage(Ui& ui) : ui_(ui) {
  pen_.press = [this](ScreenPoint at) { stroke_ = {at}; };
  pen_.drag = [this](ScreenPoint at) {
    const ScreenPoint last = stroke_.back();
    const bool apart = std::hypot(at.x - last.x, at.y - last.y) >= kNear;
    if (apart && stroke_.size() < kMaxCorners) stroke_.push_back(at);
  };
  pen_.release = [this](bool cancelled) { EndStroke(cancelled); };
  pen_.hover = [](std::optional<ScreenPoint>) {};
  const auto points = [this](std::optional<ScreenPoint> at) {
    ui_.session.Point(at ? RayAt(*at) : std::nullopt);
  };
  pointer_.press = points;
  pointer_.drag = points;
  pointer_.release = [points](bool cancelled) {
    if (cancelled) points({});
  };
  pointer_.hover = points;
}

const ToolSteps* Stage::HandTool() const {
  if (ui_.choices.tool != Tool::kMarks || !ui_.state.MayMark()) return nullptr;
  if (ui_.choices.hand == Hand::kPen) return &pen_;
  return ui_.choices.hand == Hand::kPointer ? &pointer_ : nullptr;
}

void Stage::EndStroke(bool cancelled) {
  std::vector<v1::Ray> rays;
  for (const ScreenPoint& point : stroke_) {
    if (const auto ray = RayAt(point)) rays.push_back(*ray);
  }
  stroke_.clear();
  if (!cancelled && rays.size() > 1) ui_.session.AddMark(rays);
}

void Stage::Draw(const PictureTexture& picture) {
  if (picture.empty()) return;
  const auto width = static_cast<float>(picture.width_px());
  const auto height = static_cast<float>(picture.height_px());
  const float scale = std::min(ui_.width / width, ui_.height / height);
  box_.width = scale * width;
  box_.height = scale * height;
  box_.left = 0.5F * (ui_.width - box_.width);
  box_.top = 0.5F * (ui_.height - box_.height);
  ImGui::GetBackgroundDrawList()->AddImage(picture.id(), {box_.left, box_.top},
                                           {box_.left + box_.width, box_.top + box_.height});
  DrawMarks();
  DrawPointers();
}

void Stage::DrawMarks() const {
  for (const v1::Mark& mark : ui_.state.marks.marks()) {
    const ImU32 color = mark.has_color() ? ColorOf(mark.color()) : ImGui::GetColorU32(kAccent);
    for (const MarkStroke& stroke : StrokesOf(mark, ui_.frame.view())) {
      std::vector<ImVec2> line;
      for (const client::PicturePoint& point : stroke.points) {
        const ScreenPoint place = PlaceAt(point);
        line.emplace_back(place.x, place.y);
      }
      DrawLine(line, color, stroke.ink ? kInk : kStraight, ui_.scale);
    }
  }
  std::vector<ImVec2> line;
  for (const ScreenPoint& point : stroke_) line.emplace_back(point.x, point.y);
  if (line.size() > 1) DrawLine(line, ImGui::GetColorU32(kAccent), kInk, ui_.scale);
}

void Stage::DrawPointers() {
  ImDrawList& list = *ImGui::GetBackgroundDrawList();
  for (const v1::Pointer& pointer : ui_.state.pointers.pointers()) {
    if (pointer.viewer_id() == ui_.state.viewer_id || !pointer.has_position()) continue;
    const auto point = client::Project(ui_.frame.view(), pointer.position());
    if (!point || std::abs(point->x) > 1.0 || std::abs(point->y) > 1.0) continue;
    const ScreenPoint place = PlaceAt(*point);
    const ImVec2 at(place.x, place.y);
    list.AddCircleFilled(at, 5.0F * ui_.scale, ImGui::GetColorU32(kAccent));
    list.AddCircle(at, 10.0F * ui_.scale, ImGui::GetColorU32(kAccent), 0, 2.0F * ui_.scale);
    const v1::Person* const person = ui_.state.PersonOf(pointer.viewer_id());
    if (person == nullptr) continue;
    list.AddText({at.x + 14.0F * ui_.scale, at.y - 0.5F * ImGui::GetTextLineHeight()},
                 ImGui::GetColorU32(kAccent), ui_.state.NameOf(*person).c_str());
  }
}

std::optional<v1::Ray> Stage::RayAt(ScreenPoint point) const {
  const client::PicturePoint at{2.0 * (point.x - box_.left) / box_.width - 1.0,
                                1.0 - 2.0 * (point.y - box_.top) / box_.height};
  if (!ui_.frame.has_view() || std::abs(at.x) > 1.0 || std::abs(at.y) > 1.0) return {};
  return client::RayAt(ui_.frame.view(), at);
}

ScreenPoint Stage::PlaceAt(const client::PicturePoint& point) const {
  return {box_.left + 0.5F * (1.0F + static_cast<float>(point.x)) * box_.width,
          box_.top + 0.5F * (1.0F - static_cast<float>(point.y)) * box_.height};
}

}  // namespace thunderhead::desktop

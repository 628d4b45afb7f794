#include "desktop/stage.h"

#include <imgui.h>

#include <algorithm>
#include <cmath>

#include "desktop/field_colors.h"
#include "desktop/style.h"
#include "thunderhead_client/projection.h"

namespace thunderhead::desktop {
namespace {

// Corners of a line nearer than this to the last are left out.
constexpr float kNear = 3.0F;
constexpr std::size_t kMaxCorners = 256;

ImU32 ColorOf(const v1::Color& color) {
  const auto [red, green, blue] = ScreenColorOf(color);
  return ImGui::GetColorU32({red, green, blue, 1.0F});
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

void Stage::DrawMarks() {
  ImDrawList& list = *ImGui::GetBackgroundDrawList();
  const float thickness = 3.0F * ui_.scale;
  std::vector<ImVec2> line;
  for (const v1::Mark& mark : ui_.state.marks.marks()) {
    line.clear();
    const ImU32 color = ColorOf(mark.color());
    const auto draw = [&] {
      if (line.size() > 1)
        list.AddPolyline(line.data(), static_cast<int>(line.size()), color, 0, thickness);
      line.clear();
    };
    for (const v1::Position& position : mark.positions()) {
      const auto place = PlaceOf(position);
      if (place) {
        line.emplace_back(place->x, place->y);
      } else {
        draw();
      }
    }
    draw();
  }
  for (const ScreenPoint& point : stroke_) line.emplace_back(point.x, point.y);
  if (line.size() > 1) {
    list.AddPolyline(line.data(), static_cast<int>(line.size()), ImGui::GetColorU32(kAccent), 0,
                     thickness);
  }
}

void Stage::DrawPointers() {
  ImDrawList& list = *ImGui::GetBackgroundDrawList();
  for (const v1::Pointer& pointer : ui_.state.pointers.pointers()) {
    if (pointer.viewer_id() == ui_.state.viewer_id || !pointer.has_position()) continue;
    const auto place = PlaceOf(pointer.position());
    if (!place) continue;
    const ImVec2 at(place->x, place->y);
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

std::optional<ScreenPoint> Stage::PlaceOf(const v1::Position& position) const {
  const auto point = client::Project(ui_.frame.view(), position);
  if (!point) return {};
  return ScreenPoint{box_.left + 0.5F * (1.0F + static_cast<float>(point->x)) * box_.width,
                     box_.top + 0.5F * (1.0F - static_cast<float>(point->y)) * box_.height};
}

}  // namespace thunderhead::desktop

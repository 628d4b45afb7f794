// The time line at the bottom. It has a tick for each time, a button to play or pause, and a button
// that opens the tool "Time". The line is blue around the times that are in the server's memory.
#include <imgui.h>

#include <algorithm>
#include <cmath>

#include "absl/strings/str_cat.h"
#include "desktop/controls.h"
#include "desktop/panels/panels.h"
#include "desktop/style.h"
#include "desktop/texts.h"

namespace thunderhead::desktop {
namespace {

struct Track {
  ImVec2 from;
  float length = 0.0F;
  int count = 0;

  float XOf(int index) const {
    if (count < 2) return from.x + 0.5F * length;
    return from.x + length * static_cast<float>(index) / static_cast<float>(count - 1);
  }
  int IndexAt(float x) const {
    if (count < 2) return 0;
    const float share = (x - from.x) / length;
    return std::clamp(static_cast<int>(std::lround(share * static_cast<float>(count - 1))), 0,
                      count - 1);
  }
};

// Returns a text like "20:00" or "20:00:30", or the elapsed time if the valid time is unknown.
std::string ClockOf(const v1::StormTime& time) {
  const std::size_t at = time.valid_time().find('T');
  if (at == std::string::npos) return FormatElapsed(time.elapsed_s());
  std::string clock = time.valid_time().substr(at + 1, 8);
  if (clock.size() == 8 && clock.substr(5) == ":00") clock.resize(5);
  return clock;
}

void DrawTicks(const Ui& ui, const Track& track) {
  ImDrawList& list = *ImGui::GetWindowDrawList();
  const float half = 6.0F * ui.scale;
  const ImU32 line = ImGui::GetColorU32({1.0F, 1.0F, 1.0F, 0.28F});
  const ImU32 memory = ImGui::GetColorU32({0.40F, 0.62F, 0.92F, 1.0F});
  list.AddLine(track.from, {track.from.x + track.length, track.from.y}, line, 2.5F * ui.scale);
  const auto& held = ui.state.times_in_memory;
  if (held.storm_id() == ui.storms.storm.id()) {
    const float reach =
        track.count < 2 ? 0.0F : 0.5F * track.length / static_cast<float>(track.count - 1);
    for (const std::uint32_t index : held.time_indices()) {
      const float x = track.XOf(static_cast<int>(index));
      list.AddLine({std::max(track.from.x, x - reach), track.from.y},
                   {std::min(track.from.x + track.length, x + reach), track.from.y}, memory,
                   2.5F * ui.scale);
    }
  }
  float labelled_to = -1e9F;
  ImGui::PushFont(SmallFont());
  for (int i = 0; i < track.count; ++i) {
    const float x = track.XOf(i);
    list.AddLine({x, track.from.y - half}, {x, track.from.y + half},
                 ImGui::GetColorU32({1.0F, 1.0F, 1.0F, 0.5F}), 1.5F * ui.scale);
    const std::string clock = ClockOf(ui.storms.storm.times(i));
    const float width = ImGui::CalcTextSize(clock.c_str()).x;
    const float left = std::clamp(x - 0.5F * width, track.from.x - 10.0F * ui.scale,
                                  track.from.x + track.length + 10.0F * ui.scale - width);
    if (left < labelled_to + 14.0F * ui.scale) continue;
    labelled_to = left + width;
    list.AddText({left, track.from.y + half + 3.0F * ui.scale}, ImGui::GetColorU32(kQuiet),
                 clock.c_str());
  }
  ImGui::PopFont();
  list.AddCircleFilled({track.XOf(ui.time_index()), track.from.y}, 8.0F * ui.scale,
                       ImGui::GetColorU32(kAccent));
}

void DrawTrack(Ui& ui, float width, float height) {
  const ImVec2 at = ImGui::GetCursorScreenPos();
  const float inset = 14.0F * ui.scale;
  const Track track{{at.x + inset, at.y + 0.36F * height}, width - 2.0F * inset, ui.time_count()};
  ImGui::InvisibleButton("track", {std::max(1.0F, width), height});
  if (ImGui::IsItemActive() && ui.state.Steers()) {
    const int index = track.IndexAt(ImGui::GetIO().MousePos.x);
    if (index != ui.time_index()) ui.ChooseTime(index);
  }
  if (ImGui::IsItemHovered()) {
    const int index = track.IndexAt(ImGui::GetIO().MousePos.x);
    ImGui::SetTooltip("%s", FormatValidTime(ui.storms.storm.times(index)).c_str());
  }
  DrawTicks(ui, track);
}

void DrawPlayButton(Ui& ui, float side) {
  const ImVec2 at = ImGui::GetCursorScreenPos();
  if (ImGui::Button("##play", {side, side})) ui.TogglePlay();
  if (ImGui::IsItemHovered()) ImGui::SetTooltip("Play or pause (space)");
  const ImVec2 middle(at.x + 0.5F * side, at.y + 0.5F * side);
  const float half = 0.19F * side;
  ImDrawList& list = *ImGui::GetWindowDrawList();
  const ImU32 color = ImGui::GetColorU32(ImGuiCol_Text);
  if (ui.playback.playing()) {
    list.AddRectFilled({middle.x - half, middle.y - half},
                       {middle.x - 0.3F * half, middle.y + half}, color);
    list.AddRectFilled({middle.x + 0.3F * half, middle.y - half},
                       {middle.x + half, middle.y + half}, color);
  } else {
    list.AddTriangleFilled({middle.x - 0.8F * half, middle.y - half}, {middle.x + half, middle.y},
                           {middle.x - 0.8F * half, middle.y + half}, color);
  }
}

}  // namespace

void DrawTimeLine(Ui& ui, const Layout& layout) {
  if (ui.time_count() < 2 || ui.storms.storm.id() != ui.state.scene.storm_id()) return;
  const float left = 2.0F * layout.margin + layout.rail_width;
  const ImVec2 place(left, layout.window.y - layout.margin - layout.line_height);
  const ImVec2 size(layout.window.x - left - layout.margin, layout.line_height);
  if (BeginPanel("time line", place, size, ImGuiWindowFlags_NoScrollbar)) {
    const float side = 38.0F * ui.scale;
    ImGui::BeginDisabled(!ui.state.Steers());
    ImGui::SetCursorPosY(0.5F * (layout.line_height - side));
    DrawPlayButton(ui, side);
    ImGui::SameLine();
    const std::string rate = absl::StrCat(FormatNumber(ui.playback.times_per_second), " /s");
    const float rate_width = ImGui::CalcTextSize(rate.c_str()).x + 24.0F * ui.scale;
    ImGui::SetCursorPosY(10.0F * ui.scale);
    const float track = ImGui::GetContentRegionAvail().x - rate_width;
    DrawTrack(ui, track, layout.line_height - 16.0F * ui.scale);
    ImGui::SameLine();
    ImGui::SetCursorPosY(0.5F * (layout.line_height - ImGui::GetFrameHeight()));
    if (ImGui::Button(rate.c_str(), {-1.0F, 0.0F})) ui.choices.Toggle(Tool::kTime);
    ImGui::EndDisabled();
  }
  ImGui::End();
}

}  // namespace thunderhead::desktop

// The top bar: the storm and the time at the left, the connection and the buttons of the panels at
// the right.
#include <imgui.h>

#include <algorithm>
#include <chrono>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "desktop/controls.h"
#include "desktop/panels/panels.h"
#include "desktop/style.h"
#include "desktop/texts.h"

namespace thunderhead::desktop {
namespace {

std::string LinkText(const Ui& ui) {
  const auto left = ui.state.retry_at - std::chrono::steady_clock::now();
  const auto seconds =
      std::max<long long>(0, std::chrono::ceil<std::chrono::seconds>(left).count());
  switch (ui.state.link) {
    case client::Link::kConnecting:
      return "connecting …";
    case client::Link::kLive: {
      const auto& latency = ui.figures.latency_ms;
      return absl::StrCat("live", latency ? absl::StrFormat(" · %.0f ms", *latency) : "", " · ",
                          FormatBitRate(ui.figures.bytes_per_s));
    }
    case client::Link::kLost:
      return absl::StrCat("connection lost · again in ", seconds, " s");
    case client::Link::kRefused:
      return absl::StrCat("refused · again in ", seconds, " s");
    case client::Link::kGone:
      return "the session has ended";
  }
  return "";
}

// Draws the storm and the time. `right` is the x position at which the connection's text begins.
// The title is shortened to leave room for the time. The lead time, and then the run, are drawn
// only if they fit.
void DrawStorm(Ui& ui, float right) {
  const auto& storm = ui.storms.storm;
  const bool known = storm.id() == ui.state.scene.storm_id() && !storm.id().empty();
  const int index = ui.time_index();
  const bool has_time = known && index < storm.times_size();
  const float gap = 16.0F * ui.scale;
  ImGui::PushFont(BoldFont());
  const std::string time = has_time ? FormatValidTime(storm.times(index)) : "";
  const float room = right - ImGui::GetCursorPosX() - 2.0F * gap -
                     (has_time ? ImGui::CalcTextSize(time.c_str()).x + gap : 0.0F);
  const std::string title =
      Shortened(known ? storm.title() : ui.state.scene.storm_id(), std::max(room, 2.0F * gap));
  if (ImGui::Button(absl::StrCat(title.empty() ? "Storms" : title, "###storm").c_str())) {
    ui.choices.Toggle(Panel::kStorms);
  }
  float left_room = room - ImGui::CalcTextSize(title.c_str()).x;
  ImGui::PopFont();
  if (ImGui::IsItemHovered()) ImGui::SetTooltip("Storms (O)");
  if (!has_time || room < 2.0F * gap) return;
  const auto fits = [&](const std::string& text) {
    const float width = ImGui::CalcTextSize(text.c_str()).x + gap;
    const bool does = !text.empty() && width <= left_room;
    if (does) left_room -= width;
    return does;
  };
  const std::string lead = FormatElapsed(LeadSeconds(storm, storm.times(index)));
  const bool shows_lead = fits(lead);
  const std::string run = NameOfRun(storm);
  if (fits(run)) {
    ImGui::SameLine(0.0F, gap);
    QuietLine(run);
  }
  ImGui::SameLine(0.0F, gap);
  ImGui::PushFont(BoldFont());
  ImGui::TextUnformatted(time.c_str());
  ImGui::PopFont();
  if (!shows_lead) return;
  ImGui::SameLine(0.0F, gap);
  QuietLine(lead);
  if (ImGui::IsItemHovered()) ImGui::SetTooltip("Lead time: since the run's start");
}

ImVec4 LinkColor(client::Link link) {
  if (link == client::Link::kLive) return kGood;
  return link == client::Link::kConnecting ? kQuiet : kBad;
}

void DrawLink(Ui& ui, const std::string& text) {
  ImGui::PushStyleColor(ImGuiCol_Button, ImVec4(0.0F, 0.0F, 0.0F, 0.0F));
  const ImVec2 at = ImGui::GetCursorScreenPos();
  const float radius = 4.0F * ui.scale;
  if (ImGui::Button(absl::StrCat("    ", text, "###link").c_str())) {
    ui.choices.Toggle(Panel::kReadout);
  }
  ImGui::PopStyleColor();
  if (ImGui::IsItemHovered()) {
    ImGui::SetTooltip("%s\nFigures of the pictures (I)", LinkText(ui).c_str());
  }
  const float middle = at.y + 0.5F * ImGui::GetFrameHeight();
  ImGui::GetWindowDrawList()->AddCircleFilled({at.x + 14.0F * ui.scale, middle}, radius,
                                              ImGui::GetColorU32(LinkColor(ui.state.link)));
}

}  // namespace

void DrawTopBar(Ui& ui, const Layout& layout) {
  const ImVec2 place(layout.margin, layout.margin);
  const ImVec2 size(layout.window.x - 2.0F * layout.margin, layout.bar_height);
  if (BeginPanel("top bar", place, size, ImGuiWindowFlags_NoScrollbar)) {
    ImGui::SetCursorPosY(0.5F * (layout.bar_height - ImGui::GetFrameHeight()));
    const std::string people =
        ui.state.Alone() ? "People" : absl::StrCat("People ", ui.state.presence.people_size());
    const float gap = ImGui::GetStyle().ItemSpacing.x;
    const float buttons =
        ButtonWidth(people) + ButtonWidth("Settings") + ButtonWidth("?") + 3.0F * gap;
    const float inside = size.x - ImGui::GetStyle().WindowPadding.x - buttons;
    // The storm and the time have priority. If the width is too small, only the coloured lamp shows
    // the state of the connection.
    std::string link = LinkText(ui);
    constexpr float kStormRoom = 230.0F;
    if (inside - ButtonWidth("    " + link) < kStormRoom * ui.scale) link.clear();
    const float right = inside - ButtonWidth("    " + link);
    DrawStorm(ui, right);
    ImGui::SameLine(right);
    DrawLink(ui, link);
    ImGui::SameLine();
    if (ImGui::Button("Settings")) ui.choices.Toggle(Panel::kDrawer);
    if (ImGui::IsItemHovered()) ImGui::SetTooltip("Every setting (X)");
    ImGui::SameLine();
    if (AccentButton(absl::StrCat(people, "###people").c_str())) {
      ui.choices.Toggle(Panel::kPeople);
    }
    ImGui::SameLine();
    if (ImGui::Button("?")) ui.choices.Toggle(Panel::kHelp);
  }
  ImGui::End();
}

}  // namespace thunderhead::desktop

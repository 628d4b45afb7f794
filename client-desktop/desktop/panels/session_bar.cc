// The bar above the time line. It shows the person in control, the button for control, and the
// people who ask to steer. If the user has left the session's view, the bar also has the button
// that returns to that view. The bar is hidden while the user is alone in the session and steers.
// After the session has ended, the bar has only the button that opens a new session.
#include <imgui.h>

#include <algorithm>
#include <string>

#include "absl/strings/str_cat.h"
#include "desktop/controls.h"
#include "desktop/panels/panels.h"
#include "desktop/style.h"
#include "desktop/texts.h"

namespace thunderhead::desktop {
namespace {

std::string WhoSteers(const client::SessionState& state) {
  if (state.Steers()) return "You steer";
  const v1::Person* const steerer = state.Steerer();
  if (steerer != nullptr) return absl::StrCat(state.NameOf(*steerer), " steers");
  if (!state.presence.has_awaited()) return "No one steers";
  return absl::StrCat("Waiting for ", state.NameOf(state.presence.awaited()), " to come back");
}

void DisabledButton(const char* label, const char* reason = nullptr) {
  ImGui::BeginDisabled();
  ImGui::Button(label);
  ImGui::EndDisabled();
  if (reason != nullptr && ImGui::IsItemHovered(ImGuiHoveredFlags_AllowWhenDisabled)) {
    ImGui::SetTooltip("%s", reason);
  }
}

void ControlButton(Ui& ui) {
  const client::SessionState& state = ui.state;
  if (state.Steers()) {
    if (ImGui::Button(state.Presents() ? "Release control" : "Give control back")) {
      ui.session.GiveControl(0);
    }
  } else if (state.Presents()) {
    if (AccentButton("Take control")) ui.session.TakeControl();
  } else if (state.presence.rules().control_locked()) {
    DisabledButton("Ask to steer", "The presenter has locked control");
  } else if (state.AsksControl()) {
    DisabledButton("Asked to steer …");
  } else if (ImGui::Button(state.SteersWhoAsks() ? "Steer" : "Ask to steer")) {
    ui.session.AskControl();
  }
}

// Draws at most three of the people who ask to steer, with buttons to answer them. If more ask,
// draws a button that opens the list of people. Only presenters and the person in control see this.
// A part that does not fit into a line of width `room` begins a new line.
void Asking(Ui& ui, float room) {
  if (!ui.state.Steers() && !ui.state.Presents()) return;
  constexpr int kMaxShown = 3;
  const float longest_name = std::min(200.0F * ui.scale, 0.4F * room);
  int asking = 0;
  for (const v1::Person& person : ui.state.presence.people()) {
    if (!person.asks_control() || ++asking > kMaxShown) continue;
    const std::string give =
        absl::StrCat("Give to ", Shortened(ui.state.NameOf(person), longest_name));
    ImGui::PushID(static_cast<int>(person.viewer_id()));
    SameLineIfRoom(ButtonWidth(give) + ImGui::GetStyle().ItemSpacing.x + ButtonWidth("No"), room);
    if (AccentButton(give.c_str())) ui.session.GiveControl(person.viewer_id());
    ImGui::SameLine();
    if (ImGui::Button("No")) ui.session.RefuseControl(person.viewer_id());
    ImGui::PopID();
  }
  if (asking <= kMaxShown) return;
  const std::string more = absl::StrCat("and ", asking - kMaxShown, " more");
  SameLineIfRoom(ButtonWidth(more), room);
  if (ImGui::Button(more.c_str())) ui.choices.panel = Panel::kPeople;
}

bool HasCompany(const client::SessionState& state) {
  if (state.link != client::Link::kLive || state.presence.people().empty()) return false;
  return !state.Alone() || !state.Steers();
}

// Draws the person in control and the possible actions, in a width of `room`.
void People(Ui& ui, float room) {
  ImGui::TextUnformatted(Shortened(WhoSteers(ui.state), 0.6F * room).c_str());
  ImGui::SameLine();
  ControlButton(ui);
  Asking(ui, room);
  if (!ui.state.looks_around) return;
  constexpr const char* kState = "You look around";
  constexpr const char* kBack = "Back to presenter";
  const float gap = 20.0F * ui.scale;
  SameLineIfRoom(ImGui::CalcTextSize(kState).x + ButtonWidth(kBack) + 2.0F * gap, room);
  QuietLine(kState);
  ImGui::SameLine(0.0F, gap);
  if (AccentButton(kBack)) ui.session.Follow();
}

// The bar's horizontal position. It lies between the tool rail or open tool and the open panel. If
// that space is too narrow, it spans the window.
struct Place {
  float middle;
  float width;
};

Place PlaceOf(const Ui& ui, const Layout& layout) {
  const bool tool = ui.choices.tool != Tool::kNone;
  const float left = tool ? layout.tool_right() : layout.margin + layout.rail_width;
  const float right =
      layout.window.x -
      (ui.choices.panel == Panel::kNone ? 0.0F : layout.panel_width() + layout.margin);
  const Place between{0.5F * (left + right), right - left - 2.0F * layout.margin};
  const float least = 260.0F * ui.scale;
  if (between.width >= least) return between;
  return {0.5F * layout.window.x, layout.window.x - 2.0F * layout.margin};
}

}  // namespace

void DrawSessionBar(Ui& ui, const Layout& layout) {
  const client::SessionState& state = ui.state;
  const bool gone = state.link == client::Link::kGone;
  if (!gone && !HasCompany(state)) return;
  const float bottom = ui.time_count() > 1 ? layout.bottom() : layout.window.y - layout.margin;
  const Place place = PlaceOf(ui, layout);
  ImGui::SetNextWindowPos({place.middle, bottom}, ImGuiCond_Always, {0.5F, 1.0F});
  constexpr ImGuiWindowFlags kFlags =
      ImGuiWindowFlags_NoTitleBar | ImGuiWindowFlags_AlwaysAutoResize | ImGuiWindowFlags_NoMove |
      ImGuiWindowFlags_NoSavedSettings | ImGuiWindowFlags_NoFocusOnAppearing;
  if (ImGui::Begin("session", nullptr, kFlags)) {
    ImGui::AlignTextToFramePadding();
    if (gone) {
      if (AccentButton("Open a session of your own")) ui.session.OpenAnother();
    } else {
      People(ui, place.width - 2.0F * ImGui::GetStyle().WindowPadding.x);
    }
  }
  ImGui::End();
}

}  // namespace thunderhead::desktop

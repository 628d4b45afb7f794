// Who steers and the one button about it, above the time line; shown while that is of interest.
#include <imgui.h>

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
  return steerer == nullptr ? "Nobody steers" : absl::StrCat(state.NameOf(*steerer), " steers");
}

void ControlButton(Ui& ui) {
  const client::SessionState& state = ui.state;
  const v1::SessionRules& rules = state.presence.rules();
  if (state.Steers()) {
    if (ImGui::Button(state.Presents() ? "Let control go" : "Give control back")) {
      ui.session.GiveControl(0);
    }
  } else if (state.Presents()) {
    if (AccentButton("Take control")) ui.session.TakeControl();
  } else if (state.AsksControl()) {
    ImGui::BeginDisabled();
    ImGui::Button("Asked to steer …");
    ImGui::EndDisabled();
  } else {
    ImGui::BeginDisabled(rules.control_locked());
    const bool at_once = rules.viewers_may_steer() && state.Steerer() == nullptr;
    if (ImGui::Button(at_once ? "Steer" : "Ask to steer")) ui.session.AskControl();
    ImGui::EndDisabled();
  }
}

// Who asks to steer, for the one who answers.
void Asking(Ui& ui) {
  if (!ui.state.Steers() && !ui.state.Presents()) return;
  for (const v1::Person& person : ui.state.presence.people()) {
    if (!person.asks_control()) continue;
    ImGui::PushID(static_cast<int>(person.viewer_id()));
    ImGui::SameLine();
    if (AccentButton(absl::StrCat("Give to ", ui.state.NameOf(person)).c_str())) {
      ui.session.GiveControl(person.viewer_id());
    }
    ImGui::SameLine();
    if (ImGui::Button("No")) ui.session.RefuseControl(person.viewer_id());
    ImGui::PopID();
  }
}

bool HasCompany(const client::SessionState& state) {
  if (state.link != client::Link::kLive || state.presence.people().empty()) return false;
  return !state.Alone() || !state.Steers();
}

// Who steers, and what can be done about it.
void People(Ui& ui) {
  ImGui::TextUnformatted(WhoSteers(ui.state).c_str());
  ImGui::SameLine();
  ControlButton(ui);
  Asking(ui);
  if (!ui.state.looks_around) return;
  ImGui::SameLine(0.0F, 20.0F * ui.scale);
  QuietLine("You look around");
  ImGui::SameLine();
  if (AccentButton("Back to presenter")) ui.session.Follow();
}

}  // namespace

void DrawSessionBar(Ui& ui, const Layout& layout) {
  const client::SessionState& state = ui.state;
  const bool gone = state.link == client::Link::kGone;
  if (!gone && !HasCompany(state)) return;
  const float bottom = ui.time_count() > 1 ? layout.bottom() : layout.window.y - layout.margin;
  ImGui::SetNextWindowPos({0.5F * layout.window.x, bottom}, ImGuiCond_Always, {0.5F, 1.0F});
  constexpr ImGuiWindowFlags kFlags =
      ImGuiWindowFlags_NoTitleBar | ImGuiWindowFlags_AlwaysAutoResize | ImGuiWindowFlags_NoMove |
      ImGuiWindowFlags_NoSavedSettings | ImGuiWindowFlags_NoFocusOnAppearing;
  if (ImGui::Begin("session", nullptr, kFlags)) {
    ImGui::AlignTextToFramePadding();
    if (gone) {
      if (AccentButton("Open a session of your own")) ui.session.OpenAnother();
    } else {
      People(ui);
    }
  }
  ImGui::End();
}

}  // namespace thunderhead::desktop

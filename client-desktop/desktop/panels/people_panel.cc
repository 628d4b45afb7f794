// The panel with the people in the session, who is in control, what viewers may do, and the key
// with which others can join.
#include <imgui.h>

#include <algorithm>
#include <array>
#include <string>

#include "absl/strings/str_cat.h"
#include "desktop/controls.h"
#include "desktop/panels/panels.h"
#include "desktop/style.h"

namespace thunderhead::desktop {
namespace {

void DrawPerson(Ui& ui, const v1::Person& person) {
  const client::SessionState& state = ui.state;
  const bool me = person.viewer_id() == state.viewer_id;
  const bool steers = person.viewer_id() == state.presence.steering_viewer_id();
  std::string notes;
  const auto note = [&notes](bool holds, const char* words) {
    if (holds) absl::StrAppend(&notes, notes.empty() ? "" : ", ", words);
  };
  note(steers, "steers");
  note(person.role() == v1::ROLE_PRESENTER && !person.name().empty(), "presenter");
  note(person.hidden(), "away");
  note(!person.follows(), "looking around");
  note(person.asks_control(), "asks to steer");
  const bool gives = (state.Steers() || state.Presents()) && !me && !steers;
  const float button = gives ? ButtonWidth("Give control") : 0.0F;
  const std::string you = me ? " (you)" : "";
  const float gap = ImGui::GetStyle().ItemSpacing.x;
  const float room =
      ImGui::GetContentRegionAvail().x - button - 2.0F * gap - ImGui::CalcTextSize(you.c_str()).x;
  const std::string name = state.NameOf(person);
  const float of_notes = ImGui::CalcTextSize(notes.c_str()).x;
  const bool beside = std::min(ImGui::CalcTextSize(name.c_str()).x, 0.5F * room) + of_notes <= room;
  ImGui::AlignTextToFramePadding();
  ImGui::TextUnformatted((Shortened(name, room - (beside ? of_notes : 0.0F)) + you).c_str());
  if (beside) {
    ImGui::SameLine();
    QuietLine(notes);
  }
  if (gives) {
    SameLineAtRight(button);
    if (ImGui::Button("Give control")) ui.session.GiveControl(person.viewer_id());
  }
  if (!beside) Quiet(notes);
}

struct Rule {
  const char* label;
  bool (v1::SessionRules::*get)() const;
  void (v1::SessionRules::*set)(bool);
};

constexpr std::array<Rule, 5> kRules{{
    {"A viewer who asks may steer while no one steers", &v1::SessionRules::viewers_may_steer,
     &v1::SessionRules::set_viewers_may_steer},
    {"No one may ask to steer", &v1::SessionRules::control_locked,
     &v1::SessionRules::set_control_locked},
    {"Viewers see what the presenter shows", &v1::SessionRules::following_locked,
     &v1::SessionRules::set_following_locked},
    {"Viewers may point and draw", &v1::SessionRules::viewers_may_mark,
     &v1::SessionRules::set_viewers_may_mark},
    {"Control is free when the presenter is away", &v1::SessionRules::free_when_away,
     &v1::SessionRules::set_free_when_away},
}};

void DrawRules(Ui& ui) {
  Label("Rules");
  ImGui::BeginDisabled(!ui.state.Presents());
  for (const Rule& rule : kRules) {
    bool on = (ui.state.presence.rules().*rule.get)();
    if (!ImGui::Checkbox(rule.label, &on)) continue;
    v1::SessionRules rules;
    (rules.*rule.set)(on);
    ui.session.SetRules(rules);
  }
  ImGui::EndDisabled();
}

void DrawKey(const char* label, const std::string& key) {
  if (key.empty()) return;
  Label(label);
  ImGui::PushID(label);
  const std::string shown = key.substr(0, 24) + (key.size() > 24 ? "…" : "");
  ImGui::AlignTextToFramePadding();
  ImGui::TextUnformatted(shown.c_str());
  SameLineAtRight(ImGui::CalcTextSize("Copy").x + 2.0F * ImGui::GetStyle().FramePadding.x);
  if (ImGui::Button("Copy")) ImGui::SetClipboardText(key.c_str());
  ImGui::PopID();
}

}  // namespace

void PeoplePanel(Ui& ui) {
  constexpr std::size_t kLongestName_bytes = 160;
  if (TextField("Your name", ui.choices.name, kLongestName_bytes)) {
    ui.session.SetName(ui.choices.name);
  }
  ImGui::Spacing();
  for (const v1::Person& person : ui.state.presence.people()) {
    ImGui::PushID(static_cast<int>(person.viewer_id()));
    DrawPerson(ui, person);
    ImGui::PopID();
  }
  ImGui::Spacing();
  DrawRules(ui);
  ImGui::Spacing();
  DrawKey("Viewers' key", ui.state.viewer_key);
  if (!ui.state.viewer_key.empty()) {
    Quiet("Join with --key KEY, or open http://SERVER/?session=KEY.");
  }
  DrawKey("Presenter's key, only for you", ui.state.presenter_key);
}

}  // namespace thunderhead::desktop

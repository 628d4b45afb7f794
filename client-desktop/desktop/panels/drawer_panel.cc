// The panel of all settings. It lists all parameters of the scene in groups, with a search box. The
// list is made from the descriptors of the Protobuf messages.
#include <imgui.h>
#include <imgui_stdlib.h>

#include <string>
#include <vector>

#include "absl/strings/ascii.h"
#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "desktop/controls.h"
#include "desktop/panels/panels.h"
#include "desktop/texts.h"

namespace thunderhead::desktop {
namespace {

using client::Parameter;

// Returns false for parameters that other panels set.
bool IsListed(const Parameter& parameter) {
  return parameter.path != "storm_id" && parameter.path != "time_index" &&
         !absl::EndsWith(parameter.path, "].hydrometeor");
}

bool Matches(const Parameter& parameter, const std::string& wanted) {
  if (wanted.empty()) return true;
  const std::string text =
      absl::AsciiStrToLower(absl::StrCat(parameter.name, " ", parameter.path, " ",
                                         std::string(client::CommentOf(parameter.full_name))));
  return absl::StrContains(text, wanted);
}

std::string TitleOf(std::string group) {
  for (char& letter : group) letter = letter == '_' ? ' ' : letter;
  group[0] = absl::ascii_toupper(static_cast<unsigned char>(group[0]));
  return group;
}

// Returns the label. The label of a list element names the element.
std::string LabelOf(const Ui& ui, const Parameter& parameter) {
  const int index = parameter.steps.front().index;
  if (index < 0) return parameter.name;
  if (parameter.group != "fields") return absl::StrCat(index + 1, ": ", parameter.name);
  if (index >= ui.state.scene.fields_size()) return parameter.name;
  return absl::StrCat(NameOf(ui.state.scene.fields(index).hydrometeor()), ": ", parameter.name);
}

std::string LimitsText(const Ui& ui, const Parameter& parameter) {
  const client::Limits& limits = parameter.limits;
  std::string text = absl::StrCat(FormatQuantity(limits.minimum, limits), " to ",
                                  FormatQuantity(limits.maximum, limits));
  if (limits.default_value) {
    return absl::StrCat(text, ", default ", FormatQuantity(*limits.default_value, limits));
  }
  return client::NumberIn(ui.state.scene, parameter) ? text : text + ", left to the server";
}

void DrawSetting(Ui& ui, const Parameter& parameter) {
  const std::string label = LabelOf(ui, parameter);
  Setting(ui, parameter, label.c_str());
  std::string words(client::CommentOf(parameter.full_name));
  if (parameter.kind == Parameter::Kind::kNumber) {
    words = absl::StrCat(LimitsText(ui, parameter), words.empty() ? "" : ". ", words);
  }
  Quiet(words);
  ImGui::PushID(parameter.path.c_str());
  const bool resettable = parameter.steps.back().field->has_presence() &&
                          client::NumberIn(ui.state.scene, parameter).has_value();
  if (resettable && ImGui::SmallButton("Reset")) {
    ui.Edit(parameter.path, [=](v1::Scene& scene) { client::Clear(scene, parameter); });
  }
  ImGui::PopID();
  ImGui::Separator();
}

}  // namespace

void DrawerPanel(Ui& ui) {
  ImGui::SetNextItemWidth(-1.0F);
  ImGui::InputTextWithHint("##query", "Search by name or meaning", &ui.choices.query);
  const std::string wanted = absl::AsciiStrToLower(absl::StripAsciiWhitespace(ui.choices.query));
  ImGui::BeginChild("settings");
  // This copies the list because an edit changes it.
  const std::vector<Parameter> parameters = ui.parameters;
  std::string group;
  bool open = false;
  bool any = false;
  for (const Parameter& parameter : parameters) {
    if (!IsListed(parameter) || !Matches(parameter, wanted)) continue;
    any = true;
    if (parameter.group != group) {
      group = parameter.group;
      // A group that a search has opened is closed again when the search text is empty.
      const std::string title = TitleOf(group);
      if (!wanted.empty()) ImGui::SetNextItemOpen(true);
      open = ImGui::CollapsingHeader((wanted.empty() ? title : title + "##found").c_str());
    }
    if (!open) continue;
    // Viewers who do not steer can only read the settings.
    ImGui::BeginDisabled(!ui.state.Steers());
    DrawSetting(ui, parameter);
    ImGui::EndDisabled();
  }
  if (!any) Quiet("No setting has such a name.");
  ImGui::EndChild();
}

}  // namespace thunderhead::desktop

#include "desktop/controls.h"

#include <imgui.h>
#include <imgui_stdlib.h>

#include <algorithm>

#include "absl/strings/str_cat.h"
#include "desktop/style.h"
#include "desktop/texts.h"

namespace thunderhead::desktop {
namespace {

using client::Limits;
using client::Parameter;

// Returns true for a number that is typed rather than set by a slider. A slider for such a large
// range, such as positions on Earth in metres, would be too coarse.
bool IsTyped(const Limits& limits) { return limits.maximum > 1e6 && !limits.logarithmic; }

std::string FormatOf(const Limits& limits, const DisplayUnit& unit) {
  const double span = (limits.maximum - limits.minimum) * unit.factor;
  const char* const digits = limits.whole   ? "%.0f"
                             : span > 400.0 ? "%.1f"
                             : span > 20.0  ? "%.2f"
                                            : "%.3f";
  const bool close = unit.symbol.empty() || unit.symbol == "°";
  return absl::StrCat(limits.logarithmic ? "%.3g" : digits, close ? "" : " ", unit.symbol);
}

void BeginLine(const char* label) {
  Label(label);
  ImGui::SetNextItemWidth(-1.0F);
}

const Parameter* Find(const Ui& ui, const std::string& path) {
  const auto found = std::find_if(ui.parameters.begin(), ui.parameters.end(),
                                  [&](const Parameter& each) { return each.path == path; });
  return found == ui.parameters.end() ? nullptr : &*found;
}

void NumberSetting(Ui& ui, const Parameter& parameter, const char* label) {
  const Limits& limits = parameter.limits;
  const std::optional<double> now = client::NumberIn(ui.state.scene, parameter);
  double value = now.value_or(limits.default_value.value_or(limits.minimum));
  const bool changed =
      IsTyped(limits) ? NumberField(label, limits, value) : Slider(label, limits, value);
  if (!changed) return;
  ui.Edit(parameter.path, [=](v1::Scene& scene) { client::SetNumber(scene, parameter, value); });
}

void FlagSetting(Ui& ui, const Parameter& parameter, const char* label) {
  bool on = client::NumberIn(ui.state.scene, parameter).value_or(parameter.default_on) != 0.0;
  if (!ImGui::Checkbox(label, &on)) return;
  ui.Edit(parameter.path, [=](v1::Scene& scene) { client::SetNumber(scene, parameter, on); });
}

void ChoiceSetting(Ui& ui, const Parameter& parameter, const char* label) {
  int value = static_cast<int>(client::NumberIn(ui.state.scene, parameter).value_or(0.0));
  if (!Choice(label, parameter.options, value)) return;
  ui.Edit(parameter.path, [=](v1::Scene& scene) { client::SetNumber(scene, parameter, value); });
}

// Draws a field to type in. Returns true when its value is entered, or when the field is left by
// Tab or a click. ImGui keeps no value between drawings. This function therefore keeps the
// unfinished value of the field that has the keyboard.
template <typename Value, typename Draw>
bool TypeInto(const char* id, Value& value, const Draw& draw) {
  static ImGuiID field = 0;
  static Value typed{};
  const ImGuiID here = ImGui::GetID(id);
  Value now = field == here ? typed : value;
  draw(id, &now);
  const bool entered = ImGui::IsItemDeactivatedAfterEdit();
  if (ImGui::IsItemActive()) {
    field = here;
    typed = now;
  } else if (field == here) {
    field = 0;
  }
  if (entered) value = now;
  return entered;
}

bool TypedNumber(const std::string& format, double& value) {
  return TypeInto("##number", value, [&](const char* id, double* number) {
    ImGui::InputDouble(id, number, 0.0, 0.0, format.c_str());
  });
}

void TextSetting(Ui& ui, const Parameter& parameter, const char* label) {
  constexpr std::size_t kMaxBytes = 256;
  std::string text = client::TextIn(ui.state.scene, parameter);
  if (!TextField(label, text, kMaxBytes)) return;
  ui.Edit(parameter.path, [=](v1::Scene& scene) { client::SetText(scene, parameter, text); });
}

}  // namespace

std::string Shortened(std::string text, float width) {
  const auto fits = [&](const std::string& shown) {
    return ImGui::CalcTextSize(shown.c_str()).x <= width;
  };
  if (fits(text)) return text;
  while (!text.empty() && !fits(text + "…")) text = CutTo(std::move(text), text.size() - 1);
  return text + "…";
}

void Setting(Ui& ui, const std::string& path, const char* label) {
  const Parameter* const parameter = Find(ui, path);
  if (parameter != nullptr) Setting(ui, *parameter, label);
}

void Setting(Ui& ui, const Parameter& parameter, const char* label) {
  // This copies the parameter because an edit changes the list that holds it.
  const Parameter copy = parameter;
  const char* const text = label == nullptr ? copy.name.c_str() : label;
  ImGui::PushID(copy.path.c_str());
  switch (copy.kind) {
    case Parameter::Kind::kNumber:
      NumberSetting(ui, copy, text);
      break;
    case Parameter::Kind::kFlag:
      FlagSetting(ui, copy, text);
      break;
    case Parameter::Kind::kChoice:
      ChoiceSetting(ui, copy, text);
      break;
    case Parameter::Kind::kText:
      TextSetting(ui, copy, text);
      break;
  }
  ImGui::PopID();
}

bool Slider(const char* label, const Limits& limits, double& value) {
  const DisplayUnit unit = DisplayUnitOf(limits);
  const std::string format = FormatOf(limits, unit);
  const double minimum = limits.minimum * unit.factor;
  const double maximum = limits.maximum * unit.factor;
  double shown = value * unit.factor;
  Label(label);
  ImGui::PushID(label);
  const ImGuiSliderFlags flags = limits.logarithmic && limits.minimum >= 0.0
                                     ? ImGuiSliderFlags_Logarithmic
                                     : ImGuiSliderFlags_None;
  // The number is next to the slider, where the slider's grab does not hide it. It is a field, so
  // that it can also be typed.
  const float number_width = 6.4F * ImGui::GetFontSize();
  ImGui::SetNextItemWidth(-number_width - ImGui::GetStyle().ItemSpacing.x);
  bool changed = ImGui::SliderScalar("##slider", ImGuiDataType_Double, &shown, &minimum, &maximum,
                                     "", flags | ImGuiSliderFlags_NoInput);
  ImGui::SameLine();
  ImGui::SetNextItemWidth(-1.0F);
  changed |= TypedNumber(format, shown);
  ImGui::PopID();
  if (changed) value = client::Clamp(shown / unit.factor, limits);
  return changed;
}

bool NumberField(const char* label, const Limits& limits, double& value) {
  const DisplayUnit unit = DisplayUnitOf(limits);
  const std::string format = FormatOf(limits, unit);
  double shown = value * unit.factor;
  BeginLine(label);
  ImGui::PushID(label);
  const bool changed = TypedNumber(format, shown);
  ImGui::PopID();
  if (changed) value = client::Clamp(shown / unit.factor, limits);
  return changed;
}

bool Segments(const char* id, const std::vector<const char*>& labels, int& chosen) {
  ImGui::PushID(id);
  const float gap = 2.0F;
  const auto count = static_cast<float>(labels.size());
  float height = 0.0F;
  for (const char* const label : labels) height = std::max(height, ImGui::CalcTextSize(label).y);
  height += 2.0F * ImGui::GetStyle().FramePadding.y;
  const float width = (ImGui::GetContentRegionAvail().x - gap * (count - 1.0F)) / count;
  bool changed = false;
  for (int i = 0; i < static_cast<int>(labels.size()); ++i) {
    if (i > 0) ImGui::SameLine(0.0F, gap);
    const bool is_chosen = i == chosen;
    if (is_chosen) {
      ImGui::PushStyleColor(ImGuiCol_Button, kAccent);
      ImGui::PushStyleColor(ImGuiCol_ButtonHovered, kAccent);
      ImGui::PushStyleColor(ImGuiCol_Text, kOnAccent);
    }
    const bool pressed = ImGui::Button(labels[static_cast<std::size_t>(i)], {width, height});
    if (is_chosen) ImGui::PopStyleColor(3);
    if (!pressed || is_chosen) continue;
    chosen = i;
    changed = true;
  }
  ImGui::PopID();
  return changed;
}

bool Choice(const char* label, const std::vector<std::pair<int, std::string>>& options,
            int& value) {
  std::string shown = absl::StrCat(value);
  for (const auto& [number, name] : options) {
    if (number == value) shown = name;
  }
  BeginLine(label);
  ImGui::PushID(label);
  bool changed = false;
  if (ImGui::BeginCombo("##choice", shown.c_str())) {
    for (const auto& [number, name] : options) {
      if (ImGui::Selectable(name.c_str(), number == value) && number != value) {
        value = number;
        changed = true;
      }
    }
    ImGui::EndCombo();
  }
  ImGui::PopID();
  return changed;
}

bool TextField(const char* label, std::string& text, std::size_t most_bytes) {
  BeginLine(label);
  ImGui::PushID(label);
  const bool entered = TypeInto(
      "##text", text, [](const char* id, std::string* typed) { ImGui::InputText(id, typed); });
  ImGui::PopID();
  text = CutTo(std::move(text), most_bytes);
  return entered;
}

bool AccentButton(const char* label) {
  ImGui::PushStyleColor(ImGuiCol_Button, kAccent);
  ImGui::PushStyleColor(ImGuiCol_ButtonHovered, ImVec4(1.0F, 0.88F, 0.58F, 1.0F));
  ImGui::PushStyleColor(ImGuiCol_ButtonActive, kAccent);
  ImGui::PushStyleColor(ImGuiCol_Text, kOnAccent);
  const bool pressed = ImGui::Button(label);
  ImGui::PopStyleColor(4);
  return pressed;
}

void Title(const char* text, const char* key) {
  ImGui::PushFont(BoldFont());
  ImGui::TextUnformatted(text);
  ImGui::PopFont();
  if (key == nullptr) return;
  ImGui::PushFont(SmallFont());
  const std::string hint = absl::StrCat("key ", key);
  SameLineAtRight(ImGui::CalcTextSize(hint.c_str()).x);
  ImGui::TextDisabled("%s", hint.c_str());
  ImGui::PopFont();
}

void SameLineAtRight(float width) { ImGui::SameLine(ImGui::GetContentRegionMax().x - width); }

void SameLineIfRoom(float width, float room) {
  const ImGuiStyle& style = ImGui::GetStyle();
  const float end = ImGui::GetItemRectMax().x - ImGui::GetWindowPos().x - style.WindowPadding.x;
  if (end + style.ItemSpacing.x + width <= room) ImGui::SameLine();
}

float ButtonWidth(const std::string& text) {
  return ImGui::CalcTextSize(text.c_str()).x + 2.0F * ImGui::GetStyle().FramePadding.x;
}

void Quiet(const std::string& text) {
  ImGui::PushFont(SmallFont());
  ImGui::PushStyleColor(ImGuiCol_Text, kQuiet);
  ImGui::PushTextWrapPos(0.0F);
  ImGui::TextUnformatted(text.c_str());
  ImGui::PopTextWrapPos();
  ImGui::PopStyleColor();
  ImGui::PopFont();
}

void QuietLine(const std::string& text) {
  ImGui::PushStyleColor(ImGuiCol_Text, kQuiet);
  ImGui::TextUnformatted(text.c_str());
  ImGui::PopStyleColor();
}

void Label(const char* text) {
  ImGui::PushFont(SmallFont());
  ImGui::PushStyleColor(ImGuiCol_Text, kQuiet);
  ImGui::TextUnformatted(text);
  ImGui::PopStyleColor();
  ImGui::PopFont();
  ImGui::SetCursorPosY(ImGui::GetCursorPosY() - 0.6F * ImGui::GetStyle().ItemSpacing.y);
}

}  // namespace thunderhead::desktop

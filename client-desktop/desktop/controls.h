// Controls of the panels: a line each, with label, value and unit.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "desktop/ui.h"

namespace thunderhead::desktop {

// The text, or as much of it as fits into `width` with an ellipsis; in the font that is current.
std::string Shortened(std::string text, float width);
// The control of a scene's parameter by its path, such as "sun.azimuth_deg"; nothing where the
// scene has none such now. The label is the parameter's name where none is given.
void Setting(Ui& ui, const std::string& path, const char* label = nullptr);
void Setting(Ui& ui, const client::Parameter& parameter, const char* label = nullptr);

// A slider in the unit that people read; true when it has moved. `value` is in the schema's unit.
bool Slider(const char* label, const client::Limits& limits, double& value);
// A number to type, for ranges that no slider covers.
bool NumberField(const char* label, const client::Limits& limits, double& value);

// One of several, side by side. The chosen one's index, or -1; true when another was chosen.
bool Segments(const char* id, const std::vector<const char*>& labels, int& chosen);
bool Choice(const char* label, const std::vector<std::pair<int, std::string>>& options, int& value);
bool TextField(const char* label, std::string& text, std::size_t most_bytes);
bool AccentButton(const char* label);

void Title(const char* text, const char* key);
// Goes on in the line, with what is that wide at the right; beside the scroll bar where there is
// one.
void SameLineAtRight(float width);
// Goes on in the line where what is that wide fits into a panel with `room` inside.
void SameLineIfRoom(float width, float room);
float ButtonWidth(const std::string& text);
void Quiet(const std::string& text);  // wrapped, in small grey letters
void QuietLine(const std::string& text);
void Label(const char* text);  // above a control, small

}  // namespace thunderhead::desktop

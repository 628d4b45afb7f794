// Controls of the panels. Most have a small label, and below it the value with its unit.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "desktop/ui.h"

namespace thunderhead::desktop {

// Returns the text, shortened with an ellipsis if it is wider than `width` in ImGui's current font.
std::string Shortened(std::string text, float width);
// Draws the control of the scene's parameter with this path, such as "sun.azimuth_deg". Draws
// nothing if the scene does not have the parameter now. The default label is the parameter's name.
void Setting(Ui& ui, const std::string& path, const char* label = nullptr);
void Setting(Ui& ui, const client::Parameter& parameter, const char* label = nullptr);

// Draws a slider whose number is in the display unit; `value` is in the schema's unit. Returns true
// when the user has moved the slider.
bool Slider(const char* label, const client::Limits& limits, double& value);
// Draws a field to type a number, for ranges that are too large for a slider.
bool NumberField(const char* label, const client::Limits& limits, double& value);

// Draws several options side by side. `chosen` is the index of the chosen option, or -1. Returns
// true when the user chose another.
bool Segments(const char* id, const std::vector<const char*>& labels, int& chosen);
bool Choice(const char* label, const std::vector<std::pair<int, std::string>>& options, int& value);
// Draws a field to type a text. Returns true when the text is entered. A text of more than
// `most_bytes` is cut (CutTo).
bool TextField(const char* label, std::string& text, std::size_t most_bytes);
bool AccentButton(const char* label);

void Title(const char* text, const char* key);
// Keeps the next item on the current line, at the panel's right edge. `width` is the item's width.
// A scroll bar stays to the right of the item.
void SameLineAtRight(float width);
// Keeps the next item on the current line if its `width` fits into a panel whose inner width is
// `room`. Otherwise the item begins a new line.
void SameLineIfRoom(float width, float room);
float ButtonWidth(const std::string& text);
void Quiet(const std::string& text);  // draws wrapped text in small grey letters
void QuietLine(const std::string& text);
void Label(const char* text);  // draws a small label above a control

}  // namespace thunderhead::desktop

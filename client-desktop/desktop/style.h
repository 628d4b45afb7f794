// Colours, fonts and sizes of the interface: dark, translucent panels over the picture.
#pragma once

#include <imgui.h>

namespace thunderhead::desktop {

inline const ImVec4 kAccent{1.0F, 0.82F, 0.42F, 1.0F};
inline const ImVec4 kQuiet{0.67F, 0.72F, 0.79F, 1.0F};
inline const ImVec4 kGood{0.43F, 0.91F, 0.72F, 1.0F};
inline const ImVec4 kBad{1.0F, 0.55F, 0.48F, 1.0F};
inline const ImVec4 kOnAccent{0.10F, 0.11F, 0.13F, 1.0F};

// Sets ImGui's style and fonts. `scale` is the size factor of texts and controls. `pixels_per_unit`
// is the number of screen pixels per unit of the window.
void ApplyStyle(float scale, float pixels_per_unit);

ImFont* BoldFont();
ImFont* SmallFont();

// Begins a panel over the picture, which has no title bar and cannot be moved. Call ImGui::End()
// afterwards, whatever value this function returns.
bool BeginPanel(const char* name, const ImVec2& place, const ImVec2& size,
                ImGuiWindowFlags more = 0);

// Gives the keyboard focus to the current ImGui panel and selects its first control. The arrow keys
// then select other controls.
void GiveKeysToPanel();

}  // namespace thunderhead::desktop

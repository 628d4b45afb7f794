#include "desktop/style.h"

#include <imgui_internal.h>

#include <array>
#include <filesystem>
#include <string>

namespace thunderhead::desktop {
namespace {

constexpr float kText_px = 15.0F;
constexpr float kSmall_px = 13.0F;
constexpr char kFolder[] = "/usr/share/fonts/truetype/dejavu/";

ImFont* bold_font = nullptr;
ImFont* small_font = nullptr;

// The glyphs of the font: Latin with accents, Greek and Cyrillic, general punctuation, arrows, and
// a few symbols.
constexpr std::array<ImWchar, 11> kGlyphs{0x20,   0x24F,  0x370,  0x52F,  0x2010, 0x2044,
                                          0x2190, 0x21FF, 0x25A0, 0x25FF, 0};

ImFont* AddFont(const char* file, float size_px) {
  ImFontAtlas& atlas = *ImGui::GetIO().Fonts;
  const std::string path = std::string(kFolder) + file;
  if (std::filesystem::exists(path)) {
    return atlas.AddFontFromFileTTF(path.c_str(), size_px, nullptr, kGlyphs.data());
  }
  ImFontConfig config;
  config.SizePixels = size_px;
  return atlas.AddFontDefault(&config);
}

void SetColors(ImGuiStyle& style) {
  ImGui::StyleColorsDark(&style);
  ImVec4* const colors = style.Colors;
  colors[ImGuiCol_Text] = {0.94F, 0.96F, 0.98F, 1.0F};
  colors[ImGuiCol_TextDisabled] = kQuiet;
  colors[ImGuiCol_WindowBg] = {0.075F, 0.105F, 0.14F, 0.90F};
  colors[ImGuiCol_PopupBg] = {0.075F, 0.105F, 0.14F, 0.97F};
  colors[ImGuiCol_Border] = {1.0F, 1.0F, 1.0F, 0.10F};
  colors[ImGuiCol_FrameBg] = {0.0F, 0.0F, 0.0F, 0.35F};
  colors[ImGuiCol_FrameBgHovered] = {1.0F, 1.0F, 1.0F, 0.10F};
  colors[ImGuiCol_FrameBgActive] = {1.0F, 1.0F, 1.0F, 0.14F};
  colors[ImGuiCol_Button] = {1.0F, 1.0F, 1.0F, 0.07F};
  colors[ImGuiCol_ButtonHovered] = {1.0F, 1.0F, 1.0F, 0.15F};
  colors[ImGuiCol_ButtonActive] = {1.0F, 1.0F, 1.0F, 0.22F};
  colors[ImGuiCol_Header] = {1.0F, 1.0F, 1.0F, 0.07F};
  colors[ImGuiCol_HeaderHovered] = {1.0F, 1.0F, 1.0F, 0.12F};
  colors[ImGuiCol_HeaderActive] = {1.0F, 1.0F, 1.0F, 0.18F};
  colors[ImGuiCol_SliderGrab] = kAccent;
  colors[ImGuiCol_SliderGrabActive] = kAccent;
  colors[ImGuiCol_CheckMark] = kAccent;
  colors[ImGuiCol_NavHighlight] = kAccent;
  colors[ImGuiCol_TextSelectedBg] = {1.0F, 0.82F, 0.42F, 0.35F};
  colors[ImGuiCol_Separator] = {1.0F, 1.0F, 1.0F, 0.10F};
  colors[ImGuiCol_ScrollbarBg] = {0.0F, 0.0F, 0.0F, 0.0F};
}

}  // namespace

void ApplyStyle(float scale, float pixels_per_unit) {
  ImGuiStyle& style = ImGui::GetStyle();
  style = ImGuiStyle();
  SetColors(style);
  style.WindowRounding = 9.0F;
  style.WindowPadding = {14.0F, 12.0F};
  style.WindowMinSize = {8.0F, 8.0F};
  style.FrameRounding = 7.0F;
  style.FramePadding = {9.0F, 6.0F};
  style.GrabRounding = 7.0F;
  style.GrabMinSize = 12.0F;
  style.PopupRounding = 7.0F;
  style.ScrollbarRounding = 7.0F;
  style.ScrollbarSize = 11.0F;
  style.ItemSpacing = {8.0F, 8.0F};
  style.ScaleAllSizes(scale);
  ImGuiIO& io = ImGui::GetIO();
  io.Fonts->Clear();
  const float size_px = scale * pixels_per_unit;
  io.FontDefault = AddFont("DejaVuSans.ttf", kText_px * size_px);
  bold_font = AddFont("DejaVuSans-Bold.ttf", kText_px * size_px);
  small_font = AddFont("DejaVuSans.ttf", kSmall_px * size_px);
  io.FontGlobalScale = 1.0F / pixels_per_unit;
}

ImFont* BoldFont() { return bold_font; }
ImFont* SmallFont() { return small_font; }

bool BeginPanel(const char* name, const ImVec2& place, const ImVec2& size, ImGuiWindowFlags more) {
  ImGui::SetNextWindowPos(place);
  ImGui::SetNextWindowSize(size);
  constexpr ImGuiWindowFlags kFlags =
      ImGuiWindowFlags_NoTitleBar | ImGuiWindowFlags_NoResize | ImGuiWindowFlags_NoMove |
      ImGuiWindowFlags_NoSavedSettings | ImGuiWindowFlags_NoFocusOnAppearing |
      ImGuiWindowFlags_NoCollapse | ImGuiWindowFlags_NoBringToFrontOnFocus;
  return ImGui::Begin(name, nullptr, kFlags | more);
}

void GiveKeysToPanel() {
  ImGui::SetWindowFocus();
  // SetWindowFocus() alone selects no control, so the arrow keys would still turn the camera.
  ImGuiContext& context = *ImGui::GetCurrentContext();
  ImGui::NavInitWindow(context.CurrentWindow, true);
  context.NavDisableHighlight = false;
  context.NavDisableMouseHover = true;
}

}  // namespace thunderhead::desktop

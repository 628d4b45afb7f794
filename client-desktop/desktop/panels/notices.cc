// Notices at the right, below the top bar and next to an open panel. They show failures and events,
// and while no panel is open also the picture's estimated or measured error.
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

using Clock = std::chrono::steady_clock;

// Time for which a notice is shown.
constexpr std::chrono::seconds kStays{8};

constexpr ImGuiWindowFlags kFlags =
    ImGuiWindowFlags_NoTitleBar | ImGuiWindowFlags_AlwaysAutoResize | ImGuiWindowFlags_NoMove |
    ImGuiWindowFlags_NoSavedSettings | ImGuiWindowFlags_NoFocusOnAppearing;

std::string AccuracyText(const v1::Frame& frame) {
  if (frame.has_refinement()) {
    const v1::Refinement& refinement = frame.refinement();
    std::string text =
        absl::StrCat("Reference · ", refinement.samples_per_pixel(), " paths a pixel");
    if (refinement.has_relative_error()) {
      absl::StrAppendFormat(&text, " · noise %.1f %%", 100.0F * refinement.relative_error());
    }
    return text;
  }
  if (!frame.has_accuracy()) return "";
  const v1::AccuracyReport& accuracy = frame.accuracy();
  return absl::StrCat("This picture is ", FormatPercent(accuracy.estimated_error()), " off\n",
                      ErrorSource(accuracy));
}

// Draws a notice whose upper right corner is at `at`. Moves `at` below it for the next notice.
void Notice(const Layout& layout, const char* id, const std::string& text, const ImVec4& color,
            ImVec2& at) {
  if (text.empty()) return;
  const float width = std::min(440.0F / 12.0F * layout.margin, at.x - layout.margin);
  ImGui::SetNextWindowPos(at, ImGuiCond_Always, {1.0F, 0.0F});
  if (ImGui::Begin(id, nullptr, kFlags)) {
    ImGui::PushStyleColor(ImGuiCol_Text, color);
    ImGui::PushTextWrapPos(width);
    ImGui::TextUnformatted(text.c_str());
    ImGui::PopTextWrapPos();
    ImGui::PopStyleColor();
  }
  at.y += ImGui::GetWindowHeight() + 0.5F * layout.margin;
  ImGui::End();
}

}  // namespace

void DrawNotices(Ui& ui, const Layout& layout) {
  static int seen_count = 0;
  static Clock::time_point said_at{};
  if (ui.state.notice_count != seen_count) {
    seen_count = ui.state.notice_count;
    said_at = Clock::now();
  }
  ImVec2 at(layout.window.x - layout.margin, layout.top());
  if (ui.choices.panel == Panel::kNone) {
    Notice(layout, "accuracy", AccuracyText(ui.frame), ImGui::GetStyle().Colors[ImGuiCol_Text], at);
  } else {
    at.x -= layout.panel_width() + layout.margin;
  }
  if (ui.state.link != client::Link::kLive) Notice(layout, "link", ui.state.reason, kBad, at);
  if (ui.state.problem) Notice(layout, "problem", ui.state.problem->message(), kBad, at);
  Notice(layout, "failure", ui.failure, kBad, at);
  if (ui.state.notice_count > 0 && Clock::now() - said_at < kStays) {
    Notice(layout, "notice", ui.state.notice, kAccent, at);
  }
}

}  // namespace thunderhead::desktop

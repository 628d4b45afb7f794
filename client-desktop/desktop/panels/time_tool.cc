// The tool "Time": the list of the storm's times, and the playback speed.
#include <imgui.h>

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "desktop/controls.h"
#include "desktop/panels/panels.h"
#include "desktop/texts.h"

namespace thunderhead::desktop {

void TimeTool(Ui& ui) {
  const auto& storm = ui.storms.storm;
  const std::string run = NameOfRun(storm);
  Quiet(run.empty() ? "The file does not say when the run began: times count from the first."
                    : absl::StrCat("Model ", run, ". Lead times count from its start."));
  ImGui::BeginDisabled(!ui.state.Steers());
  std::vector<std::pair<int, std::string>> rates;
  int chosen = 0;
  for (int i = 0; i < static_cast<int>(client::Playback::kRates.size()); ++i) {
    const float rate = client::Playback::kRates.at(static_cast<std::size_t>(i));
    rates.emplace_back(i, absl::StrCat(FormatNumber(rate), " a second"));
    if (rate == ui.playback.times_per_second) chosen = i;
  }
  if (Choice("Plays at most", rates, chosen)) {
    ui.playback.times_per_second = client::Playback::kRates.at(static_cast<std::size_t>(chosen));
  }
  ImGui::Checkbox("Begins again after the last time", &ui.playback.loops);
  Label("Times");
  const float height = std::min(9.0F, static_cast<float>(storm.times_size()) + 0.5F) *
                       (ImGui::GetTextLineHeightWithSpacing() + 2.0F * ui.scale);
  ImGui::BeginChild("times", {0.0F, height});
  for (int i = 0; i < storm.times_size(); ++i) {
    ImGui::PushID(i);
    const bool shown = i == ui.time_index();
    if (ImGui::Selectable(FormatValidTime(storm.times(i)).c_str(), shown)) ui.ChooseTime(i);
    ImGui::SameLine(ImGui::GetContentRegionAvail().x - 90.0F * ui.scale);
    QuietLine(FormatElapsed(LeadSeconds(storm, storm.times(i))));
    ImGui::PopID();
  }
  ImGui::EndChild();
  ImGui::EndDisabled();
}

}  // namespace thunderhead::desktop

// The panel with statistics of the pictures: rate, latency, bytes, error, and the time of each
// drawing stage.
#include <imgui.h>

#include "absl/strings/ascii.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_replace.h"
#include "desktop/controls.h"
#include "desktop/panels/panels.h"
#include "desktop/texts.h"

namespace thunderhead::desktop {
namespace {

void Row(const char* name, const std::string& value) {
  ImGui::TableNextRow();
  ImGui::TableNextColumn();
  QuietLine(name);
  ImGui::TableNextColumn();
  ImGui::PushTextWrapPos(0.0F);
  ImGui::TextUnformatted(value.c_str());
  ImGui::PopTextWrapPos();
}

std::string NameOf(v1::Stage stage) {
  constexpr std::size_t kPrefix = sizeof("STAGE_") - 1;
  std::string name = absl::AsciiStrToLower(v1::Stage_Name(stage).substr(kPrefix));
  name = absl::StrReplaceAll(name, {{"_", " "}});
  if (!name.empty()) name[0] = absl::ascii_toupper(static_cast<unsigned char>(name[0]));
  return name;
}

void DrawPicture(const Ui& ui) {
  const client::Statistics::Figures& figures = ui.figures;
  Row("Pictures", absl::StrFormat("%.1f a second", figures.frames_per_s));
  Row("Latency", figures.latency_ms ? absl::StrFormat("%.0f ms", *figures.latency_ms) : "–");
  Row("Received", FormatBitRate(figures.bytes_per_s) + ", " +
                      FormatBytes(static_cast<double>(figures.bytes)) + " in all");
  Row("Decoded in", absl::StrFormat("%.1f ms", figures.decode_ms));
  Row("Left out", absl::StrCat(ui.dropped, " of ", figures.frames + ui.dropped));
  Row("Size", absl::StrCat(ui.frame.width_px(), " x ", ui.frame.height_px(), " ", ui.encoding,
                           ui.frame.refined() ? "" : ", coarse"));
}

void DrawAccuracyRows(const v1::Frame& frame) {
  Row("Technique", frame.modelled().technique());
  if (!frame.has_accuracy()) return;
  const v1::AccuracyReport& accuracy = frame.accuracy();
  Row("Error", DescribeError(accuracy));
  if (accuracy.has_unmet()) Row("Not reached", accuracy.unmet().message());
  if (frame.modelled().traced_paths() > 0) {
    Row("Paths traced",
        absl::StrFormat("%.2f million",
                        static_cast<double>(frame.modelled().traced_paths()) / 1e6));
  }
}

}  // namespace

void ReadoutPanel(Ui& ui) {
  if (!ImGui::BeginTable("figures", 2, ImGuiTableFlags_SizingStretchProp)) return;
  DrawPicture(ui);
  DrawAccuracyRows(ui.frame);
  float sum_ms = 0.0F;
  for (const v1::StageCost& stage : ui.frame.stages()) {
    if (stage.milliseconds() < 0.05F) continue;
    Row(NameOf(stage.stage()).c_str(), absl::StrFormat("%.1f ms", stage.milliseconds()));
    sum_ms += stage.milliseconds();
  }
  if (sum_ms > 0.0F) Row("All stages", absl::StrFormat("%.1f ms", sum_ms));
  ImGui::EndTable();
}

}  // namespace thunderhead::desktop

// The tool "Light": the sun, set by the clock or by hand, and the air through which sunlight
// passes.
#include <imgui.h>

#include "desktop/controls.h"
#include "desktop/panels/panels.h"
#include "desktop/texts.h"

namespace thunderhead::desktop {

void LightTool(Ui& ui) {
  ImGui::BeginDisabled(!ui.state.Steers());
  const bool by_time = ui.state.scene.sun().source() == v1::Sun::SOURCE_BY_TIME;
  int source = by_time ? 0 : 1;
  if (Segments("source", {"By the clock", "By hand"}, source)) {
    const v1::Sun shown = ui.state.shown_sun;
    ui.Edit("sun.source", [=](v1::Scene& scene) {
      v1::Sun& sun = *scene.mutable_sun();
      sun.set_source(source == 0 ? v1::Sun::SOURCE_BY_TIME : v1::Sun::SOURCE_BY_HAND);
      if (source == 0) return;
      // A sun set by hand begins at its current position.
      sun.set_azimuth_deg(shown.azimuth_deg());
      sun.set_elevation_deg(shown.elevation_deg());
    });
  }
  Quiet(DescribeSun(ui.state.shown_sun, ui.true_north_deg()));
  ImGui::Spacing();
  if (by_time) {
    Setting(ui, "sun.clock.date_time", "Date and time at the first time, UTC");
    Setting(ui, "sun.clock.latitude_deg", "Degrees north");
    Setting(ui, "sun.clock.longitude_deg", "Degrees east");
  } else {
    Setting(ui, "sun.azimuth_deg", "Azimuth from the grid's north");
    Setting(ui, "sun.elevation_deg", "Height");
  }
  ImGui::Spacing();
  Setting(ui, "sky.turbidity", "Haze");
  Setting(ui, "sky.brightness", "Light of the sky");
  ImGui::EndDisabled();
}

}  // namespace thunderhead::desktop

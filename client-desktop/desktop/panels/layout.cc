#include <algorithm>

#include "desktop/panels/panels.h"

namespace thunderhead::desktop {

Layout Layout::Of(float width, float height, float scale) {
  Layout layout;
  layout.margin = 12.0F * scale;
  layout.bar_height = 50.0F * scale;
  layout.rail_width = 76.0F * scale;
  layout.line_height = 74.0F * scale;
  // A tool is made narrow enough for an open panel to fit next to it, but not so narrow that its
  // controls become unusable.
  const float beside = (width - 4.0F * layout.margin - layout.rail_width) / (1.0F + kPanelPerTool);
  const float tool_width = std::clamp(beside, 260.0F * scale, 330.0F * scale);
  layout.tool_width = std::min(tool_width, width - 3.0F * layout.margin - layout.rail_width);
  layout.window = {width, height};
  return layout;
}

}  // namespace thunderhead::desktop

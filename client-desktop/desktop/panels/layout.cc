#include <algorithm>

#include "desktop/panels/panels.h"

namespace thunderhead::desktop {

Layout Layout::Of(const Ui& ui) {
  Layout layout;
  layout.margin = 12.0F * ui.scale;
  layout.bar_height = 50.0F * ui.scale;
  layout.rail_width = 76.0F * ui.scale;
  layout.line_height = 74.0F * ui.scale;
  layout.tool_width =
      std::min(330.0F * ui.scale, ui.width - 3.0F * layout.margin - layout.rail_width);
  layout.window = {ui.width, ui.height};
  return layout;
}

}  // namespace thunderhead::desktop

#include "desktop/choices.h"

namespace thunderhead::desktop {

bool Choices::Close() {
  if (panel != Panel::kNone && panel != Panel::kDrawer) {
    panel = Panel::kNone;
  } else if (hand != Hand::kCamera) {
    hand = Hand::kCamera;
  } else if (panel == Panel::kDrawer) {
    panel = Panel::kNone;
  } else if (tool != Tool::kNone) {
    tool = Tool::kNone;
  } else {
    return false;
  }
  return true;
}

}  // namespace thunderhead::desktop

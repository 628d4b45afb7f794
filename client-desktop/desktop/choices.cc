#include "desktop/choices.h"

namespace thunderhead::desktop {

bool Choices::Close() {
  // If the user holds a pen or pointer while the drawer (the panel of every setting) is open, the
  // pen or pointer is put down first. The next Close() then closes the drawer.
  const bool drawer_stays = panel == Panel::kDrawer && hand != Hand::kCamera;
  if (panel != Panel::kNone && !drawer_stays) {
    panel = Panel::kNone;
  } else if (hand != Hand::kCamera) {
    hand = Hand::kCamera;
  } else if (tool != Tool::kNone) {
    tool = Tool::kNone;
  } else {
    return false;
  }
  return true;
}

}  // namespace thunderhead::desktop

#include "desktop/choices.h"

namespace thunderhead::desktop {

bool Choices::Close() {
  // A pen or pointer is put down before the drawer is closed.
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

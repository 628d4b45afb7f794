// Which role may call what. A session's two keys say more: an identity that may call UpdateScene
// still needs the presenter's key to that session.
#pragma once

#include <string_view>

#include "access/identity.h"

namespace thunderhead::access {

// True if a role may call the service's method of that name. A method without a rule is nobody's.
bool MayCall(Role role, std::string_view method);

// True if there is a rule for the method.
bool HasRule(std::string_view method);

// False for a role that is a viewer in every session, whichever of its keys it brings.
bool MayPresent(Role role);

}  // namespace thunderhead::access

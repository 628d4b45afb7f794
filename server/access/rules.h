// The rules that say which role may call what. A session's two keys add restrictions: an identity
// that may call UpdateScene still needs the presenter's key to that session.
#pragma once

#include <string_view>

#include "access/identity.h"

namespace thunderhead::access {

// Returns whether a role may call the service's method of that name. No role may call a method
// without a rule.
bool MayCall(Role role, std::string_view method);

// Returns whether there is a rule for the method.
bool HasRule(std::string_view method);

// Returns false for a role that is a viewer in every session, even with a presenter key.
bool MayPresent(Role role);

}  // namespace thunderhead::access

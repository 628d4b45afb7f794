// The rules that say which role may call which method. A session's two keys are checked in
// addition. For example, an identity that may call UpdateScene also needs the presenter key of that
// session.
#pragma once

#include <string_view>

#include "access/identity.h"

namespace thunderhead::access {

// Returns whether a role may call the service's method named `method`. A method without a rule
// cannot be called by any role.
bool MayCall(Role role, std::string_view method);

// Returns whether there is a rule for the method.
bool HasRule(std::string_view method);

// Returns false for a role that is a viewer in every session, even with a presenter key.
bool MayPresent(Role role);

}  // namespace thunderhead::access

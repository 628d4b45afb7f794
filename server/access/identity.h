// The identity, role and credentials of a caller.
#pragma once

#include <chrono>
#include <optional>
#include <string>
#include <string_view>

#include "absl/status/statusor.h"

namespace thunderhead::access {

// The rights of a caller. docs/operating.md has a table of the rights, and MayCall implements them.
enum class Role {
  kViewer,     // may watch sessions that others opened
  kPresenter,  // may also open sessions, generate clouds and request single images
  kPipeline,   // a program that may request single images, but not open sessions
  kOperator,   // may call everything
};

// Parses "viewer", "presenter", "pipeline" or "operator". For any other text, returns
// INVALID_ARGUMENT with a list of the roles.
absl::StatusOr<Role> ParseRole(std::string_view text);
const char* NameOf(Role role);

struct Identity {
  std::string name;  // with --auth none the client's network; empty for this process itself
  Role role = Role::kViewer;
  std::optional<std::chrono::system_clock::time_point> expires_at = {};
};

// The credentials that a caller presents.
struct Credentials {
  std::string token;  // empty if the caller presents no token
  std::string peer;   // the client's address with its port; empty for this machine's local socket
};

}  // namespace thunderhead::access

// The caller and the caller's role. These are plain values.
#pragma once

#include <chrono>
#include <optional>
#include <string>
#include <string_view>

#include "absl/status/statusor.h"

namespace thunderhead::access {

// The rights of a caller. The table is in docs/operating.md, and the rules are in MayCall.
enum class Role {
  kViewer,     // watches sessions that others opened
  kPresenter,  // also opens sessions, makes clouds and single images
  kPipeline,   // a program: single images, no sessions
  kOperator,   // everything
};

// Parses "viewer", "presenter", "pipeline" or "operator". INVALID_ARGUMENT lists them.
absl::StatusOr<Role> ParseRole(std::string_view text);
const char* NameOf(Role role);

struct Identity {
  std::string name;  // for --auth none the client's network; empty: this process itself
  Role role = Role::kViewer;
  std::optional<std::chrono::system_clock::time_point> expires_at = {};
};

// The credentials that a caller presents.
struct Credentials {
  std::string token;  // empty: none
  std::string peer;   // the client's address with its port; empty: this machine's local socket
};

}  // namespace thunderhead::access

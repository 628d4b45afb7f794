// The saved state of a session, from which a restarted server restores it. Plain values.
#pragma once

#include <chrono>
#include <cstdint>
#include <string>
#include <vector>

#include "session/board.h"
#include "session/roster.h"

namespace thunderhead::session {

// Two keys that each open the session. Neither can be derived from the other.
struct SessionKeys {
  std::string presenter;
  std::string viewer;

  bool operator==(const SessionKeys&) const = default;
};

struct SessionRecord {
  std::string id;
  SessionKeys keys;
  std::string owner;  // identity of the caller that created the session; empty if none
  Rules rules;
  KeptControl control;
  std::string scene;  // as the service serialized it; opaque here
  std::uint64_t scene_revision = 0;
  std::vector<Mark> marks;
  std::chrono::system_clock::time_point last_used;

  bool operator==(const SessionRecord&) const = default;
};

}  // namespace thunderhead::session

// The sessions of a server: each shows one scene, replaced by every update, to any number of
// viewers. A session without viewers expires after a while without use. Safe from any thread. Knows
// no GL and no messages.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "scene/scene.h"
#include "session/frame_hub.h"

namespace thunderhead::session {

using Clock = std::chrono::steady_clock;

// The newest scene of a session.
struct NewestScene {
  std::uint64_t revision = 0;
  std::shared_ptr<const scene::Scene> scene;
  Clock::time_point changed_at;
  // The scene as the service serialized it for viewers; opaque here.
  std::shared_ptr<const std::string> serialized;
};

class Session {
 public:
  // `on_work` is called from any thread when the session may need a frame.
  Session(std::string id, std::function<void()> on_work);

  const std::string& id() const { return id_; }
  FrameHub& hub() { return hub_; }

  // A new revision, larger than all before. Taken when an update arrives, before its scene is
  // complete, so that the update that arrived last wins.
  std::uint64_t TakeRevision();
  // Replaces the newest scene unless that has a newer revision.
  void Show(std::uint64_t revision, scene::Scene scene, std::string serialized = "");
  std::optional<NewestScene> Newest() const;

  void Touch();
  Clock::time_point last_used() const;

 private:
  const std::string id_;
  const std::function<void()> on_work_;
  FrameHub hub_;
  mutable std::mutex mutex_;
  std::uint64_t revision_count_ = 0;
  std::optional<NewestScene> newest_;
  Clock::time_point last_used_ = Clock::now();
};

struct SessionsOptions {
  std::size_t max_sessions = 64;
  Clock::duration idle_timeout = std::chrono::minutes(5);
};

class Sessions {
 public:
  Sessions(const SessionsOptions& options, std::function<void()> on_work);

  // RESOURCE_EXHAUSTED if there are too many, UNAVAILABLE after CloseAll.
  absl::StatusOr<std::shared_ptr<Session>> Create();
  // NOT_FOUND if it never existed, was closed or has expired; UNAVAILABLE after CloseAll. Counts as
  // use.
  absl::StatusOr<std::shared_ptr<Session>> Find(const std::string& id);
  // Ends the session and its viewers' streams. NOT_FOUND as Find.
  absl::Status Close(const std::string& id);
  // Ends every session with `why`; none can be created or found afterwards.
  void CloseAll(const absl::Status& why);

  // The sessions that have not expired, in order of id.
  std::vector<std::shared_ptr<Session>> All();

  std::size_t max_sessions() const { return options_.max_sessions; }

 private:
  void DropExpired();  // needs mutex_

  const SessionsOptions options_;
  const std::function<void()> on_work_;
  std::mutex mutex_;
  std::map<std::string, std::shared_ptr<Session>> sessions_;
  absl::Status closed_because_;
};

}  // namespace thunderhead::session

// Keeps sessions in a store, on its own thread, so that the disk never delays a frame. The disk
// delays only the requests that wait for SaveThen. Restores the sessions when the server starts,
// saves changed sessions twice a second, and removes those that were closed or have expired.
#pragma once

#include <chrono>
#include <condition_variable>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "session/session_store.h"
#include "session/sessions.h"

namespace thunderhead::session {

// A scene decoded from its bytes, and the bytes to send to viewers.
struct DecodedScene {
  scene::Scene scene;
  std::string serialized;
  // Identifies the storm's domain; absent if the storm is not available.
  std::optional<std::string> domain;
};
using DecodeScene = std::function<absl::StatusOr<DecodedScene>(const std::string& serialized)>;

class SessionKeeper {
 public:
  static constexpr std::chrono::milliseconds kPause{500};
  // A session whose other state is unchanged is saved again once its last use is this much later
  // than in its record.
  static constexpr std::chrono::seconds kUsePause{30};

  // Restores the store's sessions into `sessions`, except sessions that are too old. If a scene
  // cannot be decoded, the error is logged, and its session stays in the store until it is too old.
  // Returns the errors of `store`. `store` and `sessions` must outlive the keeper.
  static absl::StatusOr<std::unique_ptr<SessionKeeper>> Start(SessionStore& store,
                                                              Sessions& sessions,
                                                              const DecodeScene& decode);
  // Saves all changes.
  ~SessionKeeper();
  SessionKeeper(const SessionKeeper&) = delete;
  SessionKeeper& operator=(const SessionKeeper&) = delete;

  // The outcome of an attempt to save. The keeper repeats a failed attempt, for example on a full
  // disk.
  struct Outcome {
    absl::Status saved;    // outcome for open sessions
    absl::Status removed;  // outcome for ended sessions
  };

  // Calls `done` on the keeper's thread after the next attempt to save the current state.
  using Done = std::function<void(const Outcome&)>;
  void SaveThen(Done done);

 private:
  // A session, and the version of it that the store holds.
  struct Kept {
    std::shared_ptr<Session> session;
    std::optional<SessionVersion> saved;
    Clock::time_point saved_use;
  };

  SessionKeeper(SessionStore& store, Sessions& sessions) : store_(store), sessions_(sessions) {}
  absl::Status Restore(const DecodeScene& decode);
  Outcome SaveChanges();
  void Log(const absl::Status& outcome);
  void Run();

  SessionStore& store_;
  Sessions& sessions_;
  std::map<std::string, Kept> kept_;  // by id
  absl::Status last_outcome_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::vector<Done> waiting_;
  bool stopping_ = false;
  std::thread thread_;
};

}  // namespace thunderhead::session

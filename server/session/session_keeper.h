// Keeps sessions in a store, on a thread of its own, so that no disk delays a frame or a handler:
// brings them back when the server starts, saves those that have changed twice a second, and
// removes those that were closed or have expired.
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

// A scene read back from its bytes, and the bytes that viewers are sent from now on.
struct DecodedScene {
  scene::Scene scene;
  std::string serialized;
  std::optional<std::string> domain;  // of its storm, if that is there
};
using DecodeScene = std::function<absl::StatusOr<DecodedScene>(const std::string& serialized)>;

class SessionKeeper {
 public:
  static constexpr std::chrono::milliseconds kPause{500};
  // How far the use of a session may be ahead of its record's.
  static constexpr std::chrono::seconds kUsePause{30};

  // Puts the store's sessions into `sessions`, without those that are too old. A scene that cannot
  // be decoded is logged and stays in the store until it is too old. Both must outlive the keeper.
  static absl::StatusOr<std::unique_ptr<SessionKeeper>> Start(SessionStore& store,
                                                              Sessions& sessions,
                                                              const DecodeScene& decode);
  // Saves what has changed.
  ~SessionKeeper();
  SessionKeeper(const SessionKeeper&) = delete;
  SessionKeeper& operator=(const SessionKeeper&) = delete;

  // How an attempt to save ended. One that failed, as on a full disk, is repeated by the keeper.
  struct Outcome {
    absl::Status saved;    // of sessions that are open
    absl::Status removed;  // of sessions that have ended
  };

  // Calls `done` on the keeper's thread after the next attempt to save all that is the case now.
  using Done = std::function<void(const Outcome&)>;
  void SaveThen(Done done);

 private:
  // A session, and what the store has of it.
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

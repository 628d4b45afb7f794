// One session, for a client that stays: opens or joins it by Interact, comes back to the same
// session after any loss, keeps its scene and the server's the same. Every method may be called
// from any thread and returns at once.
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "thunderhead_client/back_off.h"
#include "thunderhead_client/connection.h"
#include "thunderhead_client/control_resumption.h"
#include "thunderhead_client/outbox.h"
#include "thunderhead_client/scene_sync.h"
#include "thunderhead_client/session_state.h"

namespace thunderhead::client {

struct SessionOptions {
  std::string key;   // the presenter's or the viewers'; empty: opens a session of its own
  std::string name;  // that others see, at most 40 characters
  v1::Scene scene;   // that an own session begins with
  v1::SessionRules rules;
  std::vector<v1::Codec> codecs;  // besides JPEG
  v1::Window window;
  // Opens a session of its own in place of a joined one that is gone, and never stops trying.
  bool never_gives_up = false;
  // Timeout of opening a session, and of joining one.
  std::chrono::seconds patience{20};
};

// Calls come on the session's thread, one at a time.
class SessionListener {
 public:
  virtual ~SessionListener() = default;
  // SessionState has changed.
  virtual void Changed() = 0;
  // A call was joined: frames of an earlier one are of no more use.
  virtual void StreamBegan() = 0;
  // `bytes` is the message's size.
  virtual void Received(v1::Frame frame, std::size_t bytes) = 0;
  // A scene with edits of this client was sent, and is taken as that revision.
  virtual void SceneTaken(std::uint64_t revision,
                          std::chrono::steady_clock::time_point sent_at) = 0;
};

class Session {
 public:
  // The listener outlives the session.
  Session(std::shared_ptr<const Connection> connection, SessionOptions options,
          SessionListener& listener);
  // Leaves the session, which stays on the server.
  ~Session();
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;

  SessionState State() const;
  // State() if it is newer than that version.
  std::optional<SessionState> StateAfter(std::uint64_t version) const;

  // Changes the scene. False, and nothing happens, where this client does not steer.
  bool Edit(SceneSync::Edit edit);
  // Moves the session's camera for who steers, else the own view, which begins. False where neither
  // is allowed.
  bool ShowCamera(const v1::Camera& camera);
  // Ends the own view.
  void Follow();

  // A picture of this frame is on the screen; acknowledges it.
  void Shown(const v1::Frame& frame);
  // The frame could not be decoded.
  void VideoLost(const v1::Frame& frame);

  void SetWindow(const v1::Window& window);
  void SetName(const std::string& name);
  // Absent: the pointer goes.
  void Point(const std::optional<v1::Ray>& ray);
  void AddMark(const std::vector<v1::Ray>& rays);
  // Every mark that this person may erase.
  void EraseMarks();
  void AskControl();
  void GiveControl(std::uint64_t viewer_id);
  void RefuseControl(std::uint64_t viewer_id);
  void TakeControl();
  void SetRules(const v1::SessionRules& rules);
  // Ends the wait before the next attempt.
  void RetryNow();
  // After the session has ended: opens one of its own with the same scene.
  void OpenAnother();

 private:
  using Clock = std::chrono::steady_clock;
  struct Outcome {
    Link link = Link::kLost;
    std::string reason;
    std::chrono::milliseconds least{0};
    bool forgotten = false;  // the server does not know the session
  };
  struct Call;

  void Run();
  std::optional<Outcome> Open();
  Outcome Interact();
  void Write(Call& call);
  void Watch(Call& call);
  std::optional<v1::InteractRequest> NextRequest(Call& call, Clock::time_point now);
  Clock::time_point WakeAt(const Call& call) const;
  void Take(Call& call, v1::InteractResponse& response);
  void Joined(Call& call, const v1::Joined& joined);
  void TakePresence(const v1::Presence& presence);
  void TakeRefusal(Call& call, const v1::Refused& refused);
  void TakeScene(Call& call, const v1::SceneTaken& taken, std::unique_lock<std::mutex>& lock);
  bool Wait(const Outcome& outcome, std::chrono::milliseconds delay);
  void Settle(const Outcome& outcome);
  // Forgets the session, so that the next attempt opens another one.
  void LeaveSession();
  void Say(const std::string& notice);
  // Both need mutex_.
  void Send(v1::InteractRequest request);
  void Touch();

  const std::shared_ptr<const Connection> connection_;
  Canceller calls_;
  const SessionOptions options_;
  SessionListener& listener_;
  BackOff back_off_;  // of the runner alone

  mutable std::mutex mutex_;
  std::condition_variable changed_;
  SessionState state_;
  SceneSync sync_;
  Outbox outbox_;
  std::string key_;
  std::string participant_key_;
  std::string name_;
  v1::Window window_;
  bool opened_ = false;          // this client opened the session and has not steered it yet
  bool opens_sessions_ = false;  // it opened the session that key_ is of
  ControlResumption resumption_;
  bool retry_now_ = false;
  bool ends_ = false;
  Call* call_ = nullptr;

  std::thread runner_;
};

}  // namespace thunderhead::client

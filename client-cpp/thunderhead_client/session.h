// A long-lived client of one session. It opens the session by CreateSession unless it has a key,
// joins it by Interact, and joins it again after every connection loss. It keeps its scene
// synchronized with the server's. Any thread may call any method, and every method returns at once.
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
  // Presenter's or viewers' key of the session to join; empty: opens a new session.
  std::string key;
  std::string name;  // shown to others, at most 40 characters
  v1::Scene scene;   // the first scene of a new session
  v1::SessionRules rules;
  std::vector<v1::Codec> codecs;  // accepted encodings in addition to JPEG
  v1::Window window;
  // Opens a new session if a joined session no longer exists, and never stops retrying.
  bool never_gives_up = false;
  // Timeout of opening a session, and of joining one.
  std::chrono::seconds patience{20};
};

// Receives a session's events. The session's thread makes these calls, one at a time.
class SessionListener {
 public:
  virtual ~SessionListener() = default;
  // Reports that SessionState has changed.
  virtual void Changed() = 0;
  // Reports that a new Interact call has joined the session. Video frames of an earlier call cannot
  // be continued.
  virtual void StreamBegan() = 0;
  // Reports a received frame. `bytes` is the message's size.
  virtual void Received(v1::Frame frame, std::size_t bytes) = 0;
  // Reports that the server accepted a scene with this client's edits as `revision`. The scene was
  // sent at `sent_at`.
  virtual void SceneTaken(std::uint64_t revision,
                          std::chrono::steady_clock::time_point sent_at) = 0;
};

class Session {
 public:
  // The listener must outlive the session.
  Session(std::shared_ptr<const Connection> connection, SessionOptions options,
          SessionListener& listener);
  // Leaves the session, which remains on the server.
  ~Session();
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;

  SessionState State() const;
  // Returns State() if its version is greater than `version`; otherwise nothing.
  std::optional<SessionState> StateAfter(std::uint64_t version) const;

  // Changes the scene. Does nothing and returns false if this client does not steer.
  bool Edit(SceneSync::Edit edit);
  // Moves the session's camera if this client steers. Otherwise moves the camera of the client's
  // own view, and begins that view if needed. Returns false if this person may neither steer nor
  // have an own view.
  bool ShowCamera(const v1::Camera& camera);
  // Ends the client's own view, so that the client sees the session's view again.
  void Follow();

  // Acknowledges a frame that is on the screen.
  void Shown(const v1::Frame& frame);
  // Reports that this video frame could not be decoded.
  void VideoLost(const v1::Frame& frame);

  void SetWindow(const v1::Window& window);
  void SetName(const std::string& name);
  // Sends the pointer's ray; an absent ray removes the pointer.
  void Point(const std::optional<v1::Ray>& ray);
  void AddMark(const std::vector<v1::Ray>& rays);
  // Erases every mark that this person may erase.
  void EraseMarks();
  void AskControl();
  void GiveControl(std::uint64_t viewer_id);
  void RefuseControl(std::uint64_t viewer_id);
  void TakeControl();
  void SetRules(const v1::SessionRules& rules);
  // Ends the delay before the next attempt to connect, so that the attempt begins at once.
  void RetryNow();
  // Opens a new session with the same scene after the old one has ended.
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
  // Send() and Touch() require mutex_.
  void Send(v1::InteractRequest request);
  void Touch();

  const std::shared_ptr<const Connection> connection_;
  Canceller calls_;
  const SessionOptions options_;
  SessionListener& listener_;
  BackOff back_off_;  // used only by the runner thread

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
  bool opens_sessions_ = false;  // this client opened the session that key_ belongs to
  ControlResumption resumption_;
  bool retry_now_ = false;
  bool ends_ = false;
  Call* call_ = nullptr;

  std::thread runner_;
};

}  // namespace thunderhead::client

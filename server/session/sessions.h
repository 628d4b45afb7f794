// The sessions of a server. Each session shows one scene to any number of people; every update
// replaces the scene. People join with one of the session's two keys. A session expires when it has
// not been used for a while. Any thread may call it. It uses neither GL nor protobuf messages.
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
#include <utility>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "base/time_source.h"
#include "delivery/frame_hub.h"
#include "delivery/video_encoders.h"
#include "scene/scene.h"
#include "session/audience.h"
#include "session/change_rhythm.h"
#include "session/session_record.h"

namespace thunderhead::session {

using Clock = std::chrono::steady_clock;

// The newest scene of a session.
struct NewestScene {
  std::uint64_t revision = 0;
  std::shared_ptr<const scene::Scene> scene;
  Clock::time_point changed_at;
  // Pause to expect before the next change of the same gesture. 0 if no further change is expected.
  Clock::duration usual_pause{};
  // The scene as the service serialized it for viewers; opaque here.
  std::shared_ptr<const std::string> serialized;
};

// The revisions and values of the parts of a session that are kept in the store.
struct SessionVersion {
  std::uint64_t scene_revision = 0;  // 0 if the session has no scene yet
  std::uint64_t marks_revision = 0;
  Rules rules;
  KeptControl control;

  bool operator==(const SessionVersion&) const = default;
};

// Events that a session reports to its server.
struct SessionSignals {
  std::function<void()> on_work;  // called when the session may need a frame
  std::function<void()> on_due;   // called when Audience::Tick must be called soon
};

class OwnView;

// An update of the scene that was received, but whose scene is not complete yet.
struct IncompleteUpdate {
  // Returns false if the update is no longer valid because its sender lost control. If the function
  // is empty, the update stays valid.
  std::function<bool()> still_counts = {};
  std::string serialized = {};  // the scene as far as it is known; may be empty
};

struct SerializedScene {
  std::uint64_t revision = 0;
  std::string scene;
};

class Session {
 public:
  // `signals` are called from any thread. `time` must outlive the session.
  Session(std::string id, SessionKeys keys, const Rules& rules, Board board,
          const AudienceFormat& format, const SessionSignals& signals,
          const RosterTimeouts& timeouts = {}, std::string owner = "",
          const base::TimeSource& time = base::SteadyTime());

  // Identifies the session in this process. The id is not secret, unlike the keys.
  const std::string& id() const { return id_; }
  const SessionKeys& keys() const { return keys_; }
  // The identity of the caller that created the session; empty if the session has no owner.
  const std::string& owner() const { return owner_; }
  // Returns true for the internal session that draws an OwnView. No key opens such a session.
  bool IsOwnView() const { return keys_.viewer.empty(); }
  delivery::FrameHub& hub() { return hub_; }
  delivery::VideoEncoders& video() { return video_; }
  Audience& audience() { return audience_; }
  // Returns the time that the session, its hub and its audience use.
  Clock::time_point Now() const { return time_.Now(); }

  // Takes and returns a new revision, larger than all earlier ones. A revision is taken when an
  // update arrives, before its scene is complete. So the update that arrived last wins. Show or
  // Drop must follow.
  std::uint64_t TakeRevision(IncompleteUpdate update = {});
  // Takes a revision for an update that was based on revision `expected`. First drops pending
  // revisions that are no longer valid. Returns ABORTED if `expected` is not the newest revision
  // that was taken or shown.
  absl::StatusOr<std::uint64_t> TakeRevisionAfter(std::uint64_t expected,
                                                  IncompleteUpdate update = {});
  // Drops a revision whose scene will not be shown.
  void Drop(std::uint64_t revision);
  // Replaces the newest scene unless the newest scene has a higher revision. `domain` identifies
  // the domain of the scene's storm (storm_store::DomainOf), if known. Returns false if the
  // revision was dropped because its sender lost control. Later changes of the scene do not contain
  // the dropped one.
  bool Show(std::uint64_t revision, scene::Scene scene, std::string serialized = "",
            const std::optional<std::string>& domain = std::nullopt);
  std::optional<NewestScene> Newest() const;
  // Returns the scene of the newest valid update, whether it is complete or not. Returns none
  // before the first update.
  std::optional<SerializedScene> NewestTaken();

  // Shows the scene of a saved record, with a revision that is larger than any that a client has
  // seen.
  void ShowRestored(const SessionRecord& record, scene::Scene scene, std::string serialized,
                    const std::optional<std::string>& domain);

  // Ends all viewers' streams with `why`.
  void Close(const absl::Status& why);
  // Returns true if the session was closed or has expired. Returns false if it ends only because
  // the server stops.
  bool HasEnded() const;

  void Touch();
  Clock::time_point last_used() const;
  bool IsWatched() const;
  // Returns the time of the last use. While there are viewers, it is the current time.
  Clock::time_point UsedUntil() const;

  SessionVersion Version() const;
  SessionRecord Record() const;

 private:
  friend class OwnView;

  // Drops pending revisions whose senders have lost control.
  void DropOverruled();

  const std::string id_;
  const SessionKeys keys_;
  const std::string owner_;
  const SessionSignals signals_;
  const base::TimeSource& time_;
  delivery::FrameHub hub_;
  delivery::VideoEncoders video_;
  Audience audience_;
  mutable std::mutex mutex_;
  std::uint64_t revision_count_ = 0;
  // The updates whose revisions were taken, but neither shown nor dropped yet, by revision.
  std::map<std::uint64_t, IncompleteUpdate> taken_;
  std::optional<NewestScene> newest_;
  ChangeRhythm rhythm_;
  Clock::time_point last_used_ = time_.Now();
  std::vector<std::weak_ptr<OwnView>> own_views_;
};

// The view of a person who looks around: the session's scene from the person's own camera. It is
// drawn as another session, which no key opens.
class OwnView {
 public:
  // Creates a view that follows the session's newest scene, for the identity `owner`.
  static std::shared_ptr<OwnView> Of(const std::shared_ptr<Session>& session, std::string id,
                                     const scene::Camera& camera, std::string owner);

  // The session that draws the view.
  const std::shared_ptr<Session>& drawn() const { return drawn_; }

  void MoveCamera(const scene::Camera& camera);

 private:
  friend class Session;

  explicit OwnView(std::shared_ptr<Session> drawn) : drawn_(std::move(drawn)) {}
  void Follow(const NewestScene& scene);
  void Show();

  const std::shared_ptr<Session> drawn_;
  std::mutex mutex_;
  scene::Camera camera_;
  std::optional<NewestScene> scene_;  // newest scene of the followed session
};

struct SessionsOptions {
  std::size_t max_sessions = 64;
  std::size_t max_sessions_per_owner = 32;
  // A session without viewers expires after this time.
  Clock::duration idle_timeout = std::chrono::minutes(15);
  // A session with viewers expires after this time if none of them acknowledges or sends anything.
  Clock::duration watched_idle_timeout = std::chrono::hours(1);
  // Maximum time since the last use of a stored session, by the system's clock. Older sessions are
  // not restored.
  std::chrono::hours max_absence = std::chrono::hours(24 * 30);
  RosterTimeouts roster_timeouts;
  AudienceFormat format;
  const base::TimeSource* time = &base::SteadyTime();  // must outlive the sessions
};

// A session, and the role of people who join with the key that was searched for.
struct FoundSession {
  std::shared_ptr<Session> session;
  Role role = Role::kViewer;
};

class Sessions {
 public:
  Sessions(const SessionsOptions& options, const SessionSignals& signals);

  // Creates a session. Returns RESOURCE_EXHAUSTED if there are too many sessions in all, or too
  // many of that owner. Returns the reason given to RefuseNew or CloseAll after these calls. The
  // limit per owner does not apply to an empty owner.
  absl::StatusOr<std::shared_ptr<Session>> Create(const Rules& rules = {},
                                                  const std::string& owner = "");
  // Restores the session of a record that another server run saved, as if all its people had just
  // left. The time during which the server was down does not count as idle time, because people
  // could not come back then.
  std::shared_ptr<Session> Restore(const SessionRecord& record, scene::Scene scene,
                                   std::string serialized,
                                   const std::optional<std::string>& domain = std::nullopt);
  // Returns true if a record was last used too long ago to be restored.
  bool IsTooOld(std::chrono::system_clock::time_point last_used) const;
  // Finds a session by either key, which counts as a use of the session. Returns NOT_FOUND if it
  // never existed, was closed or has expired, and UNAVAILABLE after CloseAll.
  absl::StatusOr<FoundSession> Find(const std::string& key);
  // Ends the session and its viewers' streams. Returns the errors of Find, and PERMISSION_DENIED
  // for the viewers' key.
  absl::Status Close(const std::string& presenter_key);
  // Refuses to create sessions from now on, with this reason. Existing sessions continue, and their
  // viewers are woken.
  void RefuseNew(const absl::Status& why);
  // Ends all sessions with `why`. Afterwards no session can be created or found.
  void CloseAll(const absl::Status& why);

  // Opens a view of the session's scene from the given camera, for the identity `owner`. The view
  // is drawn as long as the caller holds the result.
  std::shared_ptr<OwnView> OpenView(const std::shared_ptr<Session>& session,
                                    const scene::Camera& camera, const std::string& owner);

  // Replaces the roster timeouts of all existing and later sessions, also for people who are
  // already waiting.
  void SetRosterTimeouts(const RosterTimeouts& timeouts);

  // Returns the sessions that have not expired, ordered by id.
  std::vector<std::shared_ptr<Session>> All();
  // Returns the sessions of All and the sessions that draw own views: everything that may be drawn.
  std::vector<std::shared_ptr<Session>> AllDrawn();

  std::size_t max_sessions() const { return options_.max_sessions; }
  const base::TimeSource& time() const { return *options_.time; }

 private:
  using Map = std::map<std::string, std::shared_ptr<Session>>;

  void Add(const std::shared_ptr<Session>& session);                // needs mutex_
  absl::StatusOr<Map::iterator> FindByKey(const std::string& key);  // needs mutex_
  std::shared_ptr<Session> Remove(Map::iterator at);                // needs mutex_
  void DropExpired();                                               // needs mutex_

  const SessionsOptions options_;
  const SessionSignals signals_;
  std::mutex mutex_;
  RosterTimeouts roster_timeouts_;
  Map sessions_;  // by id
  // Session id by presenter's key and by viewers' key.
  std::map<std::string, std::string> id_by_key_;
  std::map<std::string, std::weak_ptr<OwnView>> views_;  // by id
  std::uint64_t view_count_ = 0;
  absl::Status closed_because_;
  absl::Status refuses_new_;
};

}  // namespace thunderhead::session

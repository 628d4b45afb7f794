// The sessions of a server: each shows one scene, replaced by every update, to any number of
// people, who come by one of its two keys. A session expires when nobody has used it for a while.
// Safe from any thread. Knows no GL and no messages.
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
  // Before the next change of the gesture that changed it; 0: none is to be expected.
  Clock::duration usual_pause{};
  // The scene as the service serialized it for viewers; opaque here.
  std::shared_ptr<const std::string> serialized;
};

// Counts of changes to what is kept of a session.
struct SessionVersion {
  std::uint64_t scene_revision = 0;  // 0: it has no scene yet
  std::uint64_t marks_revision = 0;
  Rules rules;
  KeptControl control;

  bool operator==(const SessionVersion&) const = default;
};

// Events that a session tells its server of.
struct SessionSignals {
  std::function<void()> on_work;  // it may need a frame
  std::function<void()> on_due;   // Audience::Tick is due soon
};

class OwnView;

// An update whose scene is not complete yet.
struct IncompleteUpdate {
  std::function<bool()> still_counts = {};  // its sender may have lost control; absent: it does
  std::string serialized = {};              // the scene as far as it is known; may be left out
};

struct SerializedScene {
  std::uint64_t revision = 0;
  std::string scene;
};

class Session {
 public:
  // `signals` are called from any thread. `time` must outlive it.
  Session(std::string id, SessionKeys keys, const Rules& rules, Board board,
          const AudienceFormat& format, const SessionSignals& signals,
          const RosterTimeouts& timeouts = {}, std::string owner = "",
          const base::TimeSource& time = base::SteadyTime());

  // Names it in this process; not a secret.
  const std::string& id() const { return id_; }
  const SessionKeys& keys() const { return keys_; }
  // The identity that opened it; empty: nobody's.
  const std::string& owner() const { return owner_; }
  // True for what an OwnView draws, which nobody finds by a key.
  bool IsOwnView() const { return keys_.viewer.empty(); }
  delivery::FrameHub& hub() { return hub_; }
  delivery::VideoEncoders& video() { return video_; }
  Audience& audience() { return audience_; }
  // The time that the session, its hub and its audience go by.
  Clock::time_point Now() const { return time_.Now(); }

  // A new revision, larger than all before. Taken when an update arrives, before its scene is
  // complete, so that the update that arrived last wins. Show or Drop comes after it.
  std::uint64_t TakeRevision(IncompleteUpdate update = {});
  // The same for a change to the revision `expected`. ABORTED if there has been another since, or
  // one is on its way. Those on their way that count no more are dropped.
  absl::StatusOr<std::uint64_t> TakeRevisionAfter(std::uint64_t expected,
                                                  IncompleteUpdate update = {});
  // The revision was taken for a scene that is not to be shown.
  void Drop(std::uint64_t revision);
  // Replaces the newest scene unless that has a newer revision. `domain` is its storm's
  // (storm_store/storm_store.h), if that is known. False if the revision was dropped: changes were
  // made without it.
  bool Show(std::uint64_t revision, scene::Scene scene, std::string serialized = "",
            const std::optional<std::string>& domain = std::nullopt);
  std::optional<NewestScene> Newest() const;
  // The scene of the newest update that counts, complete or not; none before the first.
  std::optional<SerializedScene> NewestTaken();

  // The scene of a record, with a larger revision than any client has seen.
  void ShowRestored(const SessionRecord& record, scene::Scene scene, std::string serialized,
                    const std::optional<std::string>& domain);

  // Ends everybody's stream with `why`.
  void Close(const absl::Status& why);
  // True if it was closed or has expired; not if only the server stops.
  bool HasEnded() const;

  void Touch();
  Clock::time_point last_used() const;
  bool IsWatched() const;
  // Now while somebody watches.
  Clock::time_point UsedUntil() const;

  SessionVersion Version() const;
  SessionRecord Record() const;

 private:
  friend class OwnView;

  // Drops those on their way that count no more.
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
  std::map<std::uint64_t, IncompleteUpdate> taken_;  // by revision; neither shown nor dropped
  std::optional<NewestScene> newest_;
  ChangeRhythm rhythm_;
  Clock::time_point last_used_ = time_.Now();
  std::vector<std::weak_ptr<OwnView>> own_views_;
};

// The view of a person who looks around: the session's scene from a camera of its own. It is drawn
// as another session, which nobody can find by a key.
class OwnView {
 public:
  // Of the session's newest scene from then on, for the identity `owner`.
  static std::shared_ptr<OwnView> Of(const std::shared_ptr<Session>& session, std::string id,
                                     const scene::Camera& camera, std::string owner);

  // The session that draws it.
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
  std::optional<NewestScene> scene_;  // the session's
};

struct SessionsOptions {
  std::size_t max_sessions = 64;
  std::size_t max_sessions_per_owner = 32;
  Clock::duration idle_timeout = std::chrono::minutes(15);  // with nobody there
  // With people there who acknowledge and send nothing.
  Clock::duration watched_idle_timeout = std::chrono::hours(1);
  // By the system's clock: a session that nobody used for longer is not brought back from a store.
  std::chrono::hours max_absence = std::chrono::hours(24 * 30);
  RosterTimeouts roster_timeouts;
  AudienceFormat format;
  const base::TimeSource* time = &base::SteadyTime();  // must outlive the sessions
};

// A session, and the role of who came by the key.
struct FoundSession {
  std::shared_ptr<Session> session;
  Role role = Role::kViewer;
};

class Sessions {
 public:
  Sessions(const SessionsOptions& options, const SessionSignals& signals);

  // RESOURCE_EXHAUSTED if there are too many, in all or of that owner, UNAVAILABLE after RefuseNew
  // and CloseAll. Those without an owner have as many as there may be.
  absl::StatusOr<std::shared_ptr<Session>> Create(const Rules& rules = {},
                                                  const std::string& owner = "");
  // The session of a record from another run, as if everybody had just left: the time that the
  // server was down does not count, as nobody could come back then.
  std::shared_ptr<Session> Restore(const SessionRecord& record, scene::Scene scene,
                                   std::string serialized,
                                   const std::optional<std::string>& domain = std::nullopt);
  // True for a record that was last used too long ago to be brought back.
  bool IsTooOld(std::chrono::system_clock::time_point last_used) const;
  // By either key. NOT_FOUND if it never existed, was closed or has expired; UNAVAILABLE after
  // CloseAll. Counts as use.
  absl::StatusOr<FoundSession> Find(const std::string& key);
  // Ends the session and its viewers' streams. NOT_FOUND as Find; PERMISSION_DENIED for the
  // viewers' key.
  absl::Status Close(const std::string& presenter_key);
  // No session is created from now on, for this reason. Those that there are go on; whoever watches
  // one is woken.
  void RefuseNew(const absl::Status& why);
  // Ends every session with `why`; none can be created or found afterwards.
  void CloseAll(const absl::Status& why);

  // A view of the session's scene from a camera of its own, for the identity `owner`, which is
  // drawn while somebody holds it.
  std::shared_ptr<OwnView> OpenView(const std::shared_ptr<Session>& session,
                                    const scene::Camera& camera, const std::string& owner);

  // Replaces the timeouts of people in these and all later sessions, also for waits that have
  // begun.
  void SetRosterTimeouts(const RosterTimeouts& timeouts);

  // The sessions that have not expired, in order of id.
  std::vector<std::shared_ptr<Session>> All();
  // The same with the own views: everything that may be drawn.
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
  Map sessions_;                                         // by id
  std::map<std::string, std::string> id_by_key_;         // both keys
  std::map<std::string, std::weak_ptr<OwnView>> views_;  // by id
  std::uint64_t view_count_ = 0;
  absl::Status closed_because_;
  absl::Status refuses_new_;
};

}  // namespace thunderhead::session

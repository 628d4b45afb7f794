// The people of a session and their connections. An Audience changes the roster (who is present and
// the person in control) and the board (pointers and marks) under a lock, and sends the new state
// to all people. Each update is serialized once for all people. The constants such as
// kPresencePause limit how often the updates of a kind are sent; older states are skipped. Any
// thread may call it. It does not use protobuf messages.
#pragma once

#include <chrono>
#include <cstdint>
#include <deque>
#include <functional>
#include <limits>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "delivery/frame_hub.h"
#include "session/board.h"
#include "session/roster.h"

namespace thunderhead::session {

// The times of one storm's series whose fields are in memory.
struct HeldTimes {
  std::string storm_id;
  std::vector<int> time_indices;

  bool operator==(const HeldTimes&) const = default;
};

// Functions that serialize the updates for people. The audience only passes the bytes on.
struct AudienceFormat {
  std::function<std::string(const Roster&)> presence = [](const Roster&) { return ""; };
  std::function<std::string(const std::vector<Pointer>&)> pointers = [](const auto&) { return ""; };
  std::function<std::string(const std::vector<Mark>&)> marks = [](const auto&) { return ""; };
  std::function<std::string(const MarksChange&)> marks_change = [](const auto&) { return ""; };
  std::function<std::string(const HeldTimes&)> held_times = [](const auto&) { return ""; };
};

// The newest update of one subject (presence, pointers, marks, ...) that was sent to people.
struct Told {
  std::uint64_t count = 0;  // number of updates so far; 0 before the first
  std::shared_ptr<const std::string> bytes;
};

// A ray from a person's eye, on which the person points or draws.
struct Ray {
  glm::dvec3 origin_m{0.0};
  glm::dvec3 direction{0.0, 1.0, 0.0};  // has length 1
};

class Audience {
 public:
  using Time = Roster::Time;
  using Place = std::function<glm::dvec3(const Ray&)>;

  static constexpr std::chrono::milliseconds kPresencePause{200};
  static constexpr std::chrono::milliseconds kScenePause{200};
  static constexpr std::chrono::milliseconds kPointersPause{33};
  static constexpr std::chrono::milliseconds kMarksPause{200};
  // Maximum number of pointers whose positions one Tick computes. The other pointers wait for the
  // next Tick.
  static constexpr std::size_t kMaxFound = 8;
  // Number of changes of marks that are kept, which cover 6 s of continuous drawing. A person who
  // has missed more changes is sent all marks.
  static constexpr std::size_t kMaxMarksChanges = 32;

  // `on_due` is called, without the lock, when Tick must be called soon.
  Audience(const AudienceFormat& format, const Rules& rules, Board board, Time now,
           std::function<void()> on_due, const RosterTimeouts& timeouts = {});

  // Adds a person and returns the id. `member` is woken when there is an update for the person.
  // Marks with `owner_key` become the new person's. Returns none for a viewer if there are already
  // `most` people and onlookers. A returning person may exceed `most` by one, because the lost
  // connection may not have ended yet.
  std::optional<std::uint64_t> Join(Role role, const std::string& name,
                                    std::shared_ptr<delivery::Viewer> member, Time now,
                                    std::size_t most = std::numeric_limits<std::size_t>::max(),
                                    const std::string& owner_key = "", bool answers_checks = true);
  void Leave(std::uint64_t id, Time now);
  // Adds a connection that only watches and is not in the roster. Returns false for a viewer if
  // there are already `most` people and onlookers.
  bool AddOnlooker(Role role, std::size_t most);
  void RemoveOnlooker();
  // Records that a message came from the person.
  void Heard(std::uint64_t id);
  // Records that the server asked the person for a sign of life because of doubt number `doubts`
  // (Person::doubts).
  void Checked(std::uint64_t id, std::uint64_t doubts, Time now);

  // Functions that change the roster or the board.
  using RosterChange = std::function<absl::Status(Roster&)>;
  using BoardChange = std::function<absl::Status(Board&)>;
  absl::Status Change(const RosterChange& change, Time now);
  absl::Status Draw(std::uint64_t id, const BoardChange& change, Time now);
  // Erases those of the shown marks that have the given ids, or all shown marks if there are no
  // ids. Presenters may erase any marks, viewers only their own. If a viewer names another person's
  // mark, the result is PERMISSION_DENIED and nothing is erased.
  absl::Status Erase(std::uint64_t id, const std::vector<std::uint64_t>& mark_ids, Time now);
  // Moves the person's pointer to the point where the ray meets the storm or the ground. A later
  // Tick computes that point. Without a ray, the pointer is removed. Returns PERMISSION_DENIED for
  // a ray if the person may not mark.
  absl::Status Point(std::uint64_t id, const std::optional<Ray>& ray, Time now);

  // Restores who had control in the previous server run. Must be called before the first person
  // joins.
  void RestoreControl(const KeptControl& kept, Time now);
  // Records that the session shows the scene with that revision, and that all people must be sent
  // it. `domain` identifies the domain of the scene's storm (storm_store::DomainOf). If absent, the
  // previous domain is kept.
  void SceneChanged(std::uint64_t revision, const std::optional<std::string>& domain, Time now);
  // Sets the times in memory of the storm that the session shows. Sends them to all people if they
  // changed.
  void Hold(const HeldTimes& held, Time now);
  // Wakes the connections of all people, for example when the session has ended.
  void WakeAll();

  // The following functions return copies of the state.
  Board Drawn() const;
  Rules CurrentRules() const;
  KeptControl ControlToKeep() const;
  std::uint64_t MarksRevision() const;
  absl::Status MaySteer(std::uint64_t id) const;
  absl::Status PresenterMaySteer() const;
  absl::Status MayMark(std::uint64_t id) const;
  // Returns true if the person is present: they have not left, and were not removed because they
  // gave no sign of life.
  bool IsThere(std::uint64_t id) const;
  std::uint64_t Doubts(std::uint64_t id) const;  // Person::doubts
  bool Follows(std::uint64_t id) const;
  std::uint64_t Returns(std::uint64_t id) const;  // Person::returns
  bool Empty() const;

  // Returns the last presence update for that person. It is empty if that update was made before
  // the person joined.
  Told Presence(std::uint64_t id) const;
  Told Pointers() const;
  // Returns the marks update for a person who has received `count` marks updates: the next change,
  // or all marks if `count` is 0 or that change is no longer kept. The bytes of all marks may
  // already include changes that are also sent later; applying a change twice is harmless.
  Told Marks(std::uint64_t count);
  Told TimesHeld() const;
  // Returns an update without bytes. A new count tells a connection to send the newest scene.
  Told Scene() const;

  // Ends the states of the roster that have timed out (Roster::Advance), computes the positions of
  // pointers, and sends the updates that are due. Returns when it must be called next if nothing
  // happens earlier.
  std::optional<Time> Tick(Time now, const Place& place);

 private:
  // One subject of updates: its last update, and the revision of the state that this update shows.
  struct Subject {
    Told told;
    std::uint64_t told_revision = 0;
    Time told_at;
  };

  struct Member {
    std::shared_ptr<delivery::Viewer> viewer;
    std::uint64_t joined_at = 0;  // revision of the roster when the person joined
  };

  // The following functions need mutex_. TellDue sends the updates that are due, because the
  // minimum pause since the last update of their kind is over. It returns true if it sent any.
  void Forget(std::uint64_t id);
  void TellMarks(Time now);
  bool TellDue(Time now);
  std::map<std::uint64_t, Ray> TakeRays();
  void WithdrawPointers();
  bool IsDue(const Subject& subject, std::uint64_t revision, std::chrono::milliseconds pause,
             Time now);
  void Settle(std::unique_lock<std::mutex> lock, Time now);
  std::vector<std::shared_ptr<delivery::Viewer>> Members() const;  // needs mutex_

  const AudienceFormat format_;
  const std::function<void()> on_due_;
  mutable std::mutex mutex_;
  Roster roster_;
  Board board_;
  std::map<std::uint64_t, Member> members_;
  std::size_t onlookers_ = 0;
  std::map<std::uint64_t, Ray> rays_;  // rays of pointers whose positions must still be computed
  std::set<std::uint64_t> finding_;    // people whose pointer positions are being computed
  // Id of the person whose ray was taken last, so that people take turns.
  std::uint64_t last_found_ = 0;
  Subject presence_;
  Subject pointers_;
  Subject marks_;                                                 // all marks
  std::deque<std::shared_ptr<const std::string>> marks_changes_;  // newest last
  Subject held_times_;
  Subject scene_;
  std::uint64_t scene_revision_ = 0;
  HeldTimes held_;
  std::uint64_t held_revision_ = 0;
};

}  // namespace thunderhead::session

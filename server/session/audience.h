// The people of a session and their connections. Changes the roster and the board under a lock and
// sends the outcome to all of them. Each update is serialized once for all people, a few times a
// second at most, and only the newest state is sent. Safe from any thread; knows no message
// formats.
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

// The times of a storm that are in memory.
struct HeldTimes {
  std::string storm_id;
  std::vector<int> time_indices;

  bool operator==(const HeldTimes&) const = default;
};

// Serializes the updates for people into bytes, which are opaque here.
struct AudienceFormat {
  std::function<std::string(const Roster&)> presence = [](const Roster&) { return ""; };
  std::function<std::string(const std::vector<Pointer>&)> pointers = [](const auto&) { return ""; };
  std::function<std::string(const std::vector<Mark>&)> marks = [](const auto&) { return ""; };
  std::function<std::string(const MarksChange&)> marks_change = [](const auto&) { return ""; };
  std::function<std::string(const HeldTimes&)> held_times = [](const auto&) { return ""; };
};

// The last update about one subject that was sent to people.
struct Told {
  std::uint64_t count = 0;  // number of updates; 0: none yet
  std::shared_ptr<const std::string> bytes;
};

// A ray from a viewpoint.
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
  // Maximum number of pointers whose places are found in one Tick. Further pointers wait for the
  // next.
  static constexpr std::size_t kMaxFound = 8;
  // Number of changes of marks that are kept, which cover 6 s of continuous drawing. A person who
  // has missed more gets all the marks.
  static constexpr std::size_t kMaxMarksChanges = 32;

  // `on_due` is called, without the lock, when Tick must be called soon.
  Audience(const AudienceFormat& format, const Rules& rules, Board board, Time now,
           std::function<void()> on_due, const RosterTimeouts& timeouts = {});

  // Adds a person. `member` is woken when there is an update for it. Marks with `owner_key` become
  // the new person's. Returns none for a viewer if there are already `most` people, onlookers
  // included. A returning person may exceed `most` by one because the lost connection may not have
  // ended yet.
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
  // Records that the person was asked for a sign of life, because of doubt number `doubts`.
  void Checked(std::uint64_t id, std::uint64_t doubts, Time now);

  // Functions that change the roster or the board.
  using RosterChange = std::function<absl::Status(Roster&)>;
  using BoardChange = std::function<absl::Status(Board&)>;
  absl::Status Change(const RosterChange& change, Time now);
  absl::Status Draw(std::uint64_t id, const BoardChange& change, Time now);
  // Erases the marks with those ids, or all of them if there are no ids. Presenters may erase any
  // marks, viewers only their own. If a viewer names another person's mark, the result is
  // PERMISSION_DENIED and nothing is erased.
  absl::Status Erase(std::uint64_t id, const std::vector<std::uint64_t>& mark_ids, Time now);
  // Moves the person's pointer to the point that the ray hits, once Tick has found it. Without a
  // ray, removes the pointer.
  absl::Status Point(std::uint64_t id, const std::optional<Ray>& ray, Time now);

  // Restores the control of the previous server run. Must be called before the first person joins.
  void RestoreControl(const KeptControl& kept, Time now);
  // Records that the session shows a scene of that revision, which all people must be sent.
  // `domain` is the domain of its storm; if absent, the previous domain is kept.
  void SceneChanged(std::uint64_t revision, const std::optional<std::string>& domain, Time now);
  // Sets the times in memory of the storm that the session shows. Sends them to all people if they
  // changed.
  void Hold(const HeldTimes& held, Time now);
  // Wakes all people when the session has ended.
  void WakeAll();

  // The following functions return copies.
  Board Drawn() const;
  Rules CurrentRules() const;
  KeptControl ControlToKeep() const;
  std::uint64_t MarksRevision() const;
  absl::Status MaySteer(std::uint64_t id) const;
  absl::Status PresenterMaySteer() const;
  absl::Status MayMark(std::uint64_t id) const;
  // Returns false for a person who has left or gave no sign of life when asked.
  bool IsThere(std::uint64_t id) const;
  std::uint64_t Doubts(std::uint64_t id) const;  // Person::doubts
  bool Follows(std::uint64_t id) const;
  std::uint64_t Returns(std::uint64_t id) const;  // Person::returns
  bool Empty() const;

  // Returns the last presence update for that person. It is empty if the last update is older than
  // the person's joining.
  Told Presence(std::uint64_t id) const;
  Told Pointers() const;
  // Returns the update of the marks for a person who has received `count` of them: the next change,
  // or all the marks. All the marks may be newer than what others were sent; applying a change
  // twice is harmless. A `count` of 0 gets all the marks.
  Told Marks(std::uint64_t count);
  Told TimesHeld() const;
  // Returns an update without bytes; its count changes when people must take the newest scene.
  Told Scene() const;

  // Ends expired states, finds the places of pointers, and sends the updates that are due. Returns
  // when it must be called next if nothing happens before.
  std::optional<Time> Tick(Time now, const Place& place);

 private:
  // One subject of updates: the last update, and the revision that it was made of.
  struct Subject {
    Told told;
    std::uint64_t told_revision = 0;
    Time told_at;
  };

  struct Member {
    std::shared_ptr<delivery::Viewer> viewer;
    std::uint64_t joined_at = 0;  // revision of the roster at joining
  };

  // The following functions need mutex_. TellDue sends the subjects whose pause is over and returns
  // true if there were any.
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
  std::map<std::uint64_t, Ray> rays_;  // rays of pointers whose places must still be found
  std::set<std::uint64_t> finding_;    // people whose pointers' places are being found
  std::uint64_t last_found_ = 0;       // id of the person whose ray was taken last
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

// The people of a session with their connections: changes the roster and the board under a lock,
// and tells everybody the outcome. What is told is turned into bytes once for all of them, at most
// some times a second, the newest only. Safe from any thread; knows no messages.
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

// Turns what people are told into bytes, which are opaque here.
struct AudienceFormat {
  std::function<std::string(const Roster&)> presence = [](const Roster&) { return ""; };
  std::function<std::string(const std::vector<Pointer>&)> pointers = [](const auto&) { return ""; };
  std::function<std::string(const std::vector<Mark>&)> marks = [](const auto&) { return ""; };
  std::function<std::string(const MarksChange&)> marks_change = [](const auto&) { return ""; };
  std::function<std::string(const HeldTimes&)> held_times = [](const auto&) { return ""; };
};

// The last that people were told of one subject.
struct Told {
  std::uint64_t count = 0;  // of tellings; 0: nothing yet
  std::shared_ptr<const std::string> bytes;
};

// A ray from an eye.
struct Ray {
  glm::dvec3 origin_m{0.0};
  glm::dvec3 direction{0.0, 1.0, 0.0};  // of length 1
};

class Audience {
 public:
  using Time = Roster::Time;
  using Place = std::function<glm::dvec3(const Ray&)>;

  static constexpr std::chrono::milliseconds kPresencePause{200};
  static constexpr std::chrono::milliseconds kScenePause{200};
  static constexpr std::chrono::milliseconds kPointersPause{33};
  static constexpr std::chrono::milliseconds kMarksPause{200};
  // Places of pointers found in one Tick; further people wait for the next.
  static constexpr std::size_t kMaxFound = 8;
  // The last changes of marks, of 6 s if something is drawn all the time. Who has missed more is
  // told all the marks.
  static constexpr std::size_t kMaxMarksChanges = 32;

  // `on_due` is called, without the lock, when Tick is to be called soon.
  Audience(const AudienceFormat& format, const Rules& rules, Board board, Time now,
           std::function<void()> on_due, const RosterTimeouts& timeouts = {});

  // `member` is woken when it is to be told something. The marks with `owner_key`, if there are
  // any, become the newcomer's. None for a viewer where `most` people are, onlookers included; who
  // comes back may be one more, as the lost connection may not have ended yet.
  std::optional<std::uint64_t> Join(Role role, const std::string& name,
                                    std::shared_ptr<delivery::Viewer> member, Time now,
                                    std::size_t most = std::numeric_limits<std::size_t>::max(),
                                    const std::string& owner_key = "", bool answers_checks = true);
  void Leave(std::uint64_t id, Time now);
  // One more who only watches, and is nobody in the roster; false for a viewer where `most` are
  // already, people included.
  bool AddOnlooker(Role role, std::size_t most);
  void RemoveOnlooker();
  // The person has said something.
  void Heard(std::uint64_t id);
  // The person has been asked whether it is there, because of doubt number `doubts`.
  void Checked(std::uint64_t id, std::uint64_t doubts, Time now);

  // Changes the roster or the board.
  using RosterChange = std::function<absl::Status(Roster&)>;
  using BoardChange = std::function<absl::Status(Board&)>;
  absl::Status Change(const RosterChange& change, Time now);
  absl::Status Draw(std::uint64_t id, const BoardChange& change, Time now);
  // Erases those marks, or all: a presenter anybody's, a viewer the own ones. PERMISSION_DENIED,
  // and none is erased, if a viewer names another's.
  absl::Status Erase(std::uint64_t id, const std::vector<std::uint64_t>& mark_ids, Time now);
  // Moves the person's pointer to what the ray meets, as soon as Tick has found it; without a ray
  // it goes.
  absl::Status Point(std::uint64_t id, const std::optional<Ray>& ray, Time now);

  // Control is as it was before the server started again; called before anybody has joined.
  void RestoreControl(const KeptControl& kept, Time now);
  // The session shows a scene of that revision, which everybody is to be sent, and a storm of that
  // domain; absent: of the one before, as far as is known.
  void SceneChanged(std::uint64_t revision, const std::optional<std::string>& domain, Time now);
  // The times in memory of the storm that the session shows; everybody is told if it is news.
  void Hold(const HeldTimes& held, Time now);
  // Wakes everybody, when the session has ended.
  void WakeAll();

  // Copies.
  Board Drawn() const;
  Rules CurrentRules() const;
  KeptControl ControlToKeep() const;
  std::uint64_t MarksRevision() const;
  absl::Status MaySteer(std::uint64_t id) const;
  absl::Status PresenterMaySteer() const;
  absl::Status MayMark(std::uint64_t id) const;
  // False for one who has left, or gave no sign of life when asked.
  bool IsThere(std::uint64_t id) const;
  std::uint64_t Doubts(std::uint64_t id) const;  // Person::doubts
  bool Follows(std::uint64_t id) const;
  std::uint64_t Returns(std::uint64_t id) const;  // Person::returns
  bool Empty() const;

  // For that person: nothing yet where the last telling is older than the person's joining.
  Told Presence(std::uint64_t id) const;
  Told Pointers() const;
  // For one who was told of the marks `count` times: the next change, or all the marks. Those may
  // be newer than what others were told; a change that comes twice is the same as one. Of 0: all.
  Told Marks(std::uint64_t count);
  Told TimesHeld() const;
  // Without bytes: it counts when people were told to take the newest scene.
  Told Scene() const;

  // Ends what has run out, finds where pointers point, and tells what is due. Returns when it is to
  // be called next, if nothing happens before.
  std::optional<Time> Tick(Time now, const Place& place);

 private:
  // One subject: what was told of it, and whether it has changed since.
  struct Subject {
    Told told;
    std::uint64_t told_revision = 0;
    Time told_at;
  };

  struct Member {
    std::shared_ptr<delivery::Viewer> viewer;
    std::uint64_t joined_at = 0;  // the roster's revision
  };

  // All need mutex_. TellDue tells those subjects whose pause is over; true if there were any.
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
  std::map<std::uint64_t, Ray> rays_;  // of pointers whose place is to be found
  std::set<std::uint64_t> finding_;    // people whose pointers' places are being found
  std::uint64_t last_found_ = 0;       // whose ray was taken last
  Subject presence_;
  Subject pointers_;
  Subject marks_;                                                 // all of them
  std::deque<std::shared_ptr<const std::string>> marks_changes_;  // the newest last
  Subject held_times_;
  Subject scene_;
  std::uint64_t scene_revision_ = 0;
  HeldTimes held_;
  std::uint64_t held_revision_ = 0;
};

}  // namespace thunderhead::session

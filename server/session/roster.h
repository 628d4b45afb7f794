// The people of a session: who they are, who steers, who asks to, who looks around, and what the
// rules allow each. A plain value that is told the time; knows no connections and no messages.
//
// One person steers at a time. Control is in one of four states: a person has it; it waits some
// seconds for the one who steered and has lost the connection; it is kept for the presenters, none
// of whom is there; or it is free.
//
// A person is known by a secret key, which a client brings again with the same role when it comes
// back. The connection that it lost may not have ended yet. But the same key is also brought by a
// browser's tab that was duplicated, whose first connection is well. So the person of the first
// connection is doubted: asked for a sign of life, and gone if there is none.
#pragma once

#include <chrono>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"

namespace thunderhead::session {

enum class Role { kPresenter, kViewer };

// The rules of a session.
struct Rules {
  bool viewers_may_steer = true;  // control that is free is given to a viewer who asks
  bool control_locked = false;    // viewers may neither ask for it nor give it to one another
  bool following_locked = false;  // viewers may not look around
  bool viewers_may_mark = false;
  bool free_when_away = false;  // control becomes free when the presenters have been away

  bool operator==(const Rules&) const = default;
};

struct Person {
  std::uint64_t id = 0;  // counts a session's people
  std::string name;      // may be empty
  Role role = Role::kViewer;
  bool follows = true;
  bool hidden = false;                                            // the window
  bool asks = false;                                              // for control
  std::optional<std::chrono::steady_clock::time_point> asked_at;  // last
  std::uint64_t returns = 0;                                      // to the session's view, so far
  std::string key = {};                                           // that the person comes back with
  bool answers = true;                                            // when asked for a sign of life
  std::uint64_t doubts = 0;                                       // how often asked whether there
  std::optional<std::chrono::steady_clock::time_point> doubted_at;  // last, and not heard since
  std::optional<std::chrono::steady_clock::time_point> checked_at;  // when it was told of that

  bool operator==(const Person&) const = default;
};

// Control of a session as it outlives the server: a viewer's, kept for the presenters, or free.
struct KeptControl {
  bool is_free = false;
  // Of the viewer who steers, or for whom control waits. Without a key: nobody.
  std::string viewer_key;
  std::string viewer_name;
  std::uint64_t viewer_id = 0;

  bool operator==(const KeptControl&) const = default;
};

// How long people wait for one another.
struct RosterTimeouts {
  std::chrono::milliseconds answer = std::chrono::seconds(20);    // to a request for control
  std::chrono::milliseconds ask_again = std::chrono::seconds(5);  // the least between two requests
  std::chrono::milliseconds away = std::chrono::seconds(60);      // until control becomes free
  // For how long control waits for a person whose connection was lost, before others get it.
  std::chrono::milliseconds come_back = std::chrono::seconds(10);
  // The same from when the server started again: clients that found none wait longer each time.
  std::chrono::milliseconds come_back_to_new_server = std::chrono::seconds(30);
  // In which a person whose connection is doubted must answer: from when the question was sent on,
  // and in all, since it may wait behind a large picture on a slow link.
  std::chrono::milliseconds sign_of_life = std::chrono::seconds(3);
  std::chrono::milliseconds sign_of_life_in_all = std::chrono::seconds(15);
};

class Roster {
 public:
  using Time = std::chrono::steady_clock::time_point;

  // Control is kept for the presenter, who may be on the way. People are counted from `last_id`,
  // the largest id that somebody had before the server started again.
  Roster(const Rules& rules, Time now, std::uint64_t last_id = 0,
         const RosterTimeouts& timeouts = {})
      : timeouts_(timeouts), rules_(rules), away_since_(now), count_(last_id) {}

  // Before anybody joins: control is as it was before the server started again. It waits for the
  // viewer who steered.
  void RestoreControl(const KeptControl& kept, Time now);
  KeptControl ControlToKeep() const;

  // Adds a person and returns their id. A person with the key and role of somebody whose connection
  // was lost is taken for them: they steer again if control waits for them, and if the other was
  // asking for control, they ask, or get it if it is free by now. Other connections with this key
  // and role are doubted, if they answer questions; `answers` says whether the new one does.
  std::uint64_t Join(Role role, std::string name, Time now, std::string key = "",
                     bool answers = true);
  // Removes the person. Their control, or their request for it, goes to another connection with the
  // same key and role, or waits for one.
  void Leave(std::uint64_t id, Time now);
  // The person has said something.
  void Heard(std::uint64_t id);
  // The person has been asked for a sign of life, because of doubt number `doubts`.
  void Checked(std::uint64_t id, std::uint64_t doubts, Time now);
  // True if somebody is there with that key, which is not empty, and role.
  bool Has(Role role, const std::string& key) const;
  void Rename(std::uint64_t id, std::string name);
  void SetHidden(std::uint64_t id, bool hidden);

  // PERMISSION_DENIED to anybody but the one who steers.
  absl::Status MaySteer(std::uint64_t id) const;
  // For a presenter without a place in the roster, who has only the key: PERMISSION_DENIED while a
  // viewer steers.
  absl::Status PresenterMaySteer() const;

  // Gives control at once if it is free, or to a presenter; else who steers is asked, or a
  // presenter. PERMISSION_DENIED while control is locked, RESOURCE_EXHAUSTED for asking too often.
  absl::Status AskControl(std::uint64_t id, Time now);
  // From the one who steers, or a presenter: to a person, or to nobody (0). Nobody gets a
  // presenter's control, and it is free, for the viewer who asked first if there is one; a viewer's
  // goes back to the presenters. PERMISSION_DENIED while control is locked if a viewer gives it to
  // a viewer.
  absl::Status GiveControl(std::uint64_t from, std::uint64_t to, Time now);
  // The same people may say no.
  absl::Status RefuseControl(std::uint64_t from, std::uint64_t to);
  absl::Status TakeControl(std::uint64_t id);

  absl::Status SetRules(std::uint64_t id, const Rules& rules);
  const Rules& rules() const { return rules_; }

  // Replaces the timeouts, also for waits that have begun.
  void SetTimeouts(const RosterTimeouts& timeouts) { timeouts_ = timeouts; }

  // Leaves the session's view; a viewer may not while following is locked. False if the person has
  // returned to it since Person::returns was `returns`: that came later, and counts.
  absl::StatusOr<bool> Detach(std::uint64_t id, std::uint64_t returns);
  absl::Status Follow(std::uint64_t id);

  absl::Status MayMark(std::uint64_t id) const;

  // Ends requests that nobody answered, and frees control that was kept for too long. Returns those
  // who were doubted in vain: they have left.
  std::vector<std::uint64_t> Advance(Time now);

  // When Advance has something to do next.
  std::optional<Time> NextDeadline() const;

  // In the order in which they came.
  const std::vector<Person>& people() const { return people_; }
  const Person* Find(std::uint64_t id) const;
  // 0: nobody.
  std::uint64_t steering() const { return steering_; }
  bool presenter_away() const;
  // The one for whom control waits, as they left; null: nobody.
  const Person* awaited() const { return awaited_.has_value() ? &awaited_->left : nullptr; }
  bool control_is_free() const {
    return steering_ == 0 && !away_since_.has_value() && !awaited_.has_value();
  }
  // Counts changes of anything above.
  std::uint64_t revision() const { return revision_; }

 private:
  // The one who steered and has lost the connection.
  struct Awaited {
    Person left;
    Time left_at;
    bool server_is_new = false;
  };
  // A request for control by one who has left.
  struct Request {
    Time asked_at;
    bool is_open = false;
  };

  Person* FindPerson(std::uint64_t id);
  // The one who came last with that key and role.
  Person* FindByKey(Role role, const std::string& key);
  absl::Status MayAnswer(std::uint64_t id) const;
  void Give(Person& to);
  void ReturnToView(Person& person);
  // A viewer who asks for control has it at once.
  bool GivesToWhoAsks() const;
  bool FreesWhenAway() const;
  // When one who is doubted is given up.
  Time DoubtEnds(const Person& person) const;
  // When control stops waiting for that person.
  Time WaitEnds(const Awaited& awaited) const;
  // Gives control to nobody, or to the viewer who waits for it longest.
  void Free();
  // To a presenter, or kept for one since then.
  void GiveBack(Time since);

  RosterTimeouts timeouts_;
  Rules rules_;
  // By role and key, for as long as they count.
  std::map<std::pair<Role, std::string>, Request> asked_and_left_;
  std::vector<Person> people_;
  std::uint64_t steering_ = 0;
  std::optional<Time> away_since_;  // while control is kept for presenters
  std::optional<Awaited> awaited_;  // while control waits for that one
  std::uint64_t count_ = 0;
  std::uint64_t revision_ = 1;
};

}  // namespace thunderhead::session

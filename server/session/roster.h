// The people of a session: who they are, who is in control, who asks for control, who looks around,
// and what the rules allow each of them. A plain value; the time is an argument. It uses
// neither connections nor messages.
//
// At most one person steers at a time. Control is in one of four states. A person has it. Or it
// waits some seconds for the person who steered and lost the connection. Or it is kept for the
// presenters while none of them is present. Or it is free.
//
// A person is identified by a secret key. A client that comes back sends the key again, with the
// same role. Its lost connection may still seem to be open. But a duplicated browser tab also sends
// the same key, while the first connection is alive. So the server doubts the first connection: it
// asks that client for a sign of life and removes the person if none arrives.
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
  bool viewers_may_steer = true;  // free control is given to a viewer who asks
  bool control_locked = false;    // viewers may neither ask for control nor give it to one another
  bool following_locked = false;  // viewers may not look around
  bool viewers_may_mark = false;
  // Control becomes free when no presenter has been present for a while.
  bool free_when_away = false;

  bool operator==(const Rules&) const = default;
};

struct Person {
  std::uint64_t id = 0;  // number of the person in the session
  std::string name;      // may be empty
  Role role = Role::kViewer;
  bool follows = true;
  bool hidden = false;  // the window is hidden
  // Has asked for control and waits for an answer.
  bool asks = false;
  // Time of the last request for control.
  std::optional<std::chrono::steady_clock::time_point> asked_at;
  std::uint64_t returns = 0;  // number of returns to the session's view
  std::string key = {};       // secret key that identifies the person on return
  bool answers = true;        // whether the client answers requests for a sign of life
  std::uint64_t doubts = 0;   // number of times that the connection was doubted
  // Time of the last doubt; absent if a message came since.
  std::optional<std::chrono::steady_clock::time_point> doubted_at;
  // Time at which the client was asked for a sign of life.
  std::optional<std::chrono::steady_clock::time_point> checked_at;

  bool operator==(const Person&) const = default;
};

// Who has control, as it is saved across restarts: a viewer, the presenters, or no one.
struct KeptControl {
  bool is_free = false;
  // The viewer who is in control, or for whom control waits. The key is empty if there is no such
  // viewer.
  std::string viewer_key;
  std::string viewer_name;
  std::uint64_t viewer_id = 0;

  bool operator==(const KeptControl&) const = default;
};

// Timeouts of requests for control, and of people whose connections may be lost.
struct RosterTimeouts {
  // Time to answer a request for control.
  std::chrono::milliseconds answer = std::chrono::seconds(20);
  // Minimum time between two requests for control by one person.
  std::chrono::milliseconds ask_again = std::chrono::seconds(5);
  // Control becomes free when no presenter has been present for this long.
  std::chrono::milliseconds away = std::chrono::seconds(60);
  // How long control waits for a person whose connection was lost, before others get it.
  std::chrono::milliseconds come_back = std::chrono::seconds(10);
  // How long control waits for such a person after a restart of the server. The wait is longer
  // because clients wait longer after each failed attempt to reconnect.
  std::chrono::milliseconds come_back_to_new_server = std::chrono::seconds(30);
  // How long a doubted person has to give a sign of life. The first limit counts from when the
  // question was sent, the second from when the doubt began. The second is longer because the
  // question may wait behind a large picture on a slow link.
  std::chrono::milliseconds sign_of_life = std::chrono::seconds(3);
  std::chrono::milliseconds sign_of_life_in_all = std::chrono::seconds(15);
};

class Roster {
 public:
  using Time = std::chrono::steady_clock::time_point;

  // At first, control is kept for a presenter, who may be about to connect. New ids follow
  // `last_id`, the largest id that was in use before the server was restarted.
  Roster(const Rules& rules, Time now, std::uint64_t last_id = 0,
         const RosterTimeouts& timeouts = {})
      : timeouts_(timeouts), rules_(rules), away_since_(now), count_(last_id) {}

  // Restores the control of the previous server run. If a viewer steered, control waits for that
  // viewer. Must be called before the first person joins.
  void RestoreControl(const KeptControl& kept, Time now);
  KeptControl ControlToKeep() const;

  // Adds a person and returns their id. If control waits for a person with that key and role, the
  // new person steers. If a person with that key and role left while asking for control, the new
  // person asks, or gets control if it is free by now. Other connections with this key and role are
  // doubted if their clients answer questions. `answers` says whether the new client does.
  std::uint64_t Join(Role role, std::string name, Time now, std::string key = "",
                     bool answers = true);
  // Removes the person. Their control, or their request for control, goes to another connection
  // with the same key and role. If there is none, control waits for such a connection. If the key
  // is empty, control goes to the presenters.
  void Leave(std::uint64_t id, Time now);
  // Records that a message came from the person.
  void Heard(std::uint64_t id);
  // Records that the server asked the person for a sign of life because of doubt number `doubts`.
  void Checked(std::uint64_t id, std::uint64_t doubts, Time now);
  // Returns true if the key is not empty and a person with that key and role is present.
  bool Has(Role role, const std::string& key) const;
  void Rename(std::uint64_t id, std::string name);
  void SetHidden(std::uint64_t id, bool hidden);

  // Returns PERMISSION_DENIED unless the person steers.
  absl::Status MaySteer(std::uint64_t id) const;
  // Checks whether a caller with the presenter's key that is not in the roster may steer. Returns
  // PERMISSION_DENIED while a viewer steers.
  absl::Status PresenterMaySteer() const;

  // Gives control at once to a presenter. Gives it at once to a viewer if it is free and the rules
  // allow viewers to steer. Otherwise the request goes to the person in control, or to a presenter.
  // Returns PERMISSION_DENIED to a viewer while control is locked, RESOURCE_EXHAUSTED for asking
  // too often, and NOT_FOUND for an unknown id.
  absl::Status AskControl(std::uint64_t id, Time now);
  // Gives control to a person, or gives it up if `to` is 0. The person in control and presenters
  // may do so. Control that a presenter gives up becomes free. It then goes to the viewer who asked
  // first, if the rules allow viewers to steer. Control that a viewer gives up goes back to the
  // presenters. Returns PERMISSION_DENIED to other people, and to a viewer who gives it to a viewer
  // while control is locked. Returns NOT_FOUND for an unknown id.
  absl::Status GiveControl(std::uint64_t from, std::uint64_t to, Time now);
  // Refuses a request for control. The person in control and presenters may do so.
  absl::Status RefuseControl(std::uint64_t from, std::uint64_t to);
  absl::Status TakeControl(std::uint64_t id);

  absl::Status SetRules(std::uint64_t id, const Rules& rules);
  const Rules& rules() const { return rules_; }

  // Replaces the timeouts, also for people who are already waiting.
  void SetTimeouts(const RosterTimeouts& timeouts) { timeouts_ = timeouts; }

  // Makes the person leave the session's view. Returns PERMISSION_DENIED to a viewer while
  // following is locked. Returns false, without an effect, if Person::returns differs from
  // `returns`: the person has returned to the session's view since the request, and the return
  // takes effect.
  absl::StatusOr<bool> Detach(std::uint64_t id, std::uint64_t returns);
  absl::Status Follow(std::uint64_t id);

  absl::Status MayMark(std::uint64_t id) const;

  // Ends unanswered requests for control, and frees control that was kept for too long. Removes
  // doubted people who gave no sign of life, and returns their ids.
  std::vector<std::uint64_t> Advance(Time now);

  // Returns when Advance has something to do next.
  std::optional<Time> NextDeadline() const;

  // Returns the people in the order in which they joined.
  const std::vector<Person>& people() const { return people_; }
  const Person* Find(std::uint64_t id) const;
  // Returns the id of the person in control; 0 if no one is.
  std::uint64_t steering() const { return steering_; }
  bool presenter_away() const;
  // Returns the person for whom control waits, in the state in which they left. Null if control
  // waits for no one.
  const Person* awaited() const { return awaited_.has_value() ? &awaited_->left : nullptr; }
  bool control_is_free() const {
    return steering_ == 0 && !away_since_.has_value() && !awaited_.has_value();
  }
  // Counts the changes of the state that the functions above return.
  std::uint64_t revision() const { return revision_; }

 private:
  // The person who steered and lost the connection.
  struct Awaited {
    Person left;
    Time left_at;
    bool server_is_new = false;
  };
  // A request for control by a person who has left.
  struct Request {
    Time asked_at;
    bool is_open = false;
  };

  Person* FindPerson(std::uint64_t id);
  // Returns the person with that key and role who joined last.
  Person* FindByKey(Role role, const std::string& key);
  absl::Status MayAnswer(std::uint64_t id) const;
  void Give(Person& to);
  void ReturnToView(Person& person);
  // Returns true if a viewer who asks for control gets it at once.
  bool GivesToWhoAsks() const;
  bool FreesWhenAway() const;
  // Returns when a doubted person is removed.
  Time DoubtEnds(const Person& person) const;
  // Returns when control stops waiting for that person.
  Time WaitEnds(const Awaited& awaited) const;
  // Frees control, or gives it to the viewer who has waited longest.
  void Free();
  // Gives control to a presenter. If none is present, keeps control for one, counting the absence
  // from `since`.
  void GiveBack(Time since);

  RosterTimeouts timeouts_;
  Rules rules_;
  // Requests for control by people who left, by role and key, until the requests expire.
  std::map<std::pair<Role, std::string>, Request> asked_and_left_;
  std::vector<Person> people_;
  std::uint64_t steering_ = 0;
  // The time since which control is kept for absent presenters. No value if it is not kept for
  // them.
  std::optional<Time> away_since_;
  std::optional<Awaited> awaited_;  // set while control waits for that person
  std::uint64_t count_ = 0;
  std::uint64_t revision_ = 1;
};

}  // namespace thunderhead::session

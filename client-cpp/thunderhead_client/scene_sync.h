// Synchronizes the client's scene with the session's. Edits are functions of a scene. They are
// applied to the client's scene at once. They are then sent as whole scenes, of which at most a few
// are unanswered at a time. If another viewer has changed the session's scene meanwhile, the edits
// are applied again to that scene. This class has no lock, no thread and no clock.
#pragma once

#include <chrono>
#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "thunderhead/v1/scene.pb.h"

namespace thunderhead::client {

class SceneSync {
 public:
  using Edit = std::function<void(v1::Scene&)>;
  using TimePoint = std::chrono::steady_clock::time_point;

  // The reason why a scene was refused.
  enum class Refusal {
    kStale,    // the scene is based on an older revision than the session's current scene
    kBusy,     // the server may accept the same scene later
    kRefused,  // the server will never accept this scene
  };

  struct Outgoing {
    std::uint64_t ticket = 0;  // identifies this scene in Taken() or Refused()
    v1::Scene scene;
    std::uint64_t expected_revision = 0;
  };

  // Returns the client's scene, which includes every edit.
  const v1::Scene& scene() const { return scene_; }
  // Returns the revision that the edits are based on; 0 before the server has sent a revision.
  std::uint64_t revision() const { return revision_.value_or(0); }
  // Returns true once the server has accepted every edit.
  bool Settled() const { return edits_.empty(); }

  void Edited(Edit edit);
  // Reports the session's scene and its revision, as the server sent them. A scene that is older
  // than the newest known one is ignored.
  void Told(const v1::Scene& scene, std::uint64_t revision);
  // Reports that the client has joined a session. The next scene from the server is adopted,
  // whatever its revision.
  void Rejoined();
  // Discards edits while another viewer steers, until Keep(). Scenes in flight wait for their
  // response, because they may have arrived before the other viewer took control.
  void Discard();
  // Stops discarding edits, because this client steers.
  void Keep() { discards_ = false; }
  // Returns true once after edits were discarded.
  bool TakeDiscarded() { return std::exchange(discarded_, false); }

  // Returns the next scene to send, if one is due now.
  std::optional<Outgoing> Next(TimePoint now);
  // Returns the earliest time at which Next() may return a scene although no other method was
  // called. Returns nothing if Next() needs such a call first.
  std::optional<TimePoint> WakeAt() const;

  void Taken(std::uint64_t ticket, std::uint64_t revision);
  void Refused(std::uint64_t ticket, Refusal refusal, TimePoint now);

 private:
  struct Version {
    v1::Scene scene;
    std::uint64_t revision = 0;
  };
  struct Sent {
    std::uint64_t last_edit = 0;
    std::uint64_t expected_revision = 0;
    v1::Scene scene;
  };
  struct Numbered {
    std::uint64_t number = 0;
    Edit edit;
  };

  void Rebase(const Version& version);
  void AdoptTold();
  void Drop(std::uint64_t last_edit);
  void Answered();
  void GiveUp();
  void Merge();

  v1::Scene scene_;
  std::optional<std::uint64_t> revision_;
  std::optional<Version> told_;  // the newest version that the server is known to have
  std::deque<Numbered> edits_;
  std::uint64_t last_edit_ = 0;
  bool unsent_ = false;                 // edits were made after the last scene was sent
  std::map<std::uint64_t, Sent> sent_;  // unanswered scenes, by ticket
  std::uint64_t last_ticket_ = 0;
  // Revision that the last sent scene will get if the server accepts it.
  std::uint64_t awaited_ = 0;
  bool drains_ = false;     // a scene was refused or got an unexpected revision, so nothing is sent
                            // until all responses are in
  bool discards_ = false;   // another viewer steers
  bool discarded_ = false;  // edits were discarded since TakeDiscarded()
  // After a refusal as stale, nothing is sent before the server's newer scene is known or this time
  // has come.
  std::optional<TimePoint> stale_until_;
  std::optional<TimePoint> busy_until_;  // the server has too much to do
};

}  // namespace thunderhead::client

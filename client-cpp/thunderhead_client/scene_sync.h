// Keeps the client's scene and the session's the same. Edits are functions of a scene: they are
// applied to the client's at once, sent a few at a time as whole scenes, the newest winning, and
// applied again to the server's scene where somebody else changed that meanwhile. A plain value: no
// threads, no clock of its own.
#pragma once

#include <chrono>
#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "thunderhead/v1/scene.pb.h"

namespace thunderhead::client {

class SceneSync {
 public:
  using Edit = std::function<void(v1::Scene&)>;
  using TimePoint = std::chrono::steady_clock::time_point;

  // The answer to a scene that was not taken.
  enum class Refusal {
    kStale,    // the session's scene is another one than the edits were made to
    kBusy,     // the same scene may be taken later
    kRefused,  // never
  };

  struct Outgoing {
    std::uint64_t ticket = 0;  // names it in its answer
    v1::Scene scene;
    std::uint64_t expected_revision = 0;
  };

  // The client's scene, with every edit.
  const v1::Scene& scene() const { return scene_; }
  // The revision that it was made from; 0 before any is known.
  std::uint64_t revision() const { return revision_.value_or(0); }
  // True once the server has taken every edit.
  bool Settled() const { return edits_.empty(); }

  void Edited(Edit edit);
  // The session's scene.
  void Told(const v1::Scene& scene, std::uint64_t revision);
  // Joined, again or another session: the next scene told is adopted whatever its revision.
  void Rejoined();
  // Another steers: gives up what the server has not taken. True if that was anything.
  bool Discard();

  // The next scene to send, if one is to be sent now.
  std::optional<Outgoing> Next(TimePoint now);
  // The earliest time at which Next() may have one that it has not now; nothing where only an event
  // can bring one.
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
  void Merge();

  v1::Scene scene_;
  std::optional<std::uint64_t> revision_;
  std::optional<Version> told_;  // the newest that the server is known to have
  std::deque<Numbered> edits_;
  std::uint64_t last_edit_ = 0;
  bool unsent_ = false;                 // edits were made after the last one sent
  std::map<std::uint64_t, Sent> sent_;  // without an answer, by ticket
  std::uint64_t last_ticket_ = 0;
  std::uint64_t awaited_ = 0;  // the revision that the last one sent becomes
  bool drains_ = false;        // one was not taken, so the others will not be
  std::optional<TimePoint> rests_until_;
};

}  // namespace thunderhead::client

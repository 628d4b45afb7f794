// Distributes a session's newest frame to its viewers. Each viewer has at most two unacknowledged
// frames; a slow one skips frames and never slows another. A viewer with a slow link or a small
// window gets smaller pictures; each size is encoded once, whatever the number of viewers. The hub
// keeps only one frame and one problem. Safe from any thread. Does not know how frames are drawn or
// sent.
#pragma once

#include <array>
#include <chrono>
#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <random>
#include <string>
#include <variant>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "scene/scene.h"
#include "scene/view.h"
#include "session/frame_source.h"
#include "session/link_estimate.h"

namespace thunderhead::session {

// A frame ready to be sent.
struct EncodedFrame {
  std::uint64_t sequence = 0;  // counts the session's frames from 1; set by the hub
  std::uint64_t scene_revision = 0;
  std::string jpeg;
  int jpeg_quality = 0;
  int width_px = 0;
  int height_px = 0;
  scene::Camera camera;
  scene::View view;
  scene::Sun sun;
  std::vector<StageTime> stages;
  Modelled modelled;
  bool refined = false;
  int tier = 0;
  std::optional<Refinement> refinement;  // of a picture by the reference
  std::optional<AccuracyReport> accuracy;
  // When the scene became what it shows; none if that has changed since.
  std::optional<std::chrono::steady_clock::time_point> changed_at;
  // The frame without its sequence as the service serialized it, once for all viewers; opaque here.
  std::string serialized;
};

// The reason why the scene of a revision has no frame.
struct Problem {
  enum class Code {
    kStormGone,
    kStormUnreadable,
    kScene,  // asks for something that cannot be drawn
    kBusy,
    kInternal,
  };

  std::uint64_t scene_revision = 0;
  std::string message;
  Code code = Code::kInternal;
};

// The problem of a scene that could not be drawn.
Problem ProblemOf(std::uint64_t scene_revision, const absl::Status& why);
// The problem of a scene whose storm could not be read.
Problem UnreadableStorm(std::uint64_t scene_revision, const absl::Status& why);

// Makes the frame with its picture in a tier above 0 (link_estimate.h).
using ReduceFrame = std::function<EncodedFrame(const EncodedFrame& full, int tier)>;

// A frame in all its tiers, each made when it is first wanted. Safe from any thread.
class PublishedFrame {
 public:
  // Without `reduce` every tier is the full frame.
  PublishedFrame(EncodedFrame full, ReduceFrame reduce);

  const EncodedFrame& Full() const { return *tiers_[0]; }
  std::shared_ptr<const EncodedFrame> At(int tier);

 private:
  const ReduceFrame reduce_;
  std::mutex mutex_;
  std::array<std::shared_ptr<const EncodedFrame>, kTiers> tiers_;
};

using FrameEvent = std::variant<std::shared_ptr<const EncodedFrame>, Problem>;

// What a viewer wants of the frames.
struct ViewerWants {
  int window_width_px = 0;         // 0: as the scene asks
  double frames_per_second = 0.0;  // at most; 0: as many as there are
  bool adapts = false;             // takes smaller pictures on a slow link

  bool operator==(const ViewerWants&) const = default;
};

// A viewer of the session. Wake is called from any thread, without the hub's lock, when Take may
// have something or the hub has closed.
class Viewer {
 public:
  virtual ~Viewer() = default;
  virtual void Wake() = 0;
};

class FrameHub {
 public:
  using Time = std::chrono::steady_clock::time_point;

  static constexpr std::size_t kMaxInFlight = 2;

  // `on_demand` is called, without the lock, whenever a viewer joins, leaves or becomes ready for
  // another frame. `on_wait` is called, without the lock, when WakeWaiting is to be called in time.
  explicit FrameHub(
      std::function<void()> on_demand, std::function<void()> on_wait = [] {});

  // Returns the viewer's id, or the reason given to Close. Does not call Wake.
  absl::StatusOr<std::uint64_t> Join(std::shared_ptr<Viewer> viewer, const ViewerWants& wants = {});
  void SetWants(std::uint64_t viewer_id, const ViewerWants& wants);
  void Leave(std::uint64_t viewer_id);

  // Takes the newest frame or problem that the viewer has not had, unless too many of its frames
  // are in flight, i.e. taken and not yet acknowledged, or it wants fewer a second.
  std::optional<FrameEvent> Take(std::uint64_t viewer_id,
                                 Time now = std::chrono::steady_clock::now());

  // Acknowledges every frame up to `sequence`. Wakes the viewer only if it may now take something,
  // and demands a frame only if it could take none before. False if there is no such viewer.
  bool Acknowledge(std::uint64_t viewer_id, std::uint64_t sequence,
                   Time now = std::chrono::steady_clock::now());

  // Wakes those who have waited long enough for their next frame, as they want few a second.
  // Returns when the next has.
  std::optional<Time> WakeWaiting(Time now);

  // Replaces the newest frame, encoded in every tier that a viewer wants now.
  void Publish(EncodedFrame frame, ReduceFrame reduce = nullptr);
  // Replaces the newest problem; a frame of the same or a newer revision ends it.
  void Publish(Problem problem);

  // Ends every viewer's stream with `why`; the first reason counts.
  void Close(const absl::Status& why);
  // OK while open.
  absl::Status ClosedBecause() const;

  bool HasViewers() const;
  int ViewerCount() const;
  // True if a viewer can be sent another frame now.
  bool HasReadyViewer() const;

 private:
  struct Sent {
    std::uint64_t sequence = 0;
    Time at;
    bool moving = false;             // not a still
    std::optional<Time> changed_at;  // of the first frame of a revision
  };
  struct Watch {
    std::shared_ptr<Viewer> viewer;
    ViewerWants wants;
    LinkEstimate link;
    std::deque<Sent> in_flight;  // oldest first
    std::uint64_t last_sequence = 0;
    int last_tier = 0;
    std::optional<Time> waits_until;  // for its next frame
    std::uint64_t last_problem = 0;
    std::uint64_t last_revision = 0;
  };

  static int TierFor(const Watch& watch, const EncodedFrame& frame);
  static bool IsReady(const Watch& watch, Time now);
  // Need mutex_.
  bool HasFor(const Watch& watch, Time now) const;
  bool HasFrameFor(const Watch& watch, Time now) const;
  void WakeAll();

  const std::function<void()> on_demand_;
  const std::function<void()> on_wait_;
  mutable std::mutex mutex_;
  std::map<std::uint64_t, Watch> watches_;
  std::shared_ptr<PublishedFrame> frame_;
  std::optional<Problem> problem_;
  std::uint64_t problem_count_ = 0;
  std::uint64_t frame_count_ = 0;
  // Viewers' ids cannot be guessed, as who knows one may acknowledge for it.
  std::random_device random_;
  absl::Status closed_because_;
};

}  // namespace thunderhead::session

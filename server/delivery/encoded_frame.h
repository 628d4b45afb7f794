// A frame that is ready to be sent, or the reason why a scene has no frame. Plain values.
#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "base/memory_budget.h"
#include "delivery/frame_content.h"
#include "scene/scene.h"
#include "scene/view.h"

namespace thunderhead::delivery {

// A frame ready to be sent.
struct EncodedFrame {
  std::uint64_t sequence = 0;  // number of the frame in its session, counted from 1; set by the hub
  std::uint64_t scene_revision = 0;
  // The encoded picture. At most one of these three is not empty.
  std::string jpeg;
  std::string vp9;
  std::string avif;
  bool key_frame = false;  // whether vp9 holds a key picture, which needs no earlier picture
  int width_px = 0;
  int height_px = 0;
  int full_width_px = 0;  // width of the same scene's picture at rest; 0 means width_px
  scene::Camera camera;
  scene::View view;
  scene::Sun sun;
  std::vector<StageTime> stages;
  Modelled modelled;
  bool refined = false;
  bool at_rest = false;  // drawn after the scene had not changed for a while
  int tier = 0;
  std::optional<Refinement> refinement;  // set if the Monte Carlo reference drew the picture
  std::optional<AccuracyReport> accuracy;
  // The time of the scene change that the frame shows. Absent if the scene has changed again
  // meanwhile.
  std::optional<std::chrono::steady_clock::time_point> changed_at;
  // The memory reservation for the picture's pixels and encoded bytes. It is held as long as a
  // frame with this picture is kept or waits to be sent.
  std::shared_ptr<const base::MemoryReservation> memory;
  // The message with the frame, without its sequence number. The service serializes it once for all
  // viewers; the hub only passes it on.
  std::string serialized;
};

// The reason why the scene of a revision has no frame.
struct Problem {
  enum class Code {
    kStormGone,
    kStormUnreadable,
    kScene,  // the scene asks for something that cannot be drawn
    kBusy,
    kInternal,
  };

  std::uint64_t scene_revision = 0;
  std::string message;
  Code code = Code::kInternal;
};

// Returns the Problem for a scene that could not be drawn because of `why`. Counts it among the
// server's refused requests.
Problem ProblemOf(std::uint64_t scene_revision, const absl::Status& why);
// Returns the Problem for a scene whose storm could not be read because of `why`. Counts it among
// the server's refused requests.
Problem UnreadableStorm(std::uint64_t scene_revision, const absl::Status& why);

}  // namespace thunderhead::delivery

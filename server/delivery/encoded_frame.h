// A frame as it is sent, and the reason why there is none. Plain values.
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
  std::uint64_t sequence = 0;  // counts the session's frames from 1; set by the hub
  std::uint64_t scene_revision = 0;
  // The picture, in one of these encodings.
  std::string jpeg;
  std::string vp9;
  std::string avif;
  bool key_frame = false;  // of video
  int width_px = 0;
  int height_px = 0;
  int full_width_px = 0;  // of the scene's picture at rest; 0: the same
  scene::Camera camera;
  scene::View view;
  scene::Sun sun;
  std::vector<StageTime> stages;
  Modelled modelled;
  bool refined = false;
  bool at_rest = false;  // drawn when the scene had not changed for a while
  int tier = 0;
  std::optional<Refinement> refinement;  // of a picture by the reference
  std::optional<AccuracyReport> accuracy;
  // The time of the change of the scene that it shows; none if the scene has changed again since.
  std::optional<std::chrono::steady_clock::time_point> changed_at;
  // The reservation of its pixels' and bytes' memory, held while a frame made of the picture is
  // kept or waits to be sent.
  std::shared_ptr<const base::MemoryReservation> memory;
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

// The problem of a scene that could not be drawn, counted among the refusals.
Problem ProblemOf(std::uint64_t scene_revision, const absl::Status& why);
// The problem of a scene whose storm could not be read, counted among the refusals.
Problem UnreadableStorm(std::uint64_t scene_revision, const absl::Status& why);

}  // namespace thunderhead::delivery

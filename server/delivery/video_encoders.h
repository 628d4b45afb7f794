// The encoders of a session's streams of video, one a tier, which live while somebody watches.
// Safe from any thread; pictures come one after another.
#pragma once

#include <array>
#include <memory>
#include <mutex>
#include <vector>

#include "absl/status/statusor.h"
#include "base/memory_budget.h"
#include "codec/vp9.h"
#include "delivery/link_estimate.h"
#include "delivery/video_order.h"

namespace thunderhead::delivery {

class VideoEncoders {
 public:
  // Encodes the picture, whose size is that of the order's tier. It becomes a key picture, and the
  // order says so, where another was asked for but its size is new. RESOURCE_EXHAUSTED if `memory`
  // has no room for an encoder.
  absl::StatusOr<codec::Vp9Picture> Encode(const frame::RgbImage& picture, VideoOrder* order,
                                           base::MemoryBudget& memory);

  // Frees the encoders; the next pictures are key pictures.
  void Release();

 private:
  std::mutex mutex_;
  struct Encoder {
    base::MemoryReservation memory;
    std::unique_ptr<codec::Vp9Encoder> vp9;
  };
  std::array<Encoder, kTiers> encoders_;
};

}  // namespace thunderhead::delivery

// The encoders of a session's video streams, one per tier (link_estimate.h). They exist only while
// there are viewers. Safe from any thread; pictures are encoded one after another.
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
  // Encodes a picture, which must have the size of the order's tier. If that size is new to the
  // encoder, the picture becomes a key picture whatever was ordered, and `order` is updated.
  // Returns RESOURCE_EXHAUSTED if `memory` has too little memory left for an encoder, or the
  // encoder's error.
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

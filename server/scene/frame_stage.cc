#include "scene/frame_stage.h"

#include "base/status.h"

namespace thunderhead::scene {

std::string_view NameOf(FrameStage stage) {
  switch (stage) {
    case FrameStage::kRead:
      return "read";
    case FrameStage::kExtinction:
      return "extinction";
    case FrameStage::kUpload:
      return "upload";
    case FrameStage::kFit:
      return "fit";
    case FrameStage::kSurface:
      return "surface";
    case FrameStage::kSlices:
      return "slices";
    case FrameStage::kLight:
      return "light";
    case FrameStage::kView:
      return "view";
    case FrameStage::kGround:
      return "ground";
    case FrameStage::kAir:
      return "air";
    case FrameStage::kComposite:
      return "composite";
    case FrameStage::kTrace:
      return "trace";
    case FrameStage::kCorrection:
      return "correction";
    case FrameStage::kTone:
      return "tone";
    case FrameStage::kReadBack:
      return "read_back";
    case FrameStage::kEncode:
      return "encode";
  }
  THUNDERHEAD_CHECK(false, "no such stage");
}

}  // namespace thunderhead::scene

// The stages whose wall time a frame reports, finer than those that a change dirties, and the
// properties of a scene that a frame reports as left out.
#pragma once

#include <string>
#include <string_view>

namespace thunderhead::scene {

enum class FrameStage {
  kRead,
  kExtinction,
  kUpload,
  kFit,      // of metaballs
  kSurface,  // of a cumulus
  kSlices,   // of half-angle slicing: light and view together
  kLight,
  kView,
  kGround,
  kAir,
  kComposite,
  kTrace,       // paths of the reference
  kCorrection,  // by traced paths
  kTone,
  kReadBack,
  kEncode,
};

// "read", "read_back" and so on, for tables.
std::string_view NameOf(FrameStage stage);

struct StageTime {
  FrameStage stage = FrameStage::kRead;
  double milliseconds = 0.0;  // wall time
};

// A property of the scene or the storm that a technique leaves out.
struct NotShown {
  enum class Code {
    kFineStructure,  // finer than metaballs
    kDetail,
    kFieldOptics,
    kTracedLight,
    kLights,   // besides the sun
    kFields,   // some of the storm's
    kStorm,    // the surface is made from a seed
    kBorders,  // and coasts
    kOther,
  } code = Code::kOther;
  std::string message;  // a few words for people

  bool operator==(const NotShown&) const = default;
};

}  // namespace thunderhead::scene

// The stages whose wall times a frame reports, which are finer than scene::Stage. This header also
// lists the properties of a scene or storm that a frame can report as not shown.
#pragma once

#include <string>
#include <string_view>

namespace thunderhead::scene {

enum class FrameStage {
  kRead,
  kExtinction,
  kUpload,
  kFit,      // fits metaballs
  kSurface,  // builds the surface of a cumulus
  kSlices,   // half-angle slicing, which computes light and view together
  kLight,
  kView,
  kGround,
  kAir,
  kComposite,
  kTrace,       // traces the paths of the path-traced reference
  kCorrection,  // corrects the light by path tracing
  kTone,
  kReadBack,
  kEncode,
};

// Returns the name of a stage for tables, such as "read" or "read_back".
std::string_view NameOf(FrameStage stage);

struct StageTime {
  FrameStage stage = FrameStage::kRead;
  double milliseconds = 0.0;  // wall time in milliseconds
};

// A property of the scene or the storm that a technique does not show.
struct NotShown {
  enum class Code {
    kFineStructure,  // structure finer than metaballs
    kDetail,
    kFieldOptics,
    kTracedLight,
    kLights,   // lights other than the sun
    kFields,   // some of the storm's fields
    kStorm,    // the storm, because the surface is generated from a seed
    kBorders,  // borders and coasts
    kOther,
  } code = Code::kOther;
  std::string message;  // description in a few words for people

  bool operator==(const NotShown&) const = default;
};

}  // namespace thunderhead::scene

// What a picture tells of itself, inside the file.
#pragma once

#include "frame/png_text.h"
#include "thunderhead/v1/thunderhead.pb.h"
#include "volume/storm_store.h"

namespace thunderhead::service {

// The keyword of the whole scene, as JSON, from which the same picture can be drawn again.
inline constexpr char kSceneText[] = "thunderhead.scene";

// The scene, the storm with its time, the program's version and the estimated error of a picture of
// `storm`, whose response is complete but for the picture.
frame::PngTexts TextsOf(const v1::RenderImageResponse& picture, const volume::StormInfo& storm);

}  // namespace thunderhead::service

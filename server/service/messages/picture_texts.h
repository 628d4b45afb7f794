// The description of a picture inside its file: as texts of a PNG or attributes of an OpenEXR
// file, by the same names.
#pragma once

#include <map>
#include <string>

#include "storm_store/storm_store.h"
#include "thunderhead/v1/thunderhead.pb.h"

namespace thunderhead::service {

// The keyword of the whole scene, as JSON, from which the same picture can be drawn again.
inline constexpr char kSceneText[] = "thunderhead.scene";

// Of the storm: its valid time and, where its files tell, when the run began (ISO 8601, UTC); where
// it has one, its map projection as PROJ writes it, and the latitude and longitude of the middle of
// its domain.
inline constexpr char kValidText[] = "thunderhead.valid";
inline constexpr char kRunText[] = "thunderhead.run";
inline constexpr char kProjectionText[] = "thunderhead.projection";
inline constexpr char kMiddleText[] = "thunderhead.middle_deg";

// The places of the picture's pixels in the world: a View as JSON.
inline constexpr char kViewText[] = "thunderhead.view";

// The estimated error; in an OpenEXR file a number. Where it was measured, also the ends of its 95
// % interval, in a PNG alone.
inline constexpr char kErrorText[] = "thunderhead.estimated_error";
inline constexpr char kErrorLowText[] = "thunderhead.error_low";
inline constexpr char kErrorHighText[] = "thunderhead.error_high";

using PictureTexts = std::map<std::string, std::string>;

// The scene, the storm with its time and map projection, the camera's pose, the program's version
// and where it is known the estimated error of a picture of `storm`, whose response is complete but
// for the picture.
PictureTexts TextsOf(const v1::RenderImageResponse& picture, const storm_store::StormInfo& storm);

}  // namespace thunderhead::service

// The description of a picture inside its file. It is stored as texts of a PNG file or as
// attributes of an OpenEXR file, under the same names.
#pragma once

#include <map>
#include <string>

#include "storm_store/storm_store.h"
#include "thunderhead/v1/thunderhead.pb.h"

namespace thunderhead::service {

// The keyword of the scene as JSON, from which the same picture can be drawn again.
inline constexpr char kSceneText[] = "thunderhead.scene";

// The keywords of facts about the storm: its valid time and the start of the run (ISO 8601, UTC),
// and its map projection in PROJ's notation. The last two keywords are for the latitude and
// longitude of the middle of its domain, and for the direction of true north there. That direction
// is in degrees clockwise from the grid's north. A fact that the storm does not have is omitted.
inline constexpr char kValidText[] = "thunderhead.valid";
inline constexpr char kRunText[] = "thunderhead.run";
inline constexpr char kProjectionText[] = "thunderhead.projection";
inline constexpr char kMiddleText[] = "thunderhead.middle_deg";
inline constexpr char kTrueNorthText[] = "thunderhead.true_north_deg";

// The keyword of the View as JSON: the mapping from the picture's pixels to the world.
inline constexpr char kViewText[] = "thunderhead.view";

// The keywords of the estimated error, which is stored as a number in an OpenEXR file. If the error
// was measured, a PNG file also has the two ends of its 95 % confidence interval.
inline constexpr char kErrorText[] = "thunderhead.estimated_error";
inline constexpr char kErrorLowText[] = "thunderhead.error_low";
inline constexpr char kErrorHighText[] = "thunderhead.error_high";

using PictureTexts = std::map<std::string, std::string>;

// Returns the description of a picture of `storm`: its scene, its storm with time and map
// projection, the camera's pose, the program's version and, if known, the estimated error. The
// response must be complete except for the picture itself.
PictureTexts TextsOf(const v1::RenderImageResponse& picture, const storm_store::StormInfo& storm);

}  // namespace thunderhead::service

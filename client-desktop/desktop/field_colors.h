// Converts the fields' false colours between the screen's encoding (sRGB) and the scene's (linear),
// and says whether the picture shows false colours.
#pragma once

#include <array>

#include "thunderhead/v1/scene.pb.h"
#include "thunderhead/v1/thunderhead.pb.h"

namespace thunderhead::desktop {

// Red, green and blue in sRGB encoding (IEC 61966-2-1), 0 to 1.
using ScreenColor = std::array<float, 3>;

ScreenColor ScreenColorOf(const v1::Color& linear);
v1::Color LinearColorOf(const ScreenColor& color);

// Returns true if the scene's technique can show false colours and the scene requests them.
bool DrawsFalseColors(const v1::Scene& scene, const v1::GetServerInfoResponse& server);

}  // namespace thunderhead::desktop

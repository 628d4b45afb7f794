// The fields' false colours: as the screen and the scene have them, and whether the picture shows
// them.
#pragma once

#include <array>

#include "thunderhead/v1/scene.pb.h"
#include "thunderhead/v1/thunderhead.pb.h"

namespace thunderhead::desktop {

// Red, green and blue encoded as sRGB (IEC 61966-2-1), 0 to 1.
using ScreenColor = std::array<float, 3>;

ScreenColor ScreenColorOf(const v1::Color& linear);
v1::Color LinearColorOf(const ScreenColor& color);

// True if the scene's technique shows false colours and the scene asks for them.
bool DrawsFalseColors(const v1::Scene& scene, const v1::GetServerInfoResponse& server);

}  // namespace thunderhead::desktop

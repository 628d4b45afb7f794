// The legend of an annotated picture.
#pragma once

#include <vector>

#include "product/annotation.h"
#include "thunderhead/v1/thunderhead.pb.h"

namespace thunderhead::runs {

// Returns the fields that the picture shows, each with its false colour, in the order of the scene.
// Returns nothing if the colours do not distinguish the fields, because the settings of the
// picture's technique have no field `false_colors`, or it is not set.
std::vector<product::LegendEntry> LegendOf(const v1::RenderImageResponse& picture);

}  // namespace thunderhead::runs

// The techniques that can draw a scene, each with its own settings (scene/techniques/), and queries
// that work for every technique.
#pragma once

#include <optional>
#include <string_view>
#include <variant>

#include "scene/techniques/cumulus.h"
#include "scene/techniques/half_angle.h"
#include "scene/techniques/light_volume.h"
#include "scene/techniques/metaballs.h"
#include "scene/techniques/other.h"
#include "scene/techniques/reference.h"

namespace thunderhead::scene {

using Technique =
    std::variant<LightVolume, HalfAngle, Metaballs, Cumulus, Reference, OtherTechnique>;

// Returns the technique's name in messages, tables and flags, such as "light_volume".
std::string_view NameOf(const Technique& technique);

const Capabilities& CapabilitiesOf(const Technique& technique);

// Returns the technique's medium settings, or null if the technique has none.
const MediumSettings* MediumSettingsOf(const Technique& technique);
MediumSettings* MediumSettingsOf(Technique* technique);
// Returns the technique's medium settings, or default settings if it has none. A technique added as
// an extension has none but may still draw a medium.
MediumSettings MediumSettingsOrDefault(const Technique& technique);

// Returns which of the fields' own properties the technique shows.
FieldLook FieldLookOf(const Technique& technique);

// Returns true if the technique is path-traced progressively, without a renderer.
bool IsTraced(const Technique& technique);

// Returns the number of slices or ray samples that determines the technique's picture, or nothing
// if the technique has no such number.
std::optional<int> SlicesOf(const Technique& technique);
void SetSlices(Technique* technique, int slices);

// Returns the number that makes the technique converge as it grows: slices, samples or metaballs.
// Returns 1 if the technique has no such number.
int CountOf(const Technique& technique);
void SetCount(Technique* technique, int count);

// Returns the number of slices, balls or ellipsoids that cover a pixel if only `slice_share` of the
// slices are drawn (above 0, at most 1). The cost of a picture is proportional to this number times
// the number of pixels.
double SamplesPerPixel(const Technique& technique, double slice_share);

// Returns when path tracing corrects the technique's light.
TracedLight TracedLightOf(const Technique& technique);
// Sets when path tracing corrects the light. The call has no effect on techniques that cannot be
// corrected.
void SetTracedLight(Technique* technique, TracedLight traced_light);

// Returns the first stage that must rerun when `before` becomes `after`.
Stage FirstDirtyStage(const Technique& before, const Technique& after);

}  // namespace thunderhead::scene

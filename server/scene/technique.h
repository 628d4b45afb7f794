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

// Returns null for techniques that do not draw a medium with these settings.
const MediumSettings* MediumSettingsOf(const Technique& technique);
MediumSettings* MediumSettingsOf(Technique* technique);
// Returns default settings for techniques that have none. A technique added as an extension may
// still draw a medium.
MediumSettings MediumSettingsOrDefault(const Technique& technique);

// Returns which of the fields' own properties the technique shows.
FieldLook FieldLookOf(const Technique& technique);

// Returns true if the technique is path-traced progressively instead of being drawn by a renderer.
bool IsTraced(const Technique& technique);

// Returns the number of slices or samples that the technique's pictures depend on, if they depend
// on one.
std::optional<int> SlicesOf(const Technique& technique);
void SetSlices(Technique* technique, int slices);

// Returns the number with which the technique converges: slices, samples or metaballs. Returns 1 if
// there is none.
int CountOf(const Technique& technique);
void SetCount(Technique* technique, int count);

// Returns the number of slices, balls or ellipsoids that cover a pixel, by which the cost grows
// with the pixels.
double SamplesPerPixel(const Technique& technique, double slice_share);

// Returns when path tracing corrects the technique's light.
TracedLight TracedLightOf(const Technique& technique);
// Sets when path tracing corrects the light. It has no effect on techniques without that
// correction.
void SetTracedLight(Technique* technique, TracedLight traced_light);

// Returns the first stage that must rerun when `before` becomes `after`.
Stage FirstDirtyStage(const Technique& before, const Technique& after);

}  // namespace thunderhead::scene

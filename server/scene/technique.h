// The techniques that can draw a scene, each with its own settings (scene/techniques/), and what
// code that serves all of them asks of any.
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

// Its name in messages, tables and flags, such as "light_volume".
std::string_view NameOf(const Technique& technique);

const Capabilities& CapabilitiesOf(const Technique& technique);

// None for techniques that do not draw a medium by these settings.
const MediumSettings* MediumSettingsOf(const Technique& technique);
MediumSettings* MediumSettingsOf(Technique* technique);
// Default ones for techniques without; one that the program was extended by may draw a medium.
MediumSettings MediumSettingsOrDefault(const Technique& technique);

// Which of the fields' own properties it shows.
FieldLook FieldLookOf(const Technique& technique);

// True if it is traced beside the renderers, ever finer, in place of being drawn by one.
bool IsTraced(const Technique& technique);

// The number of slices or samples that its pictures depend on, if they do.
std::optional<int> SlicesOf(const Technique& technique);
void SetSlices(Technique* technique, int slices);

// The number that its pictures converge with: slices, samples or metaballs; 1 if there is none.
int CountOf(const Technique& technique);
void SetCount(Technique* technique, int count);

// How the cost of a picture grows with its pixels: slices, balls or ellipsoids over each.
double SamplesPerPixel(const Technique& technique, double slice_share);

// When traced paths correct the light that it shows.
TracedLight TracedLightOf(const Technique& technique);
// Changes nothing where traced paths cannot correct it.
void SetTracedLight(Technique* technique, TracedLight traced_light);

// The first stage that must rerun when `before` becomes `after`.
Stage FirstDirtyStage(const Technique& before, const Technique& after);

}  // namespace thunderhead::scene

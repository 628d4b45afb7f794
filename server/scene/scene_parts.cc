#include "scene/scene_parts.h"

#include <algorithm>
#include <array>
#include <type_traits>
#include <variant>

namespace thunderhead::scene {
namespace {

template <auto member>
bool Same(const Scene& a, const Scene& b) {
  return a.*member == b.*member;
}

template <auto outer, auto inner>
bool SameIn(const Scene& a, const Scene& b) {
  return (a.*outer).*inner == (b.*outer).*inner;
}

bool SameFieldsButDetail(const Scene& a, const Scene& b) {
  return std::ranges::equal(a.fields, b.fields, [](FieldParameters of_a, const auto& of_b) {
    of_a.detail = of_b.detail;
    return of_a == of_b;
  });
}

bool SameDetail(const Scene& a, const Scene& b) {
  return std::ranges::equal(a.fields, b.fields, {}, &FieldParameters::detail,
                            &FieldParameters::detail);
}

TracedLight TracedLightSettingOf(const Technique& technique) {
  return std::visit(
      [](const auto& settings) {
        if constexpr (requires { settings.traced_light; }) {
          return settings.traced_light;
        } else {
          return TracedLight::kOff;
        }
      },
      technique);
}

bool SameTracedLight(const Scene& a, const Scene& b) {
  return TracedLightSettingOf(a.rendering.technique) == TracedLightSettingOf(b.rendering.technique);
}

bool SameDetailSwitch(const Scene& a, const Scene& b) {
  return FieldLookOf(a.rendering.technique).detail == FieldLookOf(b.rendering.technique).detail;
}

// Returns the technique with default values for the settings that have their own rows in kParts.
Technique WithoutOwnParts(Technique technique) {
  SetTracedLight(&technique, TracedLight::kOff);
  if (MediumSettings* medium = MediumSettingsOf(&technique); medium != nullptr) {
    medium->look.detail = false;
  }
  return technique;
}

bool SameTechnique(const Scene& a, const Scene& b) {
  return WithoutOwnParts(a.rendering.technique) == WithoutOwnParts(b.rendering.technique);
}

Stage DirtiedByTechnique(const Scene& before, const Scene& after) {
  return FirstDirtyStage(before.rendering.technique, after.rendering.technique);
}

// Returns a field's detail as the scene's technique shows it.
Detail DetailShown(const Scene& scene, const FieldParameters& field) {
  const Technique& technique = scene.rendering.technique;
  const bool roughens = CapabilitiesOf(technique).detail == DetailUse::kRoughness;
  return roughens || FieldLookOf(technique).detail ? field.detail : Detail{};
}

Stage DirtiedByDetail(const Scene& before, const Scene& after) {
  const bool same = std::ranges::equal(
      before.fields, after.fields, {},
      [&before](const FieldParameters& field) { return DetailShown(before, field); },
      [&after](const FieldParameters& field) { return DetailShown(after, field); });
  return same ? Stage::kNothing : Stage::kExtinction;
}

// Returns the first stage that a change of the additional lights dirties. The view stage multiplies
// the lights' colours with the light computed before. A technique that does not show the lights
// only reports them as not shown.
Stage DirtiedByLights(const Scene& before, const Scene& after) {
  if (before.lights == after.lights) return Stage::kNothing;
  if (!CapabilitiesOf(after.rendering.technique).lights) return Stage::kTone;
  const bool same_directions =
      std::equal(before.lights.begin(), before.lights.end(), after.lights.begin(),
                 after.lights.end(), [](const DirectionalLight& a, const DirectionalLight& b) {
                   return a.azimuth_deg == b.azimuth_deg && a.elevation_deg == b.elevation_deg;
                 });
  // Only for the built-in techniques is it known that they apply the colours in the view stage.
  const bool own = !std::holds_alternative<OtherTechnique>(after.rendering.technique);
  return same_directions && own ? Stage::kView : Stage::kLight;
}

// Returns the first stage that a change of the sky or of the ground's cover dirties. Diffusion uses
// the ground's light as a boundary condition. The storm's light therefore depends on the ground's
// albedo, and on the shares of sun and sky in the light on the ground.
Stage StageOfSurroundings(const Scene& after) {
  const MediumSettings* medium = MediumSettingsOf(after.rendering.technique);
  const bool diffuses = medium != nullptr && medium->transport == Transport::kDiffusion;
  return diffuses ? Stage::kLight : Stage::kView;
}

Stage DirtiedBySky(const Scene& before, const Scene& after) {
  return before.sky == after.sky ? Stage::kNothing : StageOfSurroundings(after);
}

Stage DirtiedByCover(const Scene& before, const Scene& after) {
  return before.ground.cover == after.ground.cover ? Stage::kNothing : StageOfSurroundings(after);
}

// The columns are the part, its comparison, and the first stage that a change of it can invalidate.
// The next two say whether the path-traced correction and the measured error depend on it. The last
// is the rule for the stage, if the stage depends on the technique.
constexpr std::array kParts = {
    ScenePart{"storm_id", Same<&Scene::storm_id>, Stage::kStorm, true, true},
    ScenePart{"time_index", Same<&Scene::time_index>, Stage::kStorm, true, true},
    ScenePart{"fields", SameFieldsButDetail, Stage::kExtinction, true, true},
    // The measured error depends on the detail, because metaballs show the detail as roughness even
    // in the measured picture.
    ScenePart{"fields.detail", SameDetail, Stage::kExtinction, true, true, DirtiedByDetail},
    ScenePart{"rendering.technique", SameTechnique, Stage::kExtinction, true, true,
              DirtiedByTechnique},
    ScenePart{"rendering.technique.detail", SameDetailSwitch, Stage::kExtinction, true, false,
              DirtiedByTechnique},
    ScenePart{"rendering.technique.traced_light", SameTracedLight, Stage::kView, false, false,
              DirtiedByTechnique},
    ScenePart{"rendering.image_scale", SameIn<&Scene::rendering, &Rendering::image_scale>,
              Stage::kLight, false, true},
    ScenePart{"sun", Same<&Scene::sun>, Stage::kLight, true, true},
    ScenePart{"lights", Same<&Scene::lights>, Stage::kLight, false, true, DirtiedByLights},
    ScenePart{"sky", Same<&Scene::sky>, Stage::kLight, true, true, DirtiedBySky},
    ScenePart{"ground.cover", SameIn<&Scene::ground, &Ground::cover>, Stage::kLight, true, true,
              DirtiedByCover},
    ScenePart{"ground.borders", SameIn<&Scene::ground, &Ground::borders>, Stage::kView, false,
              false},
    ScenePart{"ground.rings", SameIn<&Scene::ground, &Ground::rings>, Stage::kView, false, false},
    ScenePart{"camera", Same<&Scene::camera>, Stage::kView, false, true},
    ScenePart{"output.width_px", SameIn<&Scene::output, &Output::width_px>, Stage::kView, false,
              true},
    ScenePart{"output.height_px", SameIn<&Scene::output, &Output::height_px>, Stage::kView, false,
              true},
    ScenePart{"output.jpeg_quality", SameIn<&Scene::output, &Output::jpeg_quality>, Stage::kTone,
              false, false},
    ScenePart{"display", Same<&Scene::display>, Stage::kTone, false, false},
    // A change of the target accuracy invalidates nothing, because it takes effect through the
    // rendering that is chosen for it.
    ScenePart{"accuracy", Same<&Scene::accuracy>, Stage::kNothing, false, false},
};

Stage DirtiedBy(const ScenePart& part, const Scene& before, const Scene& after) {
  if (part.first_dirty != nullptr) return part.first_dirty(before, after);
  return part.same(before, after) ? Stage::kNothing : part.stage;
}

}  // namespace

std::span<const ScenePart> SceneParts() { return kParts; }

bool Agree(const Scene& a, const Scene& b, bool ScenePart::*property) {
  return std::ranges::all_of(
      kParts, [&](const ScenePart& part) { return !(part.*property) || part.same(a, b); });
}

Stage FirstDirtyStage(const Scene& before, const Scene& after) {
  Stage first = Stage::kNothing;
  for (const ScenePart& part : kParts) {
    first = std::min(first, DirtiedBy(part, before, after));
  }
  return first;
}

}  // namespace thunderhead::scene

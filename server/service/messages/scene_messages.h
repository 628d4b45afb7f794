// Converts scenes and storms between messages and values, and checks the rules that the limits of
// limits_check.h cannot express.
#pragma once

#include <optional>
#include <string>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "scene/scene.h"
#include "storm_store/storm_store.h"
#include "thunderhead/v1/thunderhead.pb.h"

namespace thunderhead::service {

// Returns INVALID_ARGUMENT if the scene breaks a rule that limits cannot express. The sun's date
// must be valid, and the number of pixels must be allowed. Each entry of `fields` must name a
// hydrometeor that no other entry names. `particle_sizes` must not be PARTICLE_SIZES_GIVEN.
absl::Status CheckScene(const v1::Scene& scene);

// Fills in the source of the particle sizes. It is PARTICLE_SIZES_PAPERS for a preset of the papers
// (IsOfThePapers), otherwise PARTICLE_SIZES_MODEL. Must be called before the technique's defaults
// are filled in, because these replace the preset.
void FillSizesDefault(v1::Scene& scene);

// Fills in every default except those that depend on the storm's fields.
void FillSceneDefaults(v1::Scene& scene, const storm_store::StormInfo& storm);

// Returns the source of the particle sizes. The scene's defaults must be filled in.
physics::SizeSource SizesOf(const v1::Scene& scene);

// Converts a scene whose defaults are filled in.
scene::Scene ToScene(const v1::Scene& message);

v1::Hydrometeor ToMessage(physics::Hydrometeor hydrometeor);
void ToMessage(const scene::Ground& ground, v1::Ground& message);
void ToMessage(const storm_store::StormInfo& storm, v1::StormSummary& message);
// Describes a storm at one time. Reads the current sizes and modification times of its files.
void ToMessage(const storm_store::StormInfo& storm, const volume::HydrometeorFields& fields,
               int time_index, v1::StormDescription& message);
// Describes the current state of the file at `path`. Returns false if there is no such file.
bool ToMessage(const std::string& path, v1::StormFile& message);

}  // namespace thunderhead::service

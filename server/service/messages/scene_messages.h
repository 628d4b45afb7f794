// Converts scenes and storms between messages and values. Limits are checked elsewhere
// (limits_check.h); here the rules are checked that limits of numbers cannot express.
#pragma once

#include <optional>
#include <string>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "scene/scene.h"
#include "storm_store/storm_store.h"
#include "thunderhead/v1/thunderhead.pb.h"

namespace thunderhead::service {

// Checks the rules that limits do not express: each hydrometeor at most once, a valid date of the
// sun, the number of pixels.
absl::Status CheckScene(const v1::Scene& scene);

// Fills in the source of the particles' sizes: a preset of the papers stands for their constants.
// Comes before the technique's defaults, which replace the preset.
void FillSizesDefault(v1::Scene& scene);

// Fills in every default except those that depend on the storm's fields.
void FillSceneDefaults(v1::Scene& scene, const storm_store::StormInfo& storm);

// Where the particles' sizes of a scene come from whose defaults are filled in.
physics::SizeSource SizesOf(const v1::Scene& scene);

// The value of a scene whose defaults are filled in.
scene::Scene ToScene(const v1::Scene& message);

v1::Hydrometeor ToMessage(physics::Hydrometeor hydrometeor);
void ToMessage(const scene::Ground& ground, v1::Ground& message);
void ToMessage(const storm_store::StormInfo& storm, v1::StormSummary& message);
// Looks at the files of its times.
void ToMessage(const storm_store::StormInfo& storm, const volume::HydrometeorFields& fields,
               int time_index, v1::StormDescription& message);
// The file at `path`, as it is now; false if there is none.
bool ToMessage(const std::string& path, v1::StormFile& message);

}  // namespace thunderhead::service

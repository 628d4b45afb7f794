// The tables of docs/accuracy, one for each kind of camera. They contain the drawing time and the
// error of each setting. These functions find the row for a scene.
#pragma once

#include <array>
#include <string_view>
#include <variant>

#include "absl/status/statusor.h"
#include "accuracy/priced_settings.h"
#include "accuracy/setting.h"
#include "scene/scene.h"

namespace thunderhead::accuracy {

// A table for each kind of camera, in the order of scene::Camera, or an error that says why the
// table is missing.
using OfferTables = std::array<absl::StatusOr<PricedSettings>, std::variant_size_v<scene::Camera>>;

// Returns the tables that are built into the program.
OfferTables BuiltInOfferTables();

// Returns the table for the scene's kind of camera.
const absl::StatusOr<PricedSettings>& TableFor(const OfferTables& tables,
                                               const scene::Scene& scene);

// Returns "orbit", "spotter" or "top-down".
std::string_view ViewNameOf(const scene::Camera& camera);

// Returns the row that is most similar to `setting` among the rows with the same technique and
// light model, or null if there is none. Rows with more paths than `setting` are ignored. For a
// setting with the path-traced correction, it prefers rows that have it too.
const PricedSetting* NearestRow(const PricedSettings& table, const Setting& setting);

// Returns the row's time in ms, scaled to the size of the scene's picture. It is scaled by the
// number of pixels, because nearly all of the time is proportional to it.
double TableMs(const PricedSettings& table, const PricedSetting& row, const scene::Scene& scene);

}  // namespace thunderhead::accuracy

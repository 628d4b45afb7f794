// The tables of docs/accuracy by kind of camera. They hold the cost and error of each setting;
// these functions select a scene's row. Plain values.
#pragma once

#include <array>
#include <string_view>
#include <variant>

#include "absl/status/statusor.h"
#include "accuracy/priced_settings.h"
#include "accuracy/setting.h"
#include "scene/scene.h"

namespace thunderhead::accuracy {

// A table for each kind of camera, in the order of scene::Camera, or the reason why it is missing.
using OfferTables = std::array<absl::StatusOr<PricedSettings>, std::variant_size_v<scene::Camera>>;

// Returns the tables that are built into the program.
OfferTables BuiltInOfferTables();

// Returns the table for the scene's kind of camera.
const absl::StatusOr<PricedSettings>& TableFor(const OfferTables& tables,
                                               const scene::Scene& scene);

// Returns "orbit", "spotter" or "top-down".
std::string_view ViewNameOf(const scene::Camera& camera);

// Returns the row with the same technique and model that is most similar to `setting`, if any. For
// traced light, it prefers rows with traced light and at most as many paths.
const PricedSetting* NearestRow(const PricedSettings& table, const Setting& setting);

// Returns the row's time for a picture of the scene's size. Nearly all of the time grows with the
// number of pixels.
double TableMs(const PricedSettings& table, const PricedSetting& row, const scene::Scene& scene);

}  // namespace thunderhead::accuracy

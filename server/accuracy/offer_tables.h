// The tables of docs/accuracy by kind of camera: what each setting costs and misses, and which of
// their rows a scene is judged by. Plain values.
#pragma once

#include <array>
#include <string_view>
#include <variant>

#include "absl/status/statusor.h"
#include "accuracy/priced_settings.h"
#include "accuracy/setting.h"
#include "scene/scene.h"

namespace thunderhead::accuracy {

// A table for each kind of camera, in the order of scene::Camera; why there is none otherwise.
using OfferTables = std::array<absl::StatusOr<PricedSettings>, std::variant_size_v<scene::Camera>>;

// The tables that the program is built with.
OfferTables BuiltInOfferTables();

// The table of the scene's kind of camera.
const absl::StatusOr<PricedSettings>& TableFor(const OfferTables& tables,
                                               const scene::Scene& scene);

// "orbit", "spotter" or "top-down".
std::string_view ViewNameOf(const scene::Camera& camera);

// The row of the same technique and model that is most like `setting`, if any: where its light is
// traced, of the rows with traced light and no more paths, if there are such.
const PricedSetting* NearestRow(const PricedSettings& table, const Setting& setting);

// The row's time for a picture of the scene's size: what grows with the pixels is nearly all.
double TableMs(const PricedSettings& table, const PricedSetting& row, const scene::Scene& scene);

}  // namespace thunderhead::accuracy

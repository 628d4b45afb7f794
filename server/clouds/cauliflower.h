// Surfaces of cumulus made from a seed: a heap of bubbles with smaller bubbles on them, the
// ellipsoids of a generator's preset with bubbles on them, or a single ellipsoid. The same bits on
// every machine.
#pragma once

#include <cstdint>
#include <string_view>

#include "absl/status/statusor.h"
#include "clouds/cumulus_surface.h"

namespace thunderhead::clouds {

struct CauliflowerOptions {
  std::uint64_t seed = 1;
  int scales = 4;  // levels of ellipsoids, including the largest
};

inline constexpr int kMaxScales = 5;

// About 2.4 km wide on a flat base at sea level. INVALID_ARGUMENT unless scales is 1 to
// kMaxScales.
absl::StatusOr<CumulusSurface> Cauliflower(const CauliflowerOptions& options);

// The ellipsoids of a preset (clouds/presets.h) with bubbles on them if `scales` is 2 or more.
absl::StatusOr<CumulusSurface> SurfaceOfPreset(std::string_view preset,
                                               const CauliflowerOptions& options);

// One ellipsoid, as in the paper's figure 6, with bubbles on it if `scales` is 2 or more.
absl::StatusOr<CumulusSurface> LoneEllipsoid(const CauliflowerOptions& options);

}  // namespace thunderhead::clouds

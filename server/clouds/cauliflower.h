// Surfaces of cumulus made from a seed: a heap of heaps of bubbles, the ellipsoids of a preset of
// the generator with bubbles on them, or one ellipsoid. The same on every machine.
#pragma once

#include <cstdint>
#include <string_view>

#include "absl/status/statusor.h"
#include "clouds/cumulus_surface.h"

namespace thunderhead::clouds {

struct CauliflowerOptions {
  std::uint64_t seed = 1;
  int scales = 4;  // of ellipsoids, the largest counted
};

inline constexpr int kMostScales = 5;

// About 2.4 km wide on a flat base at sea level. INVALID_ARGUMENT unless scales is 1 to
// kMostScales.
absl::StatusOr<CumulusSurface> Cauliflower(const CauliflowerOptions& options);

// The ellipsoids of a preset (clouds/presets.h) and, from `scales` 2 on, bubbles upon them.
absl::StatusOr<CumulusSurface> SurfaceOfPreset(std::string_view preset,
                                               const CauliflowerOptions& options);

// One ellipsoid, as in the paper's figure 6, and from `scales` 2 on bubbles upon it.
absl::StatusOr<CumulusSurface> LoneEllipsoid(const CauliflowerOptions& options);

}  // namespace thunderhead::clouds

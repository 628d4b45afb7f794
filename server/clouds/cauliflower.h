// Makes surfaces of cumulus clouds from a seed. There are three kinds: a heap of bubbles, the
// ellipsoids of a cloud preset, or a single ellipsoid, each with smaller bubbles on top. The result
// has the same bits on every machine.
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

// Makes a surface about 2.4 km wide on a flat base at sea level. All three functions return
// INVALID_ARGUMENT unless `scales` is 1 to kMaxScales.
absl::StatusOr<CumulusSurface> Cauliflower(const CauliflowerOptions& options);

// Makes the ellipsoids of a preset (clouds/presets.h), with bubbles on them if `scales` is 2 or
// more. Also returns INVALID_ARGUMENT if there is no such preset.
absl::StatusOr<CumulusSurface> SurfaceOfPreset(std::string_view preset,
                                               const CauliflowerOptions& options);

// Makes one ellipsoid, as in figure 6 of Neyret's paper (clouds/cumulus_surface.h), with bubbles on
// it if `scales` is 2 or more.
absl::StatusOr<CumulusSurface> LoneEllipsoid(const CauliflowerOptions& options);

}  // namespace thunderhead::clouds

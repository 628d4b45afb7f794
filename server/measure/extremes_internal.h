// What the files of extremes share.
#pragma once

#include <string>
#include <vector>

#include "measure/extremes.h"
#include "accuracy/named_settings.h"

namespace thunderhead::measure::internal {

// A ray may end where less than this of the background shows (light_volume/march.frag,
// metaball/splat.frag).
inline constexpr double kOpaque = 0.005;

// Passes if `got` is within `tolerance` of `expected`.
Verdict Near(double got, double expected, double tolerance);

// Passes if `got` is at most `most`.
Verdict AtMost(double got, double most);

// `verdict`, failed if what was seen is not sound.
Verdict Sound(const Seen& seen, Verdict verdict);

// A scene of cloud water by one path: single scattering (low albedo, consistent) of a phase
// function that is the same in all directions.
scene::Scene PlainScene(const accuracy::Path& path);

void AppendInputExtremes(std::vector<Extreme>* extremes);
void AppendDepthExtremes(const accuracy::Path& path, std::vector<Extreme>* extremes);
void AppendShapeExtremes(const accuracy::Path& path, std::vector<Extreme>* extremes);
void AppendViewExtremes(const accuracy::Path& path, std::vector<Extreme>* extremes);
void AppendMetaballExtremes(std::vector<Extreme>* extremes);

}  // namespace thunderhead::measure::internal

// What the files of extremes share.
#pragma once

#include <string>
#include <vector>

#include "accuracy/named_settings.h"
#include "measure/extremes.h"

namespace thunderhead::measure::internal {

// A ray may end where less than this of the background shows (light_volume/march.frag,
// metaball/splat.frag).
inline constexpr double kOpaque = 0.005;

// Passes if `got` is within `tolerance` of `expected`. `without` is what a picture without the
// medium shows: a tolerance that takes it in fails, as such a case could not.
Verdict Near(double got, double expected, double tolerance, double without);

// How far off a ray's optical depth may be, as a share of it.
struct DepthErrors {
  double half_angle;
  double light_volume;
};

// Where a ray crosses the box's faces upright. Extinction is stored in half floats (2^-12). A
// camera 0.1 degrees off the zenith tilts slices by as much: they extend 0.4 % beyond the box.
inline constexpr DepthErrors kUpright = {.half_angle = 0.005, .light_volume = 0.0005};

// Where it crosses them aslant. Half-angle slices count whole or not at all: off by up to two of
// 128, over a box that fills a third of what is sliced. The light volume's rays end where the box
// does, whatever their direction.
inline constexpr DepthErrors kSlanted = {.half_angle = 0.05, .light_volume = 0.0005};

// The transmittance of `seen`, drawn by `path` with `slices`, is that of `depth`.
Verdict TransmittanceNear(const accuracy::Path& path, const Seen& seen, double depth,
                          const DepthErrors& errors, int slices, bool single_precision = false);

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

// Declarations shared by the source files with cases of extreme input.
#pragma once

#include <string>
#include <vector>

#include "accuracy/named_settings.h"
#include "measure/extremes.h"

namespace thunderhead::measure::internal {

// Passes if `got` is within `tolerance` of `expected`. `without` is the value for a picture without
// the medium. If `without` would pass too, the case fails because it would test nothing.
Verdict Near(double got, double expected, double tolerance, double without);

// Relative tolerances of a ray's optical depth, by technique.
struct DepthErrors {
  double half_angle;
  double light_volume;
};

// Tolerances for a vertical ray. Extinction is stored in half floats (rounding error 2^-12). A
// camera 0.1 degrees off the zenith tilts slices by the same angle, so that the slices extend 0.4 %
// beyond the box.
inline constexpr DepthErrors kUpright = {.half_angle = 0.005, .light_volume = 0.0005};

// Tolerances for a slanted ray. A half-angle slice counts completely or not at all. This causes an
// error of up to two of 128 slices, over a box that fills a third of the sliced depth. The light
// volume's rays end exactly at the box's faces in all directions.
inline constexpr DepthErrors kSlanted = {.half_angle = 0.05, .light_volume = 0.0005};

// Passes if the transmittance of `seen` is that of the optical depth `depth`. `seen` was drawn by
// technique `plain` with `slices` slices.
Verdict TransmittanceNear(const accuracy::PlainTechnique& plain, const Seen& seen, double depth,
                          const DepthErrors& errors, int slices, bool single_precision = false);

// Passes if `got` is at most `bound`.
Verdict AtMost(double got, double bound);

// Returns `verdict`, changed to failed if `seen` contains an invalid value.
Verdict Sound(const Seen& seen, Verdict verdict);

// Returns a scene of cloud water drawn by technique `plain`. It uses single scattering (mode of low
// albedo, consistent transport) and an isotropic phase function.
scene::Scene PlainScene(const accuracy::PlainTechnique& plain);

void AppendInputExtremes(std::vector<Extreme>* extremes);
void AppendDepthExtremes(const accuracy::PlainTechnique& plain, std::vector<Extreme>* extremes);
void AppendShapeExtremes(const accuracy::PlainTechnique& plain, std::vector<Extreme>* extremes);
void AppendViewExtremes(const accuracy::PlainTechnique& plain, std::vector<Extreme>* extremes);
void AppendMetaballExtremes(std::vector<Extreme>* extremes);

}  // namespace thunderhead::measure::internal

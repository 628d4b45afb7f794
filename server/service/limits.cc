#include "service/limits.h"

#include <string>

#include "absl/strings/str_cat.h"
#include "base/error_details.h"

namespace thunderhead::service {
namespace {

// Who waits for a viewer to leave, or for a machine with less to do.
constexpr std::chrono::seconds kViewerRetry{30};
constexpr std::chrono::seconds kRenderRetry{60};
// What is too large stays so until somebody sets another limit.
constexpr std::chrono::minutes kSizeRetry{60};

// Those of the techniques that have slices; 1 for the others.
std::uint64_t SlicesOf(const v1::Rendering& rendering) {
  if (rendering.has_light_volume()) return rendering.light_volume().slices();
  if (rendering.has_half_angle()) return rendering.half_angle().slices();
  return 1;
}

absl::Status TooLarge(const std::string& what, std::uint64_t number, std::uint64_t maximum,
                      const char* unit, const char* reason) {
  return base::WithDetails(absl::ResourceExhaustedError(absl::StrCat(
                               what, " is ", number, " ", unit, "; this server allows ", maximum)),
                           {.reason = reason,
                            .field = "scene.output",
                            .metadata = {{"maximum", absl::StrCat(maximum)}, {"unit", unit}},
                            .retry_after = kSizeRetry});
}

}  // namespace

absl::Status CheckSize(const Limits& limits, const v1::Scene& scene) {
  const std::uint64_t pixels =
      std::uint64_t{scene.output().width_px()} * scene.output().height_px();
  if (pixels > limits.max_pixels) {
    return TooLarge("scene.output.width_px times scene.output.height_px", pixels, limits.max_pixels,
                    "pixels", "PICTURE_TOO_LARGE");
  }
  const std::uint64_t samples = pixels * SlicesOf(scene.rendering());
  if (samples > limits.max_samples) {
    return TooLarge("the picture's pixels times its slices", samples, limits.max_samples, "samples",
                    "TOO_MANY_SAMPLES");
  }
  return absl::OkStatus();
}

absl::Status TooManyViewers(std::size_t maximum) {
  return base::WithDetails(
      absl::ResourceExhaustedError(absl::StrCat("the session already has the maximum of ", maximum,
                                                " viewers; try again when somebody has left")),
      {.reason = "TOO_MANY_VIEWERS",
       .metadata = {{"maximum", absl::StrCat(maximum)}, {"unit", "viewers"}},
       .retry_after = kViewerRetry});
}

absl::Status RenderedTooLong(std::chrono::milliseconds limit) {
  return base::WithDetails(absl::ResourceExhaustedError(absl::StrCat(
                               "the picture was not ready after the ", limit.count(),
                               " ms that this server gives one; ask for a smaller one")),
                           {.reason = "RENDER_TIME_EXCEEDED",
                            .metadata = {{"maximum", absl::StrCat(limit.count())}, {"unit", "ms"}},
                            .retry_after = kRenderRetry});
}

}  // namespace thunderhead::service

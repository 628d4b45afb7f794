#include "service/engine/limits.h"

#include <string>

#include "absl/strings/str_cat.h"
#include "base/error_details.h"
#include "scene/technique.h"
#include "service/messages/technique_messages.h"

namespace thunderhead::service {
namespace {

// Retry delays for a full session, and for a picture that this machine draws too slowly.
constexpr std::chrono::seconds kViewerRetry{30};
constexpr std::chrono::seconds kRenderRetry{60};
// Retry delay for requests that are too large. Only an operator can raise the limit.
constexpr std::chrono::minutes kSizeRetry{60};

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
  const int slices = scene::SlicesOf(ToTechnique(scene.rendering())).value_or(1);
  const std::uint64_t samples = pixels * static_cast<std::uint64_t>(slices);
  if (samples > limits.max_samples) {
    return TooLarge("the picture's pixels times its slices", samples, limits.max_samples, "samples",
                    "TOO_MANY_SAMPLES");
  }
  return absl::OkStatus();
}

absl::Status TooManyViewers(std::size_t maximum) {
  return base::WithDetails(
      absl::ResourceExhaustedError(absl::StrCat("the session already has the maximum of ", maximum,
                                                " viewers; try again when a viewer has left")),
      {.reason = "TOO_MANY_VIEWERS",
       .metadata = {{"maximum", absl::StrCat(maximum)}, {"unit", "viewers"}},
       .retry_after = kViewerRetry});
}

absl::Status RenderedTooLong(std::chrono::milliseconds limit) {
  return base::WithDetails(absl::ResourceExhaustedError(absl::StrCat(
                               "the picture was not ready after the ", limit.count(),
                               " ms that this server allows for one; request a smaller one")),
                           {.reason = "RENDER_TIME_EXCEEDED",
                            .metadata = {{"maximum", absl::StrCat(limit.count())}, {"unit", "ms"}},
                            .retry_after = kRenderRetry});
}

}  // namespace thunderhead::service

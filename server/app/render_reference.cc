#include "app/render_reference.h"

#include <algorithm>
#include <cmath>
#include <iostream>
#include <memory>
#include <optional>
#include <utility>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "app/interruption.h"
#include "app/local_scene.h"
#include "base/status.h"
#include "base/whole_file.h"
#include "frame/image_codec.h"
#include "frame/tone_map.h"
#include "gl/context.h"
#include "picture/exr_file.h"
#include "reference/trace_scene.h"
#include "runs/progress_bar.h"
#include "scene/optical_depths.h"

namespace thunderhead::app {
namespace {

absl::Status CheckAtLeast1(const char* flag, const std::optional<int>& value) {
  if (value.value_or(1) >= 1) return absl::OkStatus();
  return absl::InvalidArgumentError(absl::StrCat(flag, " is ", *value, "; it must be 1 or more"));
}

absl::Status CheckAbove0(const char* flag, const std::optional<double>& value) {
  if (value.value_or(1.0) > 0.0) return absl::OkStatus();
  return absl::InvalidArgumentError(absl::StrCat(flag, " is ", *value, "; it must be above 0"));
}

absl::Status CheckFlags(const ReferenceFlags& limits) {
  THUNDERHEAD_RETURN_IF_ERROR(CheckAtLeast1("--spp", limits.samples_per_pixel));
  THUNDERHEAD_RETURN_IF_ERROR(CheckAbove0("--seconds", limits.seconds));
  THUNDERHEAD_RETURN_IF_ERROR(CheckAbove0("--target-error", limits.target_error));
  THUNDERHEAD_RETURN_IF_ERROR(CheckAtLeast1("--max-scatterings", limits.max_scatterings));
  const double peak_cut_deg = limits.light.peak_cut_deg;
  if (!(peak_cut_deg >= 0.0 && peak_cut_deg <= 30.0)) {
    return absl::InvalidArgumentError(
        absl::StrCat("--peak-cut is ", peak_cut_deg, "; it must be from 0 to 30 degrees"));
  }
  return absl::OkStatus();
}

// Returns the limits at which the reference stops. In RefineLimits, 0 is no limit.
reference::RefineLimits RefineLimitsOf(const ReferenceFlags& flags) {
  return {flags.samples_per_pixel.value_or(flags.AnyLimit() ? 0 : kDefaultSamplesPerPixel),
          flags.seconds.value_or(0.0), flags.target_error.value_or(0.0)};
}

// Returns the progress towards the limit that will be reached first, 0 to 1. The error falls with
// the square root of the number of samples.
double ShareDone(const reference::RefineLimits& limits, const reference::ImageProgress& progress) {
  double share = 0.0;
  if (limits.samples_per_pixel > 0) {
    share = static_cast<double>(progress.samples_per_pixel) / limits.samples_per_pixel;
  }
  if (limits.seconds > 0.0) share = std::max(share, progress.seconds / limits.seconds);
  if (limits.relative_error > 0.0 && progress.relative_error > 0.0) {
    share = std::max(share, std::pow(limits.relative_error / progress.relative_error, 2.0));
  }
  return std::min(share, 1.0);
}

absl::Status WriteToneMapped(const picture::LinearPicture& image, const scene::Scene& scene,
                             const std::string& output, const std::string& device) {
  THUNDERHEAD_ASSIGN_OR_RETURN(const std::unique_ptr<gl::Context> context,
                               gl::Context::Create(device));
  frame::ToneMapper tone_mapper;
  THUNDERHEAD_ASSIGN_OR_RETURN(const frame::ToneMapped mapped,
                               tone_mapper.Map(frame::TextureOf(image), scene));
  const glm::ivec2 size = image.size_px;
  THUNDERHEAD_ASSIGN_OR_RETURN(
      const std::string bytes,
      absl::EndsWithIgnoreCase(output, ".png")
          ? frame::EncodePng(size.x, size.y, mapped.rgb)
          : frame::EncodeJpeg(size.x, size.y, mapped.rgb, scene.output.jpeg_quality));
  return base::WriteWholeFile(output, bytes);
}

}  // namespace

absl::Status RenderReference(const std::string& storm, const SceneFlags& scene,
                             const ReferenceFlags& limits, const std::string& output,
                             const std::string& device) {
  THUNDERHEAD_RETURN_IF_ERROR(CheckFlags(limits));
  SceneFlags flags = scene;
  flags.technique = scene::Reference::kName;
  flags.preset.clear();
  THUNDERHEAD_ASSIGN_OR_RETURN(const LocalScene local, OpenScene(storm, flags));
  const reference::RefineLimits refine = RefineLimitsOf(limits);
  reference::TraceOptions light = limits.light;
  light.max_scatterings = limits.max_scatterings.value_or(light.max_scatterings);
  const Interruption interruption;
  absl::StatusOr<reference::TracedScene> traced;
  {
    runs::ProgressBar bar("tracing");
    traced = reference::TraceScene(
        local.scene, *local.fields, light, refine,
        [&](const reference::ImageProgress& progress) { bar.Set(ShareDone(refine, progress)); },
        interruption.Token());
  }
  THUNDERHEAD_RETURN_IF_ERROR(traced.status());
  if (absl::EndsWithIgnoreCase(output, ".exr")) {
    scene::AddOpticalDepths(local.scene, *local.fields, &traced->image);
    THUNDERHEAD_RETURN_IF_ERROR(picture::WriteExr(output, traced->image));
  } else {
    THUNDERHEAD_RETURN_IF_ERROR(WriteToneMapped(traced->image, local.scene, output, device));
  }
  const reference::ImageProgress& last = traced->result.progress;
  std::cout << absl::StrFormat("%d samples a pixel, relative standard error %.4f, %.1f s\n",
                               last.samples_per_pixel, last.relative_error, last.seconds);
  return absl::OkStatus();
}

}  // namespace thunderhead::app

#include "app/kept_reference.h"

#include <filesystem>

#include "absl/strings/str_cat.h"
#include "base/own_file.h"
#include "base/status.h"
#include "base/whole_file.h"
#include "picture/exr_file.h"
#include "runs/progress_bar.h"

namespace thunderhead::app {

absl::StatusOr<picture::LinearPicture> KeptReference(const ReferenceRequest& request,
                                                     const volume::HydrometeorFields& fields,
                                                     const std::string& path,
                                                     const Interruption& interruption) {
  const std::string key =
      absl::StrCat(request.scene_text, "\npeak cut: ", request.options.peak_cut_deg,
                   "\nsamples a pixel: ", request.samples_per_pixel, "\n");
  const std::string key_path = path + ".scene";
  if (std::filesystem::exists(path) && base::ReadOwnFile(key_path).value_or("") == key) {
    return picture::ReadExr(path);
  }
  reference::RefineLimits limits;
  limits.samples_per_pixel = request.samples_per_pixel;
  runs::ProgressBar bar(absl::StrCat("tracing ", request.name));
  THUNDERHEAD_ASSIGN_OR_RETURN(
      const reference::TracedScene traced,
      reference::TraceScene(
          request.scene, fields, request.options, limits,
          [&](const reference::ImageProgress& progress) {
            bar.Set(static_cast<double>(progress.samples_per_pixel) / request.samples_per_pixel);
          },
          interruption.Token()));
  if (traced.result.end == reference::RefineEnd::kStopped) {
    return absl::CancelledError(
        "interrupted: the reference picture was not finished and is not kept");
  }
  THUNDERHEAD_RETURN_IF_ERROR(picture::WriteExr(path, traced.image));
  THUNDERHEAD_RETURN_IF_ERROR(base::WriteWholeFile(key_path, key));
  return traced.image;
}

}  // namespace thunderhead::app

#include "service/jobs/job_pictures.h"

#include <algorithm>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>

#include "absl/strings/ascii.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/strip.h"
#include "base/error_details.h"
#include "base/status.h"
#include "base/timed_calls.h"
#include "service/engine/catalogue_follower.h"
#include "service/engine/requested_image.h"
#include "service/messages/prepare_scene.h"
#include "service/messages/scene_messages.h"
#include "thunderhead/v1/job.pb.h"

namespace thunderhead::service {
namespace {

// Returns the extension of a format, such as "png" for IMAGE_FORMAT_PNG.
std::string ExtensionOf(v1::ImageFormat format) {
  const std::string name = v1::ImageFormat_Name(format);
  return absl::AsciiStrToLower(absl::StripPrefix(name, "IMAGE_FORMAT_"));
}

// Reads the stamps (size and times) of the storm files of all render jobs, on the jobs' thread. A
// hanging storage delays that thread only once, by JobFiles::patience. Later calls for the same
// storage then fail at once.
class StormFiles {
 public:
  StormFiles(const JobFiles& files, const base::TimeSource& time)
      : stamp_(files.stamp), calls_(files.patience, time) {}

  absl::StatusOr<std::optional<base::FileStamp>> StampOf(const std::string& path) {
    const std::string folder = std::filesystem::path(path).parent_path();
    return calls_.Ask(folder,
                      [path, look = stamp_]() -> absl::StatusOr<std::optional<base::FileStamp>> {
                        return look(path);
                      });
  }

 private:
  const std::function<std::optional<base::FileStamp>(const std::string&)> stamp_;
  base::TimedCalls calls_;
};

class JobPicture final : public jobs::PictureInHand, private ImageListener {
 public:
  JobPicture(Engine& engine, std::shared_ptr<StormFiles> files, std::function<void()> done)
      : engine_(engine),
        files_(std::move(files)),
        done_(std::move(done)),
        requested_(engine, request_, picture_, *this, Awaited::kByNobody) {}

  void Begin(const jobs::PictureOrder& order) {
    if (const absl::Status placed = Place(order); !placed.ok()) return Ended(placed);
    requested_.Begin();
  }

  void Cancel() override { requested_.Cancel(); }

  absl::StatusOr<jobs::DrawnPicture> Take() override {
    THUNDERHEAD_RETURN_IF_ERROR(status_);
    if (!path_.empty()) {
      THUNDERHEAD_ASSIGN_OR_RETURN(const auto stamp, files_->StampOf(path_));
      if (stamp != stamp_) {
        return absl::AbortedError(absl::StrCat(path_, " changed while it was drawn"));
      }
    }
    jobs::DrawnPicture drawn;
    drawn.bytes = std::move(*picture_.mutable_image());
    picture_.clear_image();
    drawn.extension = ExtensionOf(picture_.format());
    for (const v1::StageCost& stage : picture_.stages()) drawn.draw_ms += stage.milliseconds();
    v1::FetchRenderResultResponse about;
    *about.mutable_picture() = std::move(picture_);
    *about.mutable_input() = std::move(input_);
    drawn.about = about.SerializeAsString();
    return drawn;
  }

 private:
  // Finds the current storm id and time index for the order's storm and valid time. Both may have
  // changed since the order was made.
  absl::Status Place(const jobs::PictureOrder& order) {
    if (!request_.ParseFromString(order.request)) {
      return absl::DataLossError("the server's record of this picture is damaged");
    }
    v1::Scene& scene = *request_.mutable_scene();
    scene.set_storm_id(engine_.catalogue.IdNow(scene.storm_id()));
    input_.set_storm_id(scene.storm_id());
    input_.set_valid_time(order.valid_time);
    input_.set_device(engine_.loop.Device().device);
    // If the order has no valid time, its scene names no existing time. RequestedImage reports that
    // error.
    if (order.valid_time.empty()) return absl::OkStatus();
    THUNDERHEAD_ASSIGN_OR_RETURN(const storm_store::StormInfoPtr storm,
                                 FindStorm(engine_.store, scene.storm_id()));
    const auto time =
        std::ranges::find(storm->times, order.valid_time, &storm_store::StormTime::valid_time);
    if (time == storm->times.end()) {
      return base::WithDetails(
          absl::NotFoundError(absl::StrCat("storm '", storm->id, "' no longer has the time ",
                                           order.valid_time, "; its file was deleted")),
          {.reason = "TIME_GONE", .field = "scene.time_index"});
    }
    scene.set_time_index(static_cast<std::uint32_t>(time - storm->times.begin()));
    path_ = time->file;
    if (path_.empty()) return absl::OkStatus();
    THUNDERHEAD_ASSIGN_OR_RETURN(stamp_, files_->StampOf(path_));
    ToMessage(path_, *input_.mutable_file());
    return absl::OkStatus();
  }

  void Ended(const absl::Status& status) override {
    status_ = status;
    done_();
  }

  Engine& engine_;
  const std::shared_ptr<StormFiles> files_;
  const std::function<void()> done_;
  v1::RenderImageRequest request_;
  v1::RenderImageResponse picture_;
  v1::RenderJobInput input_;
  std::string path_;  // path of the storm file; empty if unknown
  std::optional<base::FileStamp> stamp_;
  absl::Status status_;
  RequestedImage requested_;
};

}  // namespace

jobs::BeginPicture JobPictures(Engine& engine, const JobFiles& files) {
  return [&engine, looks = std::make_shared<StormFiles>(files, engine.sessions.time())](
             const jobs::PictureOrder& order, std::function<void()> done) {
    auto picture = std::make_unique<JobPicture>(engine, looks, std::move(done));
    picture->Begin(order);
    return picture;
  };
}

}  // namespace thunderhead::service

#include "runs/local_service.h"

#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "absl/time/clock.h"
#include "absl/time/time.h"
#include "base/error_details.h"
#include "base/file_stamp.h"
#include "base/status.h"
#include "drawing/gl_frame_source.h"
#include "runs/progress_bar.h"
#include "sandbox/confined_files.h"
#include "storm_store/border_data.h"

namespace thunderhead::runs {
namespace {

// A running model is assumed to write each part of a file within this time.
constexpr absl::Duration kStillWritten = absl::Minutes(2);

}  // namespace

std::chrono::milliseconds LocalReadDeadline() {
  return sandbox::ReaderLimits().silence + std::chrono::seconds(5);
}

bool IsLastingRefusal(const absl::Status& status) {
  return absl::IsFailedPrecondition(status) ||
         (absl::IsResourceExhausted(status) && base::DetailsOf(status).permanent);
}

absl::Status AsFileProblem(const absl::Status& status) {
  if (!absl::IsInvalidArgument(status) && !IsLastingRefusal(status)) return status;
  return absl::DataLossError(status.message());
}

absl::Status AsFileProblem(const std::string& path, const absl::Status& status) {
  if (!absl::IsDataLoss(status)) return AsFileProblem(status);
  const auto stamp = base::StampOf(path);
  if (!stamp.has_value()) return status;
  // The age is computed from the modification time and not from the inode change time, because a
  // program that only changes the owner does not write the file. A modification time in the future,
  // beyond usual clock differences, gives no information.
  const absl::Duration age = absl::Now() - absl::FromUnixNanos(stamp->modified_ns);
  if (absl::AbsDuration(age) > kStillWritten) return status;
  return absl::UnavailableError(absl::StrCat(
      status.message(),
      "; it changed just now, so it may still be being written: try again when it is complete"));
}

absl::StatusOr<std::shared_ptr<storm_store::StormStore>> OpenStorm(const std::string& path,
                                                                   const std::stop_token& stop) {
  storm_store::StormStoreOptions options;
  options.formats = sandbox::ConfinedFormats({.limits = {.stop = stop}});
  options.stop = stop;
  options.links = storm_store::EveryLink();
  options.read_ahead = 0;
  options.read_deadline = LocalReadDeadline();
  options.borders = storm_store::BorderData::Find(storm_store::kBorderFolder);
  auto opened = storm_store::StormStore::Open({path}, options);
  if (!opened.ok()) return AsFileProblem(path, opened.status());
  std::shared_ptr<storm_store::StormStore> store = *std::move(opened);
  const std::vector<storm_store::StormInfoPtr> storms = store->Storms();
  if (storms.size() == 1) return store;
  const std::string names =
      absl::StrJoin(storms, ", ", [](std::string* out, const storm_store::StormInfoPtr& storm) {
        absl::StrAppend(out, storm->path.empty() ? storm->files.front() : storm->path);
      });
  return absl::InvalidArgumentError(
      absl::StrCat(path, " holds ", storms.size(), " storms; name one of ", names));
}

absl::StatusOr<int> TimeOf(const storm_store::StormStore& store, const std::string& path,
                           std::optional<int> wanted) {
  const int last = static_cast<int>(store.Storms().front()->times.size()) - 1;
  const int time_index = wanted.value_or(last);
  if (time_index >= 0 && time_index <= last) return time_index;
  return absl::InvalidArgumentError(
      absl::StrCat("--time is ", time_index, "; ", path, " has times 0 to ", last));
}

absl::Status ReadWithProgress(storm_store::StormStore& store, int time_index) {
  const storm_store::StormInfo& storm = *store.Storms().front();
  ProgressBar bar(absl::StrCat("reading ", storm.id));
  return AsFileProblem(
      storm.times[static_cast<std::size_t>(time_index)].file,
      store.Get(storm.id, time_index, [&bar](double share) { bar.Set(share); }).status());
}

absl::StatusOr<std::shared_ptr<const volume::HydrometeorFields>> ReadStorm(
    const std::string& path, std::optional<int> wanted) {
  THUNDERHEAD_ASSIGN_OR_RETURN(const std::shared_ptr<storm_store::StormStore> store,
                               OpenStorm(path));
  THUNDERHEAD_ASSIGN_OR_RETURN(const int time_index, TimeOf(*store, path, wanted));
  THUNDERHEAD_RETURN_IF_ERROR(ReadWithProgress(*store, time_index));
  return store->Get(store->Storms().front()->id, time_index, {});
}

absl::StatusOr<std::unique_ptr<service::Server>> StartLocalService(
    std::shared_ptr<storm_store::StormStore> store, const std::string& device) {
  service::ServerOptions options;
  options.render_loop.workers_yield = false;
  auto server = service::Server::Start(options, std::move(store), drawing::GlFrameSources(device));
  // Waiting does not make a missing device appear, so the status must not suggest a retry.
  if (!server.ok() && !absl::IsInvalidArgument(server.status())) {
    return absl::FailedPreconditionError(server.status().message());
  }
  return server;
}

absl::Status FromGrpc(const grpc::Status& status) {
  return absl::Status(static_cast<absl::StatusCode>(status.error_code()), status.error_message());
}

}  // namespace thunderhead::runs

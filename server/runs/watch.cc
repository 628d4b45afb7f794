#include "runs/watch.h"

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "base/folder_events.h"
#include "base/status.h"
#include "base/utc_time.h"
#include "base/version.h"
#include "pipeline/manifest.h"
#include "runs/watch_server.h"
#include "runs/watched_folder.h"
#include "storm_store/storm_catalogue.h"

namespace thunderhead::runs {
namespace {

// Interval at which the folder is scanned, for file systems without change events.
constexpr absl::Duration kRescan = absl::Seconds(30);

// Returns a plan of the pictures of all ready files. Pictures of files that are done count as made.
absl::StatusOr<std::vector<PlannedPicture>> PlanWatched(
    const PictureRunOptions& options, const std::vector<FolderStorm>& storms,
    const std::vector<storm_store::CataloguedStorm>& catalogue, const WatchedFolder& folder) {
  std::vector<PlannedPicture> all;
  for (std::size_t storm = 0; storm < storms.size(); ++storm) {
    std::vector<int> times(catalogue[storm].info.times.size());
    for (std::size_t i = 0; i < times.size(); ++i) times[i] = static_cast<int>(i);
    THUNDERHEAD_ASSIGN_OR_RETURN(
        const std::vector<PlannedPicture> pictures,
        PlanOf(options, catalogue, storm, storms[storm].name, times, false));
    all.insert(all.end(), pictures.begin(), pictures.end());
  }
  THUNDERHEAD_RETURN_IF_ERROR(CheckNames(options, all));
  for (PlannedPicture& picture : all) {
    if (folder.IsDone(picture.input)) picture.outcome = absl::OkStatus();
  }
  return all;
}

// Marks files as done if all their pictures are made, and as bad if they cannot be drawn. If the
// error of a picture names another file, the picture is retried without that file.
void Settle(const std::vector<PlannedPicture>& pictures, WatchedFolder& folder) {
  for (const std::string& path : folder.Unsettled()) {
    bool made = true;
    bool bad = false;
    for (const PlannedPicture& picture : pictures) {
      if (picture.input != path || picture.outcome.ok()) continue;
      made = false;
      bad = bad || (absl::IsDataLoss(picture.outcome) &&
                    absl::StrContains(picture.outcome.message(), path));
    }
    if (made || bad) folder.Settle(path, bad);
  }
}

// Returns true for the name of a picture, as opposed to a movie or another file.
bool IsPicture(const PictureRunOptions& options, const std::string& file) {
  return std::filesystem::path(file).extension() ==
         std::filesystem::path(options.product.Text()).extension();
}

// Returns the view of a picture that an earlier run made in the same way as this run would. Returns
// null for other products.
const View* ViewOf(const PictureRun& run, const pipeline::ManifestEntry& entry) {
  const std::vector<View>& views = run.Options().views;
  const auto view = std::ranges::find(views, entry.view, &View::name);
  if (view == views.end() || view->sha256 != entry.scene_sha256 ||
      entry.version != base::Version() || !IsPicture(run.Options(), entry.file) ||
      !std::filesystem::exists(run.Records().PathOf(entry))) {
    return nullptr;
  }
  return &*view;
}

// Marks files of which earlier runs have drawn every view as done, so that they count towards
// --until. They may have been moved away since.
void RememberDone(const PictureRun& run, WatchedFolder& folder) {
  // Number of drawn views, by input and valid time.
  std::map<std::string, std::map<std::string, std::size_t>> views;
  std::map<std::string, pipeline::InputFile> inputs;
  for (const pipeline::ManifestEntry& entry : run.Records().Entries()) {
    if (ViewOf(run, entry) == nullptr) continue;
    ++views[entry.input.path][entry.valid];
    inputs[entry.input.path] = entry.input;
  }
  for (const auto& [path, times] : views) {
    if (std::ranges::all_of(times, [&run](const auto& time) {
          return time.second >= run.Options().views.size();
        })) {
      folder.RememberDone(inputs[path]);
    }
  }
}

// Returns pictures that are not in `planned`, and that earlier runs made in the same way as this
// run would. Their input files no longer exist, or have changed and are not ready again. Movies
// include these pictures too, so that a movie does not become shorter when `watch` is restarted.
std::vector<PlannedPicture> MadeBefore(const PictureRun& run,
                                       const std::vector<PlannedPicture>& planned) {
  const pipeline::Manifest& records = run.Records();
  std::set<std::string> known;
  for (const PlannedPicture& picture : planned) known.insert(records.NameOf(picture.path));
  std::vector<PlannedPicture> pictures;
  for (const pipeline::ManifestEntry& entry : records.Entries()) {
    const View* view = ViewOf(run, entry);
    if (view == nullptr || known.contains(entry.file)) continue;
    PlannedPicture picture;
    picture.view = static_cast<std::size_t>(view - run.Options().views.data());
    picture.key.storm = entry.storm;
    picture.key.view = entry.view;
    picture.path = records.PathOf(entry);
    if (entry.run.has_value()) picture.key.run = base::ParseUtcTime(*entry.run);
    if (const auto valid = base::ParseUtcTime(entry.valid); valid.has_value()) {
      picture.key.valid = *valid;
      pictures.push_back(std::move(picture));
    }
  }
  return pictures;
}

// Draws the files that have become ready.
absl::Status DrawReady(const MovieOptions& movie, WatchedFolder& folder, PictureRun& run,
                       RunProgress& progress, std::set<std::string>& told,
                       const std::stop_token& stop) {
  if (folder.Unsettled().empty()) return absl::OkStatus();
  const std::vector<FolderStorm> storms = folder.Storms();
  std::vector<storm_store::CataloguedStorm> catalogue;
  catalogue.reserve(storms.size());
  for (const FolderStorm& storm : storms) catalogue.push_back(storm.storm);
  storm_store::LogNotes(catalogue, &told);
  THUNDERHEAD_ASSIGN_OR_RETURN(std::vector<PlannedPicture> all,
                               PlanWatched(run.Options(), storms, catalogue, folder));
  std::vector<PlannedPicture> made;
  std::vector<PlannedPicture> missing;
  for (PlannedPicture& picture : all) {
    (picture.outcome.ok() ? made : missing).push_back(std::move(picture));
  }
  THUNDERHEAD_RETURN_IF_ERROR(run.Make(catalogue, missing, progress, stop));
  Settle(missing, folder);
  made.insert(made.end(), missing.begin(), missing.end());
  if (movie.name.has_value()) {
    const std::vector<PlannedPicture> before = MadeBefore(run, made);
    made.insert(made.end(), before.begin(), before.end());
  }
  return MakeMovies(movie, made, run, progress, stop);
}

absl::Status Ended(const WatchedFolder& folder, bool in_time) {
  if (!in_time && folder.WaitingCount() > 0) {
    return absl::UnavailableError(absl::StrCat("the time of --until has passed, but ",
                                               folder.WaitingCount(),
                                               " files are not complete or not drawn; run the "
                                               "command again when they are complete"));
  }
  if (folder.BadCount() > 0) {
    return absl::DataLossError(
        absl::StrCat(folder.BadCount(), " files could not be drawn; the reasons are above"));
  }
  return absl::OkStatus();
}

}  // namespace

absl::Status RunWatchAtServer(WatchOptions options, ServerLink& server,
                              const std::stop_token& stop) {
  THUNDERHEAD_ASSIGN_OR_RETURN(const std::unique_ptr<PictureRun> run,
                               PictureRun::Open(std::move(options.pictures)));
  RunProgress progress(options.progress, absl::StrCat("watching ", options.folder));
  const ServerWatch watch{.storm = options.folder,
                          .is_over =
                              [&end = options.end](int times) {
                                return (end.files.has_value() && times >= *end.files) ||
                                       absl::Now() >= end.at;
                              },
                          .after_new =
                              [&](const std::vector<PlannedPicture>& pictures) {
                                return MakeMovies(options.movie, pictures, *run, progress, stop);
                              }};
  return WatchServer(watch, server, *run, progress, stop);
}

absl::Status RunWatch(WatchOptions options, const std::stop_token& stop) {
  std::error_code error;
  if (!std::filesystem::is_directory(options.folder, error)) {
    return absl::NotFoundError(
        absl::StrCat(options.folder, ": there is no such folder; create it"));
  }
  base::FolderEvents events;
  events.Watch(options.folder);
  const std::stop_callback wake(stop, [&events] { events.Wake(); });
  THUNDERHEAD_ASSIGN_OR_RETURN(const std::unique_ptr<PictureRun> run,
                               PictureRun::Open(std::move(options.pictures)));
  RunProgress progress(options.progress, absl::StrCat("watching ", options.folder));
  WatchedFolder folder(options.folder, options.files, options.ready, stop);
  RememberDone(*run, folder);
  std::set<std::string> told;
  while (!stop.stop_requested()) {
    const absl::Status looked = folder.Look(progress);
    if (stop.stop_requested()) break;
    THUNDERHEAD_RETURN_IF_ERROR(looked);
    absl::Status drawn = DrawReady(options.movie, folder, *run, progress, told, stop);
    if (!drawn.ok() && !absl::IsCancelled(drawn)) return drawn;
    if (stop.stop_requested()) break;
    if (options.end.files.has_value() &&
        folder.DoneCount() + folder.BadCount() >= *options.end.files) {
      return Ended(folder, true);
    }
    if (absl::Now() >= options.end.at) return Ended(folder, false);
    const absl::Duration pause = folder.WaitingCount() > 0 ? options.ready.Patience() : kRescan;
    events.WaitUntil(std::chrono::steady_clock::now() +
                     absl::ToChronoMilliseconds(
                         std::clamp(options.end.at - absl::Now(), absl::ZeroDuration(), pause)));
  }
  return absl::CancelledError(absl::StrCat("interrupted: the products of ", folder.DoneCount(),
                                           " files are made and listed in ", run->Records().Path(),
                                           "; run the same command again to continue"));
}

}  // namespace thunderhead::runs

#include "runs/picture_run.h"

#include <sys/stat.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <set>
#include <thread>
#include <utility>

#include "absl/strings/str_cat.h"
#include "base/status.h"
#include "base/stopwatch.h"
#include "base/version.h"
#include "base/whole_file.h"
#include "pipeline/plan.h"
#include "pipeline/sha256.h"
#include "runs/local_service.h"
#include "runs/picture_call.h"
#include "storm_store/border_data.h"
#include "storm_store/cached_storm_store.h"

namespace thunderhead::runs {
namespace {

namespace fs = std::filesystem;

std::string Iso(absl::Time time) {
  return absl::FormatTime("%E4Y-%m-%dT%H:%M:%SZ", time, absl::UTCTimeZone());
}

pipeline::ProductKey KeyOf(const storm_store::CataloguedStorm& storm, int time_index,
                           bool assume_run) {
  const storm_store::TimeSource& source = storm.sources[static_cast<std::size_t>(time_index)];
  const storm_files::StormFile& file = storm.files[source.file];
  pipeline::ProductKey key;
  key.valid = file.times[source.record];
  key.run = file.run_start;
  key.time_index = time_index;
  if (!key.run.has_value() && assume_run) {
    const storm_store::TimeSource& first = storm.sources.front();
    key.run = storm.files[first.file].times[first.record];
  }
  if (key.run.has_value()) key.lead = storm_files::DurationIn(file.calendar, *key.run, key.valid);
  return key;
}

// Adds the stages that the service reports.
void AddStages(const v1::RenderImageResponse& response, PictureTimes& times) {
  for (const v1::StageCost& stage : response.stages()) {
    double& time_ms = stage.stage() == v1::STAGE_READ     ? times.read_ms
                      : stage.stage() == v1::STAGE_ENCODE ? times.write_ms
                                                          : times.draw_ms;
    time_ms += stage.milliseconds();
  }
}

absl::Status ChangedMeanwhile(const std::string& path) {
  return absl::AbortedError(absl::StrCat(path, " changed while it was drawn; try again"));
}

// Returns true for an error that concerns only one input file and its pictures.
bool IsOfInput(const absl::Status& status) {
  return absl::IsDataLoss(status) || absl::IsNotFound(status) || absl::IsAborted(status);
}

}  // namespace

absl::StatusOr<std::vector<PlannedPicture>> PlanOf(
    const PictureRunOptions& options, const std::vector<storm_store::CataloguedStorm>& storms,
    std::size_t storm, const std::string& name, const std::vector<int>& times, bool assume_run) {
  std::vector<PlannedPicture> pictures;
  const storm_store::CataloguedStorm& whole = storms[storm];
  for (const int time_index : times) {
    const storm_store::TimeSource& source = whole.sources[static_cast<std::size_t>(time_index)];
    for (std::size_t view = 0; view < options.views.size(); ++view) {
      PlannedPicture& picture = pictures.emplace_back();
      picture.storm = storm;
      picture.time_index = time_index;
      picture.view = view;
      picture.key = KeyOf(whole, time_index, assume_run);
      picture.key.storm = name;
      picture.key.view = options.views[view].name;
      THUNDERHEAD_ASSIGN_OR_RETURN(picture.path, options.product.For(picture.key));
      picture.input = whole.files[source.file].path;
      picture.outcome = absl::UnavailableError(absl::StrCat(picture.path, " is not made yet"));
    }
  }
  return pictures;
}

namespace {

using FileId = std::pair<dev_t, ino_t>;

// Returns the files from which the pictures are made.
std::set<FileId> InputsOf(const std::vector<PlannedPicture>& pictures) {
  std::set<std::string> paths;
  for (const PlannedPicture& picture : pictures) paths.insert(picture.input);
  std::set<FileId> files;
  for (const std::string& path : paths) {
    struct stat about {};
    if (stat(path.c_str(), &about) == 0) files.emplace(about.st_dev, about.st_ino);
  }
  return files;
}

// Checks that the product replaces neither a storm file nor the manifest.
absl::Status CheckPlace(const std::string& product, const std::set<FileId>& inputs,
                        const std::string& manifest) {
  struct stat about {};
  if (lstat(product.c_str(), &about) == 0 && inputs.contains({about.st_dev, about.st_ino})) {
    return absl::InvalidArgumentError(
        absl::StrCat("--product would replace the storm file '", product, "'; give another name"));
  }
  return CheckIsNoManifest("a product", product, manifest);
}

}  // namespace

absl::Status CheckIsNoManifest(const std::string& what, const std::string& path,
                               const std::string& manifest) {
  if (fs::absolute(path).lexically_normal() != fs::absolute(manifest).lexically_normal()) {
    return absl::OkStatus();
  }
  return absl::InvalidArgumentError(absl::StrCat(what, " and the manifest would both be '", path,
                                                 "'; give another name by --manifest"));
}

absl::Status CheckNames(const PictureRunOptions& options,
                        const std::vector<PlannedPicture>& pictures) {
  const std::set<FileId> inputs = InputsOf(pictures);
  for (const PlannedPicture& picture : pictures) {
    THUNDERHEAD_RETURN_IF_ERROR(CheckPlace(picture.path, inputs, options.manifest));
  }
  std::vector<pipeline::ProductKey> keys;
  keys.reserve(pictures.size());
  for (const PlannedPicture& picture : pictures) keys.push_back(picture.key);
  return pipeline::CheckDistinct(options.product, keys);
}

absl::StatusOr<pipeline::InputFile> StampOf(const std::string& path) {
  struct stat status {};
  if (stat(path.c_str(), &status) != 0) {
    return absl::NotFoundError(
        absl::StrCat(path, ": no longer exists (", std::strerror(errno), ")"));
  }
  pipeline::InputFile input;
  input.path = path;
  input.bytes = static_cast<std::uint64_t>(status.st_size);
  input.modified_ns = std::int64_t{status.st_mtim.tv_sec} * 1'000'000'000 + status.st_mtim.tv_nsec;
  return input;
}

pipeline::ManifestEntry EntryOf(const pipeline::ProductKey& key, const View& view) {
  pipeline::ManifestEntry entry;
  entry.storm = key.storm;
  entry.valid = Iso(key.valid);
  if (key.run.has_value()) {
    entry.run = Iso(*key.run);
    entry.lead_s = absl::ToDoubleSeconds(key.Lead());
  }
  entry.view = view.name;
  entry.scene_sha256 = view.sha256;
  return entry;
}

bool SameStamp(const pipeline::InputFile& a, const pipeline::InputFile& b) {
  return a.path == b.path && a.bytes == b.bytes && a.modified_ns == b.modified_ns;
}

absl::StatusOr<std::unique_ptr<PictureRun>> PictureRun::Open(PictureRunOptions options) {
  const std::string folder = fs::path(options.manifest).parent_path().string();
  THUNDERHEAD_RETURN_IF_ERROR(base::MakeFolders(folder.empty() ? "." : folder));
  THUNDERHEAD_ASSIGN_OR_RETURN(pipeline::Manifest manifest,
                               pipeline::Manifest::Open(options.manifest, options.other_manifests));
  return std::unique_ptr<PictureRun>(new PictureRun(std::move(options), std::move(manifest)));
}

std::string PictureRun::HashOf(const pipeline::InputFile& input, const std::stop_token& stop) {
  {
    const std::lock_guard lock(mutex_);
    const auto known = hashed_.find(input.path);
    if (known != hashed_.end() && SameStamp(known->second, input)) return known->second.sha256;
  }
  const absl::StatusOr<std::string> sha256 = pipeline::Sha256OfFile(input.path, stop);
  if (absl::IsCancelled(sha256.status())) return "";
  pipeline::InputFile hashed = input;
  // If the file cannot be read, drawing it will report the error.
  hashed.sha256 = sha256.value_or("");
  const std::lock_guard lock(mutex_);
  return hashed_.insert_or_assign(input.path, std::move(hashed)).first->second.sha256;
}

bool PictureRun::IsAsBegun(const pipeline::InputFile& input) {
  const std::lock_guard lock(mutex_);
  return SameStamp(begun_.try_emplace(input.path, input).first->second, input);
}

absl::Status PictureRun::MarkDone(const std::string& path, const std::string& sha256) const {
  if (!options_.done_markers) return absl::OkStatus();
  return base::WriteWholeFile(path + ".done",
                              absl::StrCat(sha256, "  ", fs::path(path).filename().string(), "\n"));
}

absl::StatusOr<bool> PictureRun::IsMade(const std::string& path, const std::string& scene_sha256,
                                        const pipeline::InputFile& input,
                                        const std::function<std::string()>& input_sha256) {
  pipeline::ManifestEntry entry;
  {
    const std::lock_guard lock(mutex_);
    const pipeline::ManifestEntry* known = manifest_.Find(path);
    if (known == nullptr) return false;
    entry = *known;
  }
  std::error_code error;
  if (!pipeline::MadeAlike(entry, scene_sha256, base::Version(), input, input_sha256) ||
      fs::file_size(path, error) != entry.bytes || error ||
      pipeline::Sha256OfFile(path).value_or("") != entry.sha256) {
    return false;
  }
  // A killed run that was remaking the product may have left a partial file.
  fs::remove(base::PartialPath(path), error);
  if (options_.done_markers && !fs::exists(path + ".done", error)) {
    THUNDERHEAD_RETURN_IF_ERROR(MarkDone(path, entry.sha256));
  }
  if (SameStamp(entry.input, input)) return true;
  // The input was copied again with the same bytes. Its new size and time are recorded, so that the
  // next run need not compute the hash.
  const std::string sha256 = entry.input.sha256;
  entry.input = input;
  entry.input.sha256 = sha256;
  const std::lock_guard lock(mutex_);
  THUNDERHEAD_RETURN_IF_ERROR(manifest_.Record(path, std::move(entry)));
  return true;
}

absl::StatusOr<bool> PictureRun::IsMade(const PlannedPicture& picture,
                                        const std::stop_token& stop) {
  THUNDERHEAD_ASSIGN_OR_RETURN(const pipeline::InputFile input, StampOf(picture.input));
  return IsMade(picture, input, [&] { return HashOf(input, stop); });
}

absl::StatusOr<bool> PictureRun::IsMade(const PlannedPicture& picture,
                                        const pipeline::InputFile& input,
                                        const std::function<std::string()>& input_sha256) {
  const std::string& scene_sha256 = options_.views[picture.view].sha256;
  if (options_.format.world_file) {
    THUNDERHEAD_ASSIGN_OR_RETURN(
        const bool placed, IsMade(WorldFilePath(picture.path), scene_sha256, input, input_sha256));
    if (!placed) return false;
  }
  return IsMade(picture.path, scene_sha256, input, input_sha256);
}

absl::Status PictureRun::Publish(const PlannedPicture& planned, v1::RenderImageResponse picture,
                                 const pipeline::ManifestEntry& entry) {
  THUNDERHEAD_ASSIGN_OR_RETURN(const ProductFile file,
                               MakeProduct(options_.format, planned.key.storm, std::move(picture)));
  if (file.world_file.has_value()) {
    const std::string path = WorldFilePath(planned.path);
    // The world file may exist already, if an earlier run was killed before it wrote the picture.
    THUNDERHEAD_ASSIGN_OR_RETURN(const bool made, IsMade(path, entry.scene_sha256, entry.input,
                                                         [] { return std::string("unknown"); }));
    if (!made) THUNDERHEAD_RETURN_IF_ERROR(PublishFile(path, *file.world_file, entry));
  }
  return PublishFile(planned.path, file.bytes, entry);
}

absl::Status PictureRun::PublishFile(const std::string& path, const std::string& bytes,
                                     pipeline::ManifestEntry entry) {
  const std::string folder = fs::path(path).parent_path().string();
  if (!folder.empty()) THUNDERHEAD_RETURN_IF_ERROR(base::MakeFolders(folder));
  std::error_code ignored;
  fs::remove(path + ".done", ignored);
  THUNDERHEAD_RETURN_IF_ERROR(base::WriteWholeFile(path, bytes));
  entry.bytes = bytes.size();
  entry.sha256 = pipeline::Sha256(bytes);
  return Record(path, std::move(entry));
}

absl::Status PictureRun::Record(const std::string& path, pipeline::ManifestEntry entry) {
  entry.version = base::Version();
  const std::string sha256 = entry.sha256;
  {
    const std::lock_guard lock(mutex_);
    THUNDERHEAD_RETURN_IF_ERROR(manifest_.Record(path, std::move(entry)));
  }
  return MarkDone(path, sha256);
}

absl::Status PictureRun::MakeOne(const PlannedPicture& picture, storm_store::StormStore& store,
                                 const std::shared_ptr<grpc::Channel>& channel,
                                 const std::string& device, const std::string& storm_id,
                                 const std::stop_token& stop, double& milliseconds,
                                 PictureTimes& times) {
  const base::Stopwatch stopwatch;
  const View& view = options_.views[picture.view];
  THUNDERHEAD_ASSIGN_OR_RETURN(pipeline::InputFile input, StampOf(picture.input));
  if (!IsAsBegun(input)) return ChangedMeanwhile(picture.input);
  // The fields are read here first, because the service does not distinguish a bad file from a bad
  // request.
  if (const absl::Status read = store.Get(storm_id, picture.time_index, {}).status(); !read.ok()) {
    const absl::Status problem = AsFileProblem(read);
    return IsOfInput(problem) ? problem : absl::AbortedError(problem.message());
  }
  times.read_ms = stopwatch.ElapsedMs();
  v1::RenderImageRequest request;
  *request.mutable_scene() = view.scene;
  request.mutable_scene()->set_storm_id(storm_id);
  request.mutable_scene()->set_time_index(static_cast<std::uint32_t>(picture.time_index));
  request.set_format(options_.format.Drawn());
  request.set_error_seconds(static_cast<float>(options_.error_seconds));
  THUNDERHEAD_ASSIGN_OR_RETURN(v1::RenderImageResponse response,
                               CallForPicture(channel, request, "", stop, {}));
  AddStages(response, times);
  const base::Stopwatch writing;
  input.sha256 = HashOf(input, stop);
  if (stop.stop_requested()) return absl::CancelledError("interrupted");
  THUNDERHEAD_ASSIGN_OR_RETURN(const pipeline::InputFile after, StampOf(picture.input));
  if (!SameStamp(input, after)) return ChangedMeanwhile(picture.input);
  pipeline::ManifestEntry entry = EntryOf(picture.key, view);
  entry.device = device;
  entry.milliseconds = milliseconds = stopwatch.ElapsedMs();
  if (response.has_accuracy()) entry.estimated_error = response.accuracy().estimated_error();
  if (response.accuracy().measured()) {
    entry.error_low = response.accuracy().error_low();
    entry.error_high = response.accuracy().error_high();
  }
  entry.input = std::move(input);
  THUNDERHEAD_RETURN_IF_ERROR(Publish(picture, std::move(response), entry));
  times.write_ms += writing.ElapsedMs();
  return absl::OkStatus();
}

absl::Status PictureRun::Make(const std::vector<storm_store::CataloguedStorm>& storms,
                              std::vector<PlannedPicture>& pictures, RunProgress& progress,
                              const std::stop_token& stop) {
  progress.Plan(static_cast<int>(pictures.size()));
  std::vector<PlannedPicture*> missing;
  for (PlannedPicture& picture : pictures) {
    if (stop.stop_requested()) return absl::CancelledError("interrupted");
    const absl::StatusOr<bool> made = IsMade(picture, stop);
    if (made.ok() && *made) {
      picture.outcome = absl::OkStatus();
      progress.Kept(picture.path);
    } else if (made.ok()) {
      missing.push_back(&picture);
    } else if (IsOfInput(made.status())) {
      picture.outcome = made.status();
      progress.Failed(picture.path, made.status());
    } else {
      return made.status();
    }
  }
  if (missing.empty()) return absl::OkStatus();

  begun_.clear();
  storm_store::StormStoreOptions store_options;
  store_options.read_deadline = LocalReadDeadline();
  store_options.links = storm_store::EveryLink();
  store_options.read_ahead = 0;
  store_options.borders = storm_store::BorderData::Find(storm_store::kBorderFolder);
  const std::shared_ptr<storm_store::StormStore> store = storm_store::CachedStormStore::Owned(
      std::make_shared<storm_store::CachedStormStore>(storms, store_options));
  THUNDERHEAD_ASSIGN_OR_RETURN(const std::unique_ptr<service::Server> server,
                               StartLocalService(store, options_.device));
  std::stop_source ending;
  const std::stop_callback on_stop(stop, [&ending] { ending.request_stop(); });
  std::atomic<std::size_t> next{0};
  std::mutex failure_mutex;
  absl::Status failure;
  const auto work = [&] {
    for (std::size_t i = next++; i < missing.size() && !ending.stop_requested(); i = next++) {
      PlannedPicture& picture = *missing[i];
      double milliseconds = 0.0;
      PictureTimes times;
      picture.outcome =
          MakeOne(picture, *store, server->LocalChannel(), server->Device().device,
                  storms[picture.storm].info.id, ending.get_token(), milliseconds, times);
      if (picture.outcome.ok()) {
        progress.Drawn(picture.path, milliseconds, times);
      } else if (IsOfInput(picture.outcome)) {
        progress.Failed(picture.path, picture.outcome);
      } else {
        const std::lock_guard lock(failure_mutex);
        // Only the first failure counts, because it cancels the other pictures.
        if (failure.ok()) failure = picture.outcome;
        ending.request_stop();
      }
    }
  };
  {
    std::vector<std::jthread> workers;
    const std::size_t count = std::min(missing.size(), static_cast<std::size_t>(options_.jobs));
    for (std::size_t i = 0; i < count; ++i) workers.emplace_back(work);
  }
  server->Shutdown();
  if (stop.stop_requested()) return absl::CancelledError("interrupted");
  return failure;
}

}  // namespace thunderhead::runs

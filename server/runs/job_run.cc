#include "runs/job_run.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <filesystem>
#include <map>
#include <mutex>
#include <optional>
#include <thread>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/time/time.h"
#include "base/file_stamp.h"
#include "base/status.h"
#include "base/stopwatch.h"
#include "base/utc_time.h"
#include "pipeline/sha256.h"
#include "runs/server_answers.h"
#include "runs/server_outage.h"

namespace thunderhead::runs {
namespace {

using JobStub = v1::RenderJobService::Stub;
using PictureState = v1::RenderJobPictureState;
using std::chrono::seconds;

// Jobs are small, so that a request is small and a killed run leaves little behind. Two jobs run at
// a time, so that one is drawn while the last pictures of the other are fetched.
constexpr std::size_t kPicturesPerJob = 100;
constexpr int kJobsAtATime = 2;
// The pause before a call is tried again after the connection to the server was lost.
constexpr seconds kServerPause{1};
// A server that lists more jobs than this for the products of one run is broken. The others are
// left for the server to delete.
constexpr int kMaxFoundJobs = 200;
// The largest picture has 8192 x 8192 pixels.
constexpr std::uint64_t kMaxResultBytes = std::uint64_t{2} << 30;
// The number of times that a picture whose bytes do not fit its hash is fetched.
constexpr int kMaxFetches = 3;

absl::Status RunInterrupted() { return absl::CancelledError("interrupted"); }

absl::StatusOr<absl::Time> ParseIso(const std::string& text) {
  if (const auto time = base::ParseUtcTime(text); time.has_value()) return *time;
  return absl::InternalError(
      absl::StrCat("the server sent '", text,
                   "', which is not a time; run the server and this program in the same version"));
}

void PauseForServer(const std::stop_token& stop) {
  std::mutex mutex;
  std::condition_variable_any stopped;
  std::unique_lock lock(mutex);
  stopped.wait_for(lock, stop, kServerPause, [] { return false; });
}

v1::RenderJobPicture RequestOf(const PictureRunOptions& options, const PlannedPicture& picture) {
  v1::RenderJobPicture request;
  *request.mutable_scene() = options.views[picture.view].scene;
  request.mutable_scene()->set_storm_id(picture.server_storm);
  request.mutable_scene()->set_time_index(static_cast<std::uint32_t>(picture.time_index));
  request.set_format(options.format.Drawn());
  // The name identifies what the picture shows. It does not depend on the index of the time,
  // because that index may change.
  const pipeline::InputFile& input = *picture.server_input;
  request.set_name(pipeline::Sha256(absl::StrCat(
      picture.path, "\n", options.views[picture.view].sha256, "\n", input.path, "\n", input.bytes,
      "\n", input.modified_ns, "\n", absl::FormatTime(picture.key.valid))));
  return request;
}

// Returns a label for the jobs that make the products of a manifest. All runs with this manifest
// have the same label, on any machine that uses the same folder.
std::string LabelOf(const std::string& manifest) {
  std::error_code error;
  const std::filesystem::path path = std::filesystem::absolute(manifest, error);
  const auto folder = base::StampOf(path.parent_path().string());
  return absl::StrCat(
      "products ", pipeline::Sha256(absl::StrCat(path.string(), "\n", folder ? folder->inode : 0)));
}

pipeline::InputFile InputOf(const std::string& server, const std::string& storm,
                            const v1::StormFile& file) {
  pipeline::InputFile input;
  input.path = absl::StrCat("grpc://", server, "/", storm, "/", file.name());
  input.bytes = file.bytes();
  input.modified_ns = file.modified_ns();
  return input;
}

// The pictures of one job, by their index in the job. The id is empty if the job has yet to be
// created.
struct JobShare {
  std::string job_id;
  std::map<std::uint32_t, PlannedPicture*> pictures;
  std::map<std::uint32_t, int> misfits;  // how often the bytes of a picture did not fit its hash
};

class JobRun {
 public:
  JobRun(ServerLink& server, PictureRun& run, RunProgress& progress)
      : server_(server), run_(run), progress_(progress), label_(LabelOf(run.Options().manifest)) {}

  // Returns the jobs for the missing pictures. Existing jobs for these products that contain no
  // missing picture are deleted from the server.
  absl::StatusOr<std::vector<JobShare>> SharesOf(const std::vector<PlannedPicture*>& missing);
  // Returns when each picture of the share has its outcome, or with an error that ends the run.
  absl::Status Make(JobShare& share, const std::stop_token& stop);

 private:
  absl::Status Create(JobShare& share);
  // Returns when the job has ended, or when the stream breaks. Ends the outage if the stream has
  // worked for longer than an outage may last.
  absl::Status Watch(JobShare& share, ServerOutage& outage, const std::stop_token& stop);
  absl::Status Take(JobShare& share, const PictureState& state, const std::stop_token& stop);
  absl::Status Fetch(JobShare& share, const PictureState& state, PlannedPicture& picture,
                     const std::stop_token& stop);
  // Returns DATA_LOSS if the server sends more bytes than it announced or than any picture has.
  absl::StatusOr<v1::FetchRenderResultResponse> FetchWhole(const std::string& job_id,
                                                           const PictureState& state,
                                                           const std::stop_token& stop,
                                                           std::string* bytes);
  void Forget(const std::string& job_id);

  ServerLink& server_;
  PictureRun& run_;
  RunProgress& progress_;
  const std::string label_;
};

absl::StatusOr<std::vector<JobShare>> JobRun::SharesOf(
    const std::vector<PlannedPicture*>& missing) {
  std::map<std::string, PlannedPicture*> by_name;
  for (PlannedPicture* picture : missing) {
    by_name[RequestOf(run_.Options(), *picture).name()] = picture;
  }
  std::vector<JobShare> shares;
  v1::ListRenderJobsRequest list;
  list.set_label(label_);
  v1::ListRenderJobsResponse jobs;
  THUNDERHEAD_RETURN_IF_ERROR(server_.Call(server_.Jobs(), &JobStub::ListRenderJobs, list, &jobs));
  for (int i = 0; i < std::min(jobs.jobs_size(), kMaxFoundJobs); ++i) {
    const v1::RenderJob& job = jobs.jobs(i);
    v1::GetRenderJobRequest get;
    get.set_job_id(job.id());
    v1::GetRenderJobResponse got;
    if (!server_.Call(server_.Jobs(), &JobStub::GetRenderJob, get, &got).ok()) continue;
    JobShare share{job.id(), {}, {}};
    for (const PictureState& state : got.pictures()) {
      const bool comes = state.state() == PictureState::STATE_WAITING ||
                         state.state() == PictureState::STATE_DRAWING ||
                         state.state() == PictureState::STATE_DRAWN;
      const auto picture = by_name.find(state.name());
      if (!comes || picture == by_name.end()) continue;
      share.pictures[state.index()] = picture->second;
      by_name.erase(picture);
    }
    if (share.pictures.empty()) {
      Forget(job.id());
    } else {
      shares.push_back(std::move(share));
    }
  }
  // The pictures that are in no existing job are added in the order of the plan.
  std::size_t open = shares.size();
  for (PlannedPicture* picture : missing) {
    if (!by_name.contains(RequestOf(run_.Options(), *picture).name())) continue;
    if (open == shares.size() || shares.back().pictures.size() == kPicturesPerJob) {
      shares.emplace_back();
      open = shares.size() - 1;
    }
    auto& pictures = shares.back().pictures;
    pictures[static_cast<std::uint32_t>(pictures.size())] = picture;
  }
  return shares;
}

absl::Status JobRun::Create(JobShare& share) {
  v1::CreateRenderJobRequest request;
  request.set_label(label_);
  for (const auto& [place, picture] : share.pictures) {
    *request.add_pictures() = RequestOf(run_.Options(), *picture);
  }
  v1::CreateRenderJobResponse response;
  THUNDERHEAD_RETURN_IF_ERROR(
      server_.Call(server_.Jobs(), &JobStub::CreateRenderJob, request, &response));
  share.job_id = response.job().id();
  return absl::OkStatus();
}

void JobRun::Forget(const std::string& job_id) {
  v1::CancelRenderJobRequest request;
  request.set_job_id(job_id);
  request.set_forget(true);
  v1::CancelRenderJobResponse response;
  // An error is ignored, because the server deletes the job automatically after a time.
  (void)server_.Call(server_.Jobs(), &JobStub::CancelRenderJob, request, &response);
}

absl::StatusOr<v1::FetchRenderResultResponse> JobRun::FetchWhole(const std::string& job_id,
                                                                 const PictureState& state,
                                                                 const std::stop_token& stop,
                                                                 std::string* bytes) {
  grpc::ClientContext context;
  server_.Prepare(context);
  const std::stop_callback cancel(stop, [&context] { context.TryCancel(); });
  v1::FetchRenderResultRequest request;
  request.set_job_id(job_id);
  request.set_index(state.index());
  const auto reader = server_.Jobs().FetchRenderResult(&context, request);
  v1::FetchRenderResultResponse about;
  v1::FetchRenderResultResponse part;
  bool fits = true;
  while (fits && reader->Read(&part)) {
    const std::string chunk = std::move(*part.mutable_chunk());
    const bool first = !about.has_picture();
    if (first) about = std::move(part);
    fits = about.has_picture() && about.total_bytes() <= kMaxResultBytes &&
           chunk.size() <= about.total_bytes() - bytes->size() && (first || !chunk.empty());
    if (fits) absl::StrAppend(bytes, chunk);
  }
  if (!fits) context.TryCancel();
  const grpc::Status end = reader->Finish();
  if (stop.stop_requested()) return RunInterrupted();
  if (!fits) {
    return absl::DataLossError(absl::StrCat("the server sent more or other bytes than the ",
                                            about.total_bytes(),
                                            " bytes that it announced; look at the server's log"));
  }
  THUNDERHEAD_RETURN_IF_ERROR(server_.StatusOf(end));
  return about;
}

absl::Status JobRun::Fetch(JobShare& share, const PictureState& state, PlannedPicture& picture,
                           const std::stop_token& stop) {
  std::string bytes;
  THUNDERHEAD_ASSIGN_OR_RETURN(v1::FetchRenderResultResponse about,
                               FetchWhole(share.job_id, state, stop, &bytes));
  if (pipeline::Sha256(bytes) != state.sha256()) {
    const bool again = ++share.misfits[state.index()] < kMaxFetches;
    return absl::Status(
        again ? absl::StatusCode::kUnavailable : absl::StatusCode::kDataLoss,
        absl::StrCat(picture.path, " does not have the bytes that the server announced; ",
                     again ? "try again" : "look at the server's log"));
  }
  const v1::RenderJobInput& input = about.input();
  const pipeline::InputFile read = InputOf(server_.Address(), picture.server_storm, input.file());
  if (!SameStamp(read, *picture.server_input)) {
    return absl::AbortedError(absl::StrCat(read.path, " changed before it was drawn; try again"));
  }
  const View& view = run_.Options().views[picture.view];
  pipeline::ManifestEntry entry = EntryOf(picture.key, view);
  entry.device = input.device();
  entry.milliseconds = AsCost(state.milliseconds());
  if (about.picture().has_accuracy()) {
    entry.estimated_error = about.picture().accuracy().estimated_error();
  }
  entry.input = read;
  v1::RenderImageResponse drawn = std::move(*about.mutable_picture());
  drawn.set_image(std::move(bytes));
  return run_.Publish(picture, std::move(drawn), entry);
}

absl::Status JobRun::Take(JobShare& share, const PictureState& state, const std::stop_token& stop) {
  const auto found = share.pictures.find(state.index());
  if (found == share.pictures.end()) return absl::OkStatus();
  PlannedPicture& picture = *found->second;
  switch (state.state()) {
    case PictureState::STATE_DRAWN:
      picture.outcome = Fetch(share, state, picture, stop);
      break;
    case PictureState::STATE_FAILED:
    case PictureState::STATE_DROPPED:
      picture.outcome = FailureOf(state.problem(), picture.path);
      break;
    case PictureState::STATE_CANCELLED:
      picture.outcome = absl::AbortedError("its render job was cancelled; try again");
      break;
    default:
      return absl::OkStatus();
  }
  if (picture.outcome.ok()) {
    progress_.Drawn(picture.path, AsCost(state.milliseconds()));
  } else if (stop.stop_requested() || MayComeBack(picture.outcome) ||
             absl::IsFailedPrecondition(picture.outcome)) {
    return picture.outcome;
  } else {
    progress_.Failed(picture.path, picture.outcome);
  }
  share.pictures.erase(found);
  return absl::OkStatus();
}

absl::Status JobRun::Watch(JobShare& share, ServerOutage& outage, const std::stop_token& stop) {
  const base::Stopwatch stopwatch;
  grpc::ClientContext context;
  server_.Prepare(context);
  const std::stop_callback cancel(stop, [&context] { context.TryCancel(); });
  v1::WatchRenderJobRequest request;
  request.set_job_id(share.job_id);
  const auto reader = server_.Jobs().WatchRenderJob(&context, request);
  v1::WatchRenderJobResponse news;
  absl::Status taken;
  while (taken.ok() && reader->Read(&news)) {
    // Each message has the job. A server that sends others could send them for ever.
    if (!news.has_job() && news.pictures().empty()) {
      taken = absl::UnavailableError(absl::StrCat("the server at ", server_.Address(),
                                                  " sends empty news of a job; try again"));
    }
    for (const PictureState& state : news.pictures()) {
      taken = Take(share, state, stop);
      if (!taken.ok()) break;
    }
  }
  if (!taken.ok()) context.TryCancel();
  const grpc::Status end = reader->Finish();
  if (stop.stop_requested()) return RunInterrupted();
  if (!taken.ok()) return taken;
  if (stopwatch.ElapsedMs() >= std::chrono::milliseconds(ServerOutage::kPatience).count()) {
    outage.End();
  }
  return server_.StatusOf(end);
}

absl::Status JobRun::Make(JobShare& share, const std::stop_token& stop) {
  ServerOutage outage;
  while (true) {
    const std::size_t left = share.pictures.size();
    absl::Status status = share.job_id.empty() ? Create(share) : absl::OkStatus();
    if (status.ok()) status = Watch(share, outage, stop);
    if (stop.stop_requested()) return RunInterrupted();
    if (share.pictures.size() < left) outage.End();
    if (status.ok() || share.pictures.empty()) break;
    if (!outage.MayRetry(status)) return status;
    PauseForServer(stop);
  }
  // The job has ended, so its remaining pictures will not arrive.
  for (const auto& [place, picture] : share.pictures) {
    progress_.Failed(picture->path, picture->outcome);
  }
  Forget(share.job_id);
  return absl::OkStatus();
}

}  // namespace

absl::StatusOr<v1::StormDescription> DescribeStorm(ServerLink& server, const std::string& id) {
  v1::DescribeStormRequest request;
  request.set_storm_id(id);
  v1::DescribeStormResponse response;
  THUNDERHEAD_RETURN_IF_ERROR(server.Call(
      server.Service(), &v1::ThunderheadService::Stub::DescribeStorm, request, &response));
  THUNDERHEAD_RETURN_IF_ERROR(CheckDescription(response.storm(), id));
  return std::move(*response.mutable_storm());
}

absl::StatusOr<std::vector<PlannedPicture>> PlanOfServer(
    const PictureRunOptions& options, const ServerLink& server, const v1::StormDescription& storm,
    std::size_t number, const std::vector<int>& times, bool assume_run) {
  std::optional<absl::Time> run;
  if (!storm.run_start().empty()) {
    THUNDERHEAD_ASSIGN_OR_RETURN(run, ParseIso(storm.run_start()));
  } else if (assume_run) {
    THUNDERHEAD_ASSIGN_OR_RETURN(run, ParseIso(storm.times(0).valid_time()));
  }
  std::vector<PlannedPicture> pictures;
  for (const int time_index : times) {
    const v1::StormTime& time = storm.times(time_index);
    for (std::size_t view = 0; view < options.views.size(); ++view) {
      PlannedPicture& picture = pictures.emplace_back();
      picture.storm = number;
      picture.time_index = time_index;
      picture.view = view;
      THUNDERHEAD_ASSIGN_OR_RETURN(picture.key.valid, ParseIso(time.valid_time()));
      picture.key.run = run;
      if (time.has_lead_s()) picture.key.lead = absl::Seconds(time.lead_s());
      picture.key.time_index = time_index;
      picture.key.storm = storm.id();
      picture.key.view = options.views[view].name;
      THUNDERHEAD_ASSIGN_OR_RETURN(picture.path, options.product.For(picture.key));
      picture.server_storm = storm.id();
      picture.server_input = InputOf(server.Address(), storm.id(), time.file());
      picture.input = picture.server_input->path;
      picture.outcome = absl::UnavailableError(absl::StrCat(picture.path, " is not made yet"));
    }
  }
  return pictures;
}

absl::Status MakeByJobs(ServerLink& server, PictureRun& run, std::vector<PlannedPicture>& pictures,
                        RunProgress& progress, const std::stop_token& stop) {
  progress.Plan(static_cast<int>(pictures.size()));
  std::vector<PlannedPicture*> missing;
  for (PlannedPicture& picture : pictures) {
    if (stop.stop_requested()) return RunInterrupted();
    // The server's input files have no hash here, so only their sizes and times are compared.
    const auto no_hash = [] { return std::string("unknown"); };
    THUNDERHEAD_ASSIGN_OR_RETURN(const bool made,
                                 run.IsMade(picture, *picture.server_input, no_hash));
    if (!made) {
      missing.push_back(&picture);
      continue;
    }
    picture.outcome = absl::OkStatus();
    progress.Kept(picture.path);
  }
  JobRun jobs(server, run, progress);
  // Jobs are looked up even if no picture is missing, because a run that was killed at its end may
  // have left its job on the server.
  absl::StatusOr<std::vector<JobShare>> found = jobs.SharesOf(missing);
  if (missing.empty()) return absl::OkStatus();
  THUNDERHEAD_ASSIGN_OR_RETURN(std::vector<JobShare> shares, std::move(found));
  std::stop_source ending;
  const std::stop_callback on_stop(stop, [&ending] { ending.request_stop(); });
  std::atomic<std::size_t> next{0};
  std::mutex failure_mutex;
  absl::Status failure;
  const auto work = [&] {
    for (std::size_t i = next++; i < shares.size() && !ending.stop_requested(); i = next++) {
      const absl::Status made = jobs.Make(shares[i], ending.get_token());
      if (made.ok()) continue;
      const std::lock_guard lock(failure_mutex);
      // Only the first failure counts, because it cancels the other pictures.
      if (failure.ok()) failure = made;
      ending.request_stop();
    }
  };
  {
    std::vector<std::jthread> workers;
    workers.reserve(kJobsAtATime);
    for (int i = 0; i < kJobsAtATime; ++i) workers.emplace_back(work);
  }
  if (stop.stop_requested()) return RunInterrupted();
  return failure;
}

}  // namespace thunderhead::runs

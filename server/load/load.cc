#include "load/load.h"

#include <sys/resource.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <memory>
#include <thread>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "base/status.h"
#include "load/presenter.h"
#include "load/recording.h"
#include "load/viewer.h"
#include "thunderhead/v1/thunderhead.pb.h"

namespace thunderhead::load {
namespace {

constexpr double kTurnSpeed_deg_per_s = 15.0;
constexpr double kTick_s = 0.05;

double OwnCpu_s() {
  rusage usage{};
  ::getrusage(RUSAGE_SELF, &usage);
  const auto seconds = [](const timeval& time) {
    return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
  };
  return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

void SleepUntil(double at_s) {
  std::this_thread::sleep_for(std::chrono::duration<double>(std::max(0.0, at_s - Now_s())));
}

absl::StatusOr<v1::CreateSessionResponse> CreateSession(Transport& transport,
                                                        const LoadOptions& options) {
  v1::CreateSessionRequest request;
  request.mutable_scene()->mutable_output()->set_width_px(
      static_cast<std::uint32_t>(options.width_px));
  request.mutable_scene()->mutable_output()->set_height_px(
      static_cast<std::uint32_t>(options.height_px));
  request.mutable_scene()->mutable_camera()->mutable_orbit();
  THUNDERHEAD_ASSIGN_OR_RETURN(const std::string answer,
                               transport.Call("CreateSession", request.SerializeAsString(),
                                              {options.times.call_patience_s}));
  v1::CreateSessionResponse session;
  if (!session.ParseFromString(answer)) {
    return absl::InternalError("the server's answer to CreateSession is malformed");
  }
  if (session.viewer_key().empty()) {
    return absl::UnimplementedError(
        "the server is older than this program and returns no viewers' key: run both in the same "
        "version");
  }
  return session;
}

class RunningLoad {
 public:
  RunningLoad(const LoadOptions& options, Transport& transport,
              const std::optional<ServerProcess>& server, const std::stop_token& stop,
              const std::function<void(const Progress&)>& progress,
              const v1::CreateSessionResponse& session)
      : options_(options),
        transport_(transport),
        server_(server),
        stop_(stop),
        progress_(progress),
        session_id_(session.session_id()),
        viewer_key_(session.viewer_key()),
        images_(options.images, transport, stop, errors_),
        presenter_(session.scene().camera(), errors_) {
    presenter_.Join(transport, session.session_id());
    AddViewers(ViewerKind::kHealthy, options.viewers - options.looking);
    AddViewers(ViewerKind::kLooking, options.looking);
    for (const auto& viewer : viewers_) {
      if (viewer->kind() == ViewerKind::kLooking) viewer->LookAround(session.scene().camera());
    }
    AddViewers(ViewerKind::kThrottled, options.throttled);
    AddViewers(ViewerKind::kStalled, options.stalled);
    AddViewers(ViewerKind::kPassing, options.passing);
  }

  absl::StatusOr<Report> Run() {
    const absl::Status joined = AwaitFrames();
    if (joined.ok()) Steer();
    images_.Join();
    Leave();
    Close();
    if (!joined.ok()) return joined;
    return ReportOf(Record());
  }

 private:
  void AddViewers(ViewerKind kind, int count) {
    for (int i = 0; i < count; ++i) {
      viewers_.push_back(std::make_unique<Viewer>(kind, measuring_, errors_));
      viewers_.back()->Join(transport_, viewer_key_, options_.kbit_per_s,
                            options_.codec == LoadCodec::kVp9);
    }
  }

  bool AllEnded() const {
    return std::ranges::all_of(viewers_, [](const auto& viewer) {
      return viewer->kind() == ViewerKind::kStalled || viewer->HasEnded();
    });
  }

  // Waits until each viewer that reads has a frame or has ended.
  absl::Status AwaitFrames() {
    const double until_s = Now_s() + options_.times.join_patience_s;
    const auto settled = [](const auto& viewer) {
      return viewer->kind() == ViewerKind::kStalled || viewer->HasFrame() || viewer->HasEnded();
    };
    while (!std::ranges::all_of(viewers_, settled) && Now_s() < until_s &&
           !stop_.stop_requested()) {
      Tell(0.0);
      SleepUntil(Now_s() + kTick_s);
    }
    if (std::ranges::any_of(viewers_, [](const auto& viewer) { return viewer->HasFrame(); })) {
      return absl::OkStatus();
    }
    if (stop_.stop_requested()) return absl::CancelledError("interrupted before the first frame");
    const std::map<std::string, int> errors = errors_.Counts();
    if (!errors.empty()) {
      return absl::UnavailableError(absl::StrCat("no viewer got a frame: ", errors.begin()->first));
    }
    return absl::DeadlineExceededError(
        absl::StrCat("no viewer got a frame within ",
                     static_cast<int>(options_.times.join_patience_s), " seconds"));
  }

  // Turns the presenter's camera during the warm-up and the measured period.
  void Steer() {
    period_.begin_s = Now_s() + options_.times.warm_up_s;
    period_.end_s = period_.begin_s + options_.seconds;
    next_visit_s_ = period_.begin_s;
    const double step_s =
        options_.steer_hz > 0.0 ? 1.0 / options_.steer_hz : options_.seconds + 1e3;
    double next_update_s = Now_s() + (options_.steer_hz > 0.0 ? 0.0 : step_s);
    double next_sample_s = period_.begin_s;
    double own_cpu_s = OwnCpu_s();
    while (Now_s() < period_.end_s && !stop_.stop_requested() && !AllEnded()) {
      const double now_s = Now_s();
      if (now_s >= next_update_s) {
        presenter_.Turn(kTurnSpeed_deg_per_s * step_s);
        // Own views turn in the opposite direction to the session's.
        for (const auto& viewer : viewers_) {
          if (viewer->kind() == ViewerKind::kLooking) viewer->Turn(-kTurnSpeed_deg_per_s * step_s);
        }
        // After a pause of this program, missed updates are skipped instead of being sent in a
        // burst.
        next_update_s = std::max(next_update_s + step_s, now_s);
      }
      if (now_s >= next_sample_s) {
        if (!measuring_.exchange(true)) {
          own_cpu_s = OwnCpu_s();
          images_.Begin();
        }
        Sample();
        next_sample_s += options_.times.sampling_s;
        Tell((now_s - period_.begin_s) / options_.seconds);
      }
      LetPass(now_s);
      SleepUntil(std::min({next_update_s, next_sample_s, period_.end_s, now_s + kTick_s}));
    }
    measuring_ = false;
    Sample();
    period_.end_s = std::max(period_.begin_s, std::min(period_.end_s, Now_s()));
    own_cpu_s_ = OwnCpu_s() - own_cpu_s;
  }

  // Lets passing viewers leave and return, one after another, each after the duration of a visit. A
  // viewer without a frame stays until its timeout.
  void LetPass(double now_s) {
    if (options_.passing == 0 || now_s < next_visit_s_) return;
    // The passing viewers are the last of the viewers.
    const auto passing = static_cast<std::size_t>(options_.passing);
    Viewer& next = *viewers_[viewers_.size() - passing + visits_ % passing];
    if (next.WaitsForFirstFrame() && now_s < next.joined_at_s() + options_.times.join_patience_s) {
      return;
    }
    next_visit_s_ = std::max(next_visit_s_, now_s) + options_.times.visit_s / options_.passing;
    ++visits_;
    next.ComeAgain(transport_, viewer_key_);
  }

  void Sample() {
    if (!server_.has_value()) return;
    if (const auto sample = server_->Sample(); sample.has_value()) samples_.push_back(*sample);
  }

  // Returns the kind of viewers that Progress::frames_per_s counts.
  ViewerKind MainKind() const {
    if (options_.viewers > options_.looking) return ViewerKind::kHealthy;
    return options_.looking > 0 ? ViewerKind::kLooking : ViewerKind::kThrottled;
  }

  void Tell(double share) {
    Progress told{.share = share, .visits = visits_};
    std::optional<std::uint64_t> least;
    const ViewerKind counted = MainKind();
    int viewers = 0;
    std::uint64_t frames = 0;
    for (const auto& viewer : viewers_) {
      if (viewer->HasFrame()) ++told.joined;
      if (viewer->kind() == counted || viewer->kind() == ViewerKind::kLooking) {
        least = std::min(least.value_or(viewer->MeasuredFrames()), viewer->MeasuredFrames());
      }
      if (viewer->kind() != counted) continue;
      ++viewers;
      frames += viewer->Frames();
    }
    told.least_frames = least.value_or(0);
    const double now_s = Now_s();
    if (viewers > 0 && now_s > told_s_) {
      told.frames_per_s = static_cast<double>(frames - told_frames_) / (now_s - told_s_) / viewers;
    }
    told_frames_ = frames;
    told_s_ = now_s;
    for (const auto& [message, count] : errors_.Counts()) told.errors += count;
    progress_(told);
  }

  void Leave() {
    for (const auto& viewer : viewers_) viewer->Leave();
    presenter_.Leave();
    const double until_s = Now_s() + options_.times.leave_patience_s;
    while (Now_s() < until_s && !(AllEnded() && presenter_.HasEnded())) {
      SleepUntil(Now_s() + kTick_s);
    }
    const auto stays = [](const auto& viewer) { return !viewer->HasEnded(); };
    for (auto count = std::ranges::count_if(viewers_, stays); count > 0; --count) {
      errors_.Add("the server did not end the call of a viewer who left");
    }
    for (const auto& viewer : viewers_) viewer->Stop();
    presenter_.Stop();
  }

  void Close() {
    v1::CloseSessionRequest request;
    request.set_session_id(session_id_);
    const auto closed = transport_.Call("CloseSession", request.SerializeAsString(),
                                        {options_.times.call_patience_s});
    if (!closed.ok()) {
      errors_.Add(absl::StrCat("closing the session: ", closed.status().ToString()));
    }
  }

  Recording Record() const {
    Recording recording{.period = period_,
                        .updates = presenter_.Updates(),
                        .images = images_.Record(),
                        .server = samples_,
                        .own_cpu_s = own_cpu_s_,
                        .errors = errors_.Counts()};
    for (const auto& viewer : viewers_) recording.viewers.push_back(&viewer->record());
    return recording;
  }

  const LoadOptions& options_;
  Transport& transport_;
  const std::optional<ServerProcess>& server_;
  const std::stop_token& stop_;
  const std::function<void(const Progress&)>& progress_;
  const std::string session_id_;
  const std::string viewer_key_;
  Errors errors_;
  ImageBurst images_;
  std::atomic<bool> measuring_{false};
  Presenter presenter_;
  std::vector<std::unique_ptr<Viewer>> viewers_;
  Period period_;
  std::vector<ProcessSample> samples_;
  double own_cpu_s_ = 0.0;
  std::size_t visits_ = 0;  // completed visits of passing viewers
  double next_visit_s_ = 0.0;
  std::uint64_t told_frames_ = 0;
  double told_s_ = Now_s();
};

}  // namespace

void Throttle(double kbit_per_s, std::optional<int> throttled, LoadOptions& options) {
  options.kbit_per_s = kbit_per_s;
  options.throttled = throttled.has_value() ? *throttled : std::exchange(options.viewers, 0);
}

absl::StatusOr<Report> Run(const LoadOptions& options, Transport& transport,
                           const std::optional<ServerProcess>& server, const std::stop_token& stop,
                           const std::function<void(const Progress&)>& progress) {
  THUNDERHEAD_ASSIGN_OR_RETURN(const v1::CreateSessionResponse session,
                               CreateSession(transport, options));
  THUNDERHEAD_ASSIGN_OR_RETURN(
      Report report, RunningLoad(options, transport, server, stop, progress, session).Run());
  report.transport = transport.Name();
  report.width_px = options.width_px;
  report.height_px = options.height_px;
  report.steer_hz = options.steer_hz;
  report.throttle_kbit_per_s = options.kbit_per_s;
  return report;
}

}  // namespace thunderhead::load
